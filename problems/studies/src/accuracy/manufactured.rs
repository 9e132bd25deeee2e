//! A smooth solution of linear elasticity, and how far the bricks are from it.
//!
//! ```text
//! u = A sin(k·x + φ),   −div σ(u) = [(λ + μ)(k·A) k + μ |k|² A] sin(k·x + φ)
//! |u − u_h|_L² = O(h²),   |u − u_h|_energy = O(h),   |u|²_energy = ∫ σ(u):∇u
//! ```
//! The block has a curved upper surface; u is prescribed on all of its boundary. Integrals by 3 × 3 × 3 Gauss points,
//! where the gradients are not better than elsewhere (at 2 × 2 × 2 they are). The stress recovered for pictures is
//! compared where it is taken: at the centres of the bricks, and as a mean at the nodes.

use crate::held_block::{THREE_POINTS, samples, solution};
use contact::body::elasticity::brick::{self, DOFS};
use contact::body::elasticity::hex8;
use contact::body::elasticity::stress::{COMPONENTS, von_mises};
use contact::body::elasticity::{Formulation, Material};
use contact::body::local_pattern::LocalPattern;
use contact::body::mesh::{Block, Grid};
use contact::equilibrium::SolvedBody;
use contact::fields::BodyFields;
use problems::commands::Failure;
use serde::Serialize;
use std::time::Instant;

/// Errors of one mesh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ManufacturedErrors {
    pub bricks: usize,
    /// Dofs that are not prescribed.
    pub dofs: usize,
    /// |u − u_h| over |u| in L².
    pub displacement: f64,
    /// |u − u_h| over |u| in the energy norm.
    pub energy: f64,
    /// Seconds of assembly and solution.
    pub seconds: f64,
}

const AMPLITUDE: [f64; 3] = [1.0, -0.6, 0.8];
const WAVE: [f64; 3] = [1.7, 2.3, -1.1];
const PHASE: f64 = 0.4;
struct Wave {
    force: [f64; 3],
}

impl Wave {
    fn new(material: &Material) -> Self {
        let (lambda, mu) = (material.lame_lambda(), material.shear_modulus());
        let along: f64 = WAVE.iter().zip(AMPLITUDE).map(|(k, a)| k * a).sum();
        let square: f64 = WAVE.iter().map(|k| k * k).sum();
        Self { force: std::array::from_fn(|i| (lambda + mu) * along * WAVE[i] + mu * square * AMPLITUDE[i]) }
    }

    fn argument(x: [f64; 3]) -> f64 {
        x.iter().zip(WAVE).map(|(x, k)| x * k).sum::<f64>() + PHASE
    }

    fn displacement(x: [f64; 3]) -> [f64; 3] {
        AMPLITUDE.map(|a| a * Self::argument(x).sin())
    }

    /// The derivatives ∂u_j/∂x_i as `[j][i]`.
    fn gradient(x: [f64; 3]) -> [[f64; 3]; 3] {
        let cosine = Self::argument(x).cos();
        AMPLITUDE.map(|a| WAVE.map(|k| a * k * cosine))
    }

    fn body_force(&self, x: [f64; 3]) -> [f64; 3] {
        self.force.map(|f| f * Self::argument(x).sin())
    }
}

/// Solves on `bricks`³ bricks and integrates the errors.
///
/// # Errors
/// [`Failure::Computation`] when the stiffness matrix cannot be factored.
pub fn manufactured_errors(bricks: usize) -> Result<ManufacturedErrors, Failure> {
    let clock = Instant::now();
    let material = Material::new(1.0, 0.3)?;
    let Smooth { block, pattern, free: dofs, u } = smooth(bricks, &material)?;
    let seconds = clock.elapsed().as_secs_f64();
    let lame = (material.lame_lambda(), material.shear_modulus());
    let (mut displacement, mut energy) = ([0.0; 2], [0.0; 2]);
    for brick in pattern.bricks() {
        let dofs = pattern.brick_dofs(brick);
        let local: [f64; DOFS] = dofs.map(|dof| u[dof]);
        for sample in samples(&block.brick(brick), &THREE_POINTS) {
            let (exact, slope) = (Wave::displacement(sample.x), Wave::gradient(sample.x));
            let found = brick::displacement_gradient(&sample.point, &local);
            let difference = std::array::from_fn(|j| std::array::from_fn(|i| found[j][i] - slope[j][i]));
            for (sum, gradient) in energy.iter_mut().zip([difference, slope]) {
                *sum += sample.point.volume * contraction(&hex8::stress(&gradient, lame), &gradient);
            }
            for (j, exact) in exact.into_iter().enumerate() {
                let value: f64 = sample.values.iter().enumerate().map(|(a, n)| n * local[3 * a + j]).sum();
                displacement[0] += sample.point.volume * (value - exact).powi(2);
                displacement[1] += sample.point.volume * exact.powi(2);
            }
        }
    }
    let relative = |sums: [f64; 2]| (sums[0] / sums[1]).sqrt();
    Ok(ManufacturedErrors { bricks, dofs, displacement: relative(displacement), energy: relative(energy), seconds })
}

/// The discrete solution of one mesh.
struct Smooth {
    block: Block,
    pattern: LocalPattern,
    /// Dofs that are not prescribed.
    free: usize,
    u: Vec<f64>,
}

fn smooth(bricks: usize, material: &Material) -> Result<Smooth, Failure> {
    let grid = Grid { cells: [bricks; 3], size: [1.0, 1.0] };
    let upper = grid.columns().map(|(i, j)| {
        let [x1, x2] = grid.position(i, j);
        1.0 + 0.15 * (2.0 * x1).sin() * (3.0 * x2).cos()
    });
    let block = Block { grid, lower: vec![0.0; grid.column_count()], upper: upper.collect() };
    let pattern = LocalPattern::new(grid.cells, &[]);
    let wave = Wave::new(material);
    let fields: (&dyn Fn(_) -> _, &dyn Fn(_) -> _) = (&|x| wave.body_force(x), &Wave::displacement);
    let (free, u) = solution((&pattern, &block), material, &THREE_POINTS, fields)?;
    Ok(Smooth { block, pattern, free, u })
}

/// Errors of the recovered stress of one mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressErrors {
    pub bricks: usize,
    /// √(Σ V|σ − σ_h|²/Σ V|σ|²) over the centres of the bricks.
    pub centre: f64,
    /// |σ_vM − σ_vM,h| over |σ_vM| over the nodes, Euclidean norms.
    pub nodal_von_mises: f64,
}

/// Solves on `bricks`³ bricks of a formulation and compares the fields of the body with the exact stress.
pub fn manufactured_stress_errors(bricks: usize, formulation: Formulation) -> Result<StressErrors, Failure> {
    let material = Material::new(1.0, 0.3)?.with_formulation(formulation);
    let Smooth { block, u, .. } = smooth(bricks, &material)?;
    let grid = block.grid;
    let displacement = u.chunks_exact(3).map(|u| [u[0], u[1], u[2]]).collect();
    let body = SolvedBody { block, displacement, gluing_defect: 0.0, subdomains: vec![0; grid.brick_count()] };
    let fields = BodyFields::new(body, &material);
    let exact = |x: [f64; 3]| {
        let full = hex8::stress(&Wave::gradient(x), (material.lame_lambda(), material.shear_modulus()));
        COMPONENTS.map(|(row, column)| full[row][column])
    };
    let mut centre = [0.0; 2];
    for (brick, found) in grid.bricks().zip(&fields.stress) {
        let nodes = fields.block.brick(brick);
        let middle = std::array::from_fn(|axis| nodes.iter().map(|node| node[axis] / 8.0).sum());
        for ((found, exact), (row, column)) in found.iter().zip(exact(middle)).zip(COMPONENTS) {
            let weight = brick::volume(&nodes) * if row == column { 1.0 } else { 2.0 };
            centre[0] += weight * (found - exact).powi(2);
            centre[1] += weight * exact.powi(2);
        }
    }
    let mut nodal = [0.0; 2];
    let [_, n2, n3] = grid.nodes();
    for (node, found) in fields.nodal_von_mises.iter().enumerate() {
        let exact = von_mises(&exact(fields.block.coordinates([node / (n2 * n3), node / n3 % n2, node % n3])));
        nodal[0] += (found - exact).powi(2);
        nodal[1] += exact.powi(2);
    }
    let relative = |sums: [f64; 2]| (sums[0] / sums[1]).sqrt();
    Ok(StressErrors { bricks, centre: relative(centre), nodal_von_mises: relative(nodal) })
}

fn contraction(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
}
