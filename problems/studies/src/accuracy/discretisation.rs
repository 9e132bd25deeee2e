//! Error of the discretisation against bricks, dofs and seconds.
//!
//! Θ = Σσ_i⁴ is a sum over nodes and grows with their number; what converges is ΣA_iσ_i⁴ → ∫σ⁴.

use crate::accuracy::extent::case;
use crate::accuracy::objective::{EXPONENT, norm, objective_of};
use crate::rates::{Extrapolation, extrapolate, observed};
use crate::scaling::SceneName;
use nonsmooth::{Accuracy, StateSolver};
use problems::commands::Failure;
use serde::Serialize;
use std::time::Instant;

/// What is measured on every mesh, in order.
pub const QUANTITIES: [&str; 5] = ["∫σ⁴", "peak pressure", "Σλ_N x₁", "Σλ_N r²", "strain energy"];

/// Errors on a mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshRow {
    pub bricks: usize,
    /// Torn dofs of all bodies.
    pub dofs: usize,
    /// Seconds of the state.
    pub seconds: f64,
    /// The quantities, in N, mm, MPa.
    pub values: [f64; QUANTITIES.len()],
    /// Errors of the quantities relative to the extrapolated limits.
    pub errors: [f64; QUANTITIES.len()],
    /// Rates observed from the row before.
    pub rates: [Option<f64>; QUANTITIES.len()],
}

/// One scene on all meshes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshStudy {
    pub scene: SceneName,
    /// Limits; the finest mesh takes the place of one that cannot be extrapolated.
    pub limits: [Extrapolation; QUANTITIES.len()],
    /// Errors per mesh, coarse to fine.
    pub rows: Vec<MeshRow>,
}

/// Accuracy of the states, far below the error of any mesh.
const ALGEBRA: f64 = 1e-9;
/// Coarsest mesh that takes part in the extrapolation, where there are enough finer ones.
const ASYMPTOTIC: usize = 8;

/// Solves a scene on all meshes.
pub fn study(scene: SceneName, meshes: &[usize]) -> Result<MeshStudy, Failure> {
    let mut rows = meshes.iter().map(|&mesh| measure(scene, mesh)).collect::<Result<Vec<_>, _>>()?;
    let fine: Vec<&MeshRow> = match rows.iter().filter(|row| row.bricks >= ASYMPTOTIC).count() {
        0..=2 => rows.iter().collect(),
        _ => rows.iter().filter(|row| row.bricks >= ASYMPTOTIC).collect(),
    };
    let sizes: Vec<f64> = fine.iter().map(|row| row.bricks as f64).collect();
    let limits = std::array::from_fn(|index| {
        let values: Vec<f64> = fine.iter().map(|row| row.values[index]).collect();
        let finest = values.last().copied().unwrap_or(f64::NAN);
        extrapolate(&sizes, &values).unwrap_or(Extrapolation { limit: finest, rate: f64::NAN, misfit: f64::NAN })
    });
    for row in &mut rows {
        row.errors = std::array::from_fn(|index| (row.values[index] / limits[index].limit - 1.0).abs());
    }
    for index in 1..rows.len() {
        let (before, row) = (rows[index - 1].clone(), &mut rows[index]);
        let meshes = [before.bricks as f64, row.bricks as f64];
        row.rates = std::array::from_fn(|which| observed(meshes, [before.errors[which], row.errors[which]]));
    }
    Ok(MeshStudy { scene, limits, rows })
}

fn measure(scene: SceneName, mesh: usize) -> Result<MeshRow, Failure> {
    let objective = objective_of(scene, mesh, norm())?;
    let shape = objective.solver();
    let clock = Instant::now();
    let state = shape.solve(&shape.start(), None, Accuracy::relative(ALGEBRA)?)?;
    let seconds = clock.elapsed().as_secs_f64();
    let problem = shape.problem();
    let bodies = shape.bodies(&state)?;
    let (mut integral, mut peak, mut first, mut second) = (0.0, 0.0_f64, 0.0, 0.0);
    let nodes = problem.boundary.points.iter().zip(&state.rows.nodes).zip(&state.forces.normal);
    for ((point, row), &force) in nodes {
        let [x1, x2, _] = bodies[0].positions[point.node as usize];
        let pressure = force / row.area;
        integral += row.area * pressure.powf(EXPONENT);
        peak = peak.max(pressure);
        first += force * x1;
        second += force * (x1 * x1 + x2 * x2);
    }
    let energy = bodies.iter().zip(&*problem.bodies).map(|(solved, body)| solved.strain_energy(body)).sum();
    let case = case(mesh);
    let dofs = 3 * bodies.len() * case.subdomains.pow(3) * (case.ratio() + 1).pow(3);
    let values = [integral, peak, first, second, energy];
    let none = [f64::NAN; QUANTITIES.len()];
    Ok(MeshRow { bricks: mesh, dofs, seconds, values, errors: none, rates: [None; QUANTITIES.len()] })
}
