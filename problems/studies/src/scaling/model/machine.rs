//! What one core of this machine does: the figures that the model scales.
//!
//! Everything is measured on one thread: two tearings of one scene for seconds and bytes per subdomain, a dense
//! factorisation for the coarse matrices.

use crate::scaling::cases::{Case, SceneName, Variant};
use crate::scaling::measure;
use crate::scaling::rows::{ScalingRow, Start};
use contact::WorkEstimate;
use faer::Mat;
use problems::commands::Failure;
use serde::Serialize;
use std::time::Instant;

/// The two tearings: their difference has no share of what a process needs anyway.
const CASES: [Case; 2] = [Case { mesh: 14, subdomains: 2 }, Case { mesh: 35, subdomains: 5 }];
/// Rows of the dense matrix that is factored.
const DENSE_ROWS: usize = 1200;

/// Figures of one core.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Machine {
    /// Seconds to assemble and factor a subdomain.
    pub factor: f64,
    /// Seconds of a product with F and with the preconditioner, with all vector work, per subdomain, in a state to
    /// 1e-10, which takes more of its products in double precision than one to 1e-8.
    pub product: f64,
    /// Seconds of a product with F and with the preconditioner, with all vector work, per subdomain, in an adjoint.
    pub adjoint_product: f64,
    /// Seconds of the shape derivative and of the recovery of displacements, per subdomain.
    pub derivative: f64,
    /// Products of a cold state to 1e-8.
    pub products: f64,
    /// Products of its adjoint.
    pub adjoint_products: f64,
    /// Operations per second of a factor of a subdomain, which stand for those of sparse coarse factors.
    pub sparse_rate: f64,
    /// Operations per second of a dense factorisation.
    pub dense_rate: f64,
    /// Memory per subdomain, bytes.
    pub bytes: f64,
    /// Bytes of a process without subdomains.
    pub base_bytes: f64,
    /// Dofs of a subdomain.
    pub subdomain_dofs: f64,
}

impl Machine {
    /// Measures this machine, on one thread.
    pub fn measure(scene: SceneName) -> Result<Self, Failure> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let pool = pool.map_err(|error| Failure::Computation(format!("one thread: {error}")))?;
        pool.install(|| Self::on_this_thread(scene))
    }

    fn on_this_thread(scene: SceneName) -> Result<Self, Failure> {
        let [small, large] = CASES.map(|case| measure::row(scene, case, Variant::Dirichlet, 1));
        let (small, large) = (small?, large?);
        let case = CASES[1];
        let estimate = WorkEstimate::of(&scene.scene(case)?);
        let bodies = scene.scene(case)?.bodies.len() as f64;
        let count = |case: Case| bodies * (case.subdomains as f64).powi(3);
        let pieces = count(case);
        let stages = large.cold.state.stages.unwrap_or_default();
        let (state, adjoint) = (&large.cold.state, &large.cold.adjoint);
        let (products, adjoint_products) = (state.applications() as f64, adjoint.applications as f64);
        let tight = large.solve(Start::Cold, measure::COLD[1]);
        let tight = tight.ok_or_else(|| Failure::Computation("no state to 1e-10 for the model".into()))?;
        let tight_stages = tight.stages.unwrap_or_default();
        let tight_seconds = tight_stages.newton + tight_stages.coarse_space;
        let factor = (stages.equilibrium + stages.factorization) / pieces;
        let untold = || Failure::Computation("this system does not tell the memory of a process".into());
        let bytes_of = |row: &ScalingRow| row.peak_memory.map(|peak| peak * 1024.0_f64.powi(3)).ok_or_else(untold);
        let (small, large) = (bytes_of(&small)?, bytes_of(&large)?);
        let bytes = (large - small) / (pieces - count(CASES[0]));
        Ok(Self {
            factor,
            product: tight_seconds / (pieces * tight.applications() as f64),
            adjoint_product: adjoint.seconds / (pieces * adjoint_products),
            derivative: (stages.recovery + adjoint.shape_seconds) / pieces,
            products,
            adjoint_products,
            sparse_rate: estimate.torn_factorization / (pieces * factor),
            dense_rate: dense_rate(),
            bytes,
            base_bytes: (small - count(CASES[0]) * bytes).max(0.0),
            subdomain_dofs: 3.0 * ((case.ratio() + 1) as f64).powi(3),
        })
    }
}

/// Operations per second of a dense LU factorisation with partial pivoting.
fn dense_rate() -> f64 {
    let entry = |row: usize, column: usize| if row == column { 40.0 } else { (1.7 * (row * 7 + column) as f64).sin() };
    let matrix = Mat::from_fn(DENSE_ROWS, DENSE_ROWS, entry);
    let clock = Instant::now();
    let factor = matrix.partial_piv_lu();
    let seconds = clock.elapsed().as_secs_f64();
    std::hint::black_box(factor);
    2.0 / 3.0 * (DENSE_ROWS as f64).powi(3) / seconds
}
