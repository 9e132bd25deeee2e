//! A smooth solution of linear elasticity, and how far the bricks are from it.
//!
//! ```text
//! u = A sin(k·x + φ),   −div σ(u) = [(λ + μ)(k·A) k + μ |k|² A] sin(k·x + φ)
//! |u − u_h|_L² = O(h²),   |u − u_h|_energy = O(h),   |u|²_energy = ∫ σ(u):∇u
//! ```
//! The block has a curved upper surface; u is prescribed on all of its boundary. Integrals by 3 × 3 × 3 Gauss points,
//! where the gradients are not better than elsewhere (at 2 × 2 × 2 they are).

use crate::held_block::{self, samples, solution};
use crate::markdown::{or_dash, seconds as short, section};
use crate::rates::observed;
use contact::body::Body;
use contact::body::elasticity::Material;
use contact::body::elasticity::stiffness::stress;
use contact::body::mesh::{Grid, block};
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

fn argument(x: [f64; 3]) -> f64 {
    x.iter().zip(WAVE).map(|(x, k)| x * k).sum::<f64>() + PHASE
}

fn displacement(x: [f64; 3]) -> [f64; 3] {
    AMPLITUDE.map(|a| a * argument(x).sin())
}

/// The derivatives ∂u_j/∂x_i of the solution as `[j][i]`.
pub fn smooth_gradient(x: [f64; 3]) -> [[f64; 3]; 3] {
    let cosine = argument(x).cos();
    AMPLITUDE.map(|a| WAVE.map(|k| a * k * cosine))
}

/// Solves on `bricks`³ bricks and integrates the errors.
///
/// # Errors
/// [`Failure::Computation`] when the stiffness matrix cannot be factored.
pub fn manufactured_errors(bricks: usize) -> Result<ManufacturedErrors, Failure> {
    let clock = Instant::now();
    let material = Material::new(1.0, 0.3)?;
    let (body, dofs, u) = smooth_solution(bricks, material)?;
    let seconds = clock.elapsed().as_secs_f64();
    let lame = (material.lame_lambda(), material.shear_modulus());
    let (mut square, mut energy) = ([0.0; 2], [0.0; 2]);
    for brick in 0..body.mesh.cell_count() {
        let local = body.mesh.cell_values(brick, &u);
        for sample in samples(&body.mesh, brick) {
            let (exact, slope) = (displacement(sample.x), smooth_gradient(sample.x));
            let found = sample.point.gradient(&local);
            let difference = std::array::from_fn(|j| std::array::from_fn(|i| found[j][i] - slope[j][i]));
            for (sum, gradient) in energy.iter_mut().zip([difference, slope]) {
                *sum += sample.point.volume * contraction(&stress(&gradient, lame), &gradient);
            }
            for (j, exact) in exact.into_iter().enumerate() {
                let value: f64 = sample.values.iter().enumerate().map(|(a, n)| n * local[3 * a + j]).sum();
                square[0] += sample.point.volume * (value - exact).powi(2);
                square[1] += sample.point.volume * exact.powi(2);
            }
        }
    }
    Ok(ManufacturedErrors { bricks, dofs, displacement: relative(square), energy: relative(energy), seconds })
}

/// The body, its number of dofs that are not prescribed, and the displacement per node on `bricks`³ bricks.
///
/// # Errors
/// [`Failure::Computation`] when the stiffness matrix cannot be factored.
pub fn smooth_solution(bricks: usize, material: Material) -> Result<(Body, usize, Vec<[f64; 3]>), Failure> {
    let grid = Grid { cells: [bricks; 3], corner: [0.0; 2], size: [1.0, 1.0] };
    let upper: Vec<f64> = grid.places().map(|[x1, x2]| 1.0 + 0.15 * (2.0 * x1).sin() * (3.0 * x2).cos()).collect();
    let body = held_block::body(block(&grid, [1; 3], &vec![0.0; grid.column_count()], &upper)?, material)?;
    let (lambda, mu) = (material.lame_lambda(), material.shear_modulus());
    let along: f64 = WAVE.iter().zip(AMPLITUDE).map(|(k, a)| k * a).sum();
    let square: f64 = WAVE.iter().map(|k| k * k).sum();
    let force: [f64; 3] = std::array::from_fn(|i| (lambda + mu) * along * WAVE[i] + mu * square * AMPLITUDE[i]);
    let body_force = |x: [f64; 3]| force.map(|f| f * argument(x).sin());
    let (free, u) = solution(&body, (&body_force, &displacement))?;
    Ok((body, free, u.as_chunks().0.to_vec()))
}

fn contraction(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
}

/// √(a/b), of a sum of squared errors and a sum of squares.
fn relative(sums: [f64; 2]) -> f64 {
    (sums[0] / sums[1]).sqrt()
}

/// The table of errors, with the rates from mesh to mesh.
pub fn markdown(meshes: &[ManufacturedErrors]) -> String {
    let rows = meshes.iter().enumerate().map(|(index, row)| {
        let before = index.checked_sub(1).map(|index| &meshes[index]);
        let mut cells = vec![format!("{}³", row.bricks), row.dofs.to_string(), short(row.seconds)];
        for error in [|row: &ManufacturedErrors| row.displacement, |row: &ManufacturedErrors| row.energy] {
            let pair = |before: &ManufacturedErrors| {
                [[before.bricks, row.bricks].map(|n| n as f64), [error(before), error(row)]]
            };
            let rate = before.map(pair).and_then(|[meshes, errors]| observed(meshes, errors));
            cells.extend([format!("{:.2e}", error(row)), or_dash(rate, |rate| format!("{rate:.2}"))]);
        }
        cells
    });
    let head = "bricks | dofs | seconds | L² error | rate | energy error | rate";
    section("Smooth solution of linear elasticity", head, rows)
}
