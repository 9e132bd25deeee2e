//! Error of the discretisation against bricks, dofs and seconds.
//!
//! Θ = Σσ_i⁴ is a sum over nodes and grows with their number; what converges is ΣA_iσ_i⁴ → ∫σ⁴.

use crate::accuracy::objective::{EXPONENT, case, objective_of};
use crate::markdown::{seconds, section};
use crate::rates::{Extrapolation, extrapolate};
use crate::scaling::{SceneName, option_name};
use nonsmooth::{Accuracy, StateSolver};
use problems::commands::Failure;
use serde::Serialize;
use std::time::Instant;

/// What is measured on every mesh, in order.
pub const QUANTITIES: [&str; 5] = ["∫σ⁴", "peak pressure", "Σλ_N x₁", "Σλ_N r²", "strain energy"];
/// Accuracy of the states, far below the error of any mesh.
const ALGEBRA: f64 = 1e-9;
/// Coarsest mesh that takes part in the extrapolation, where there are enough finer ones.
const ASYMPTOTIC: usize = 8;

/// Errors on a mesh.
#[derive(Debug, Serialize)]
pub struct MeshRow {
    pub bricks: usize,
    /// Torn dofs of all bodies.
    dofs: usize,
    /// Seconds of the state.
    seconds: f64,
    /// The quantities, in N, mm, MPa.
    values: [f64; QUANTITIES.len()],
    /// Errors of the quantities relative to the extrapolated limits.
    pub errors: [f64; QUANTITIES.len()],
}

/// One scene on all meshes.
#[derive(Debug, Serialize)]
pub struct MeshStudy {
    pub scene: SceneName,
    /// Limits; the finest mesh takes the place of one that cannot be extrapolated.
    limits: [Extrapolation; QUANTITIES.len()],
    /// Errors per mesh, coarse to fine.
    pub rows: Vec<MeshRow>,
}

impl MeshStudy {
    /// Solves a scene on all meshes.
    pub fn new(scene: SceneName, meshes: &[usize]) -> Result<Self, Failure> {
        let mut rows = meshes.iter().map(|&mesh| measure(scene, mesh)).collect::<Result<Vec<_>, _>>()?;
        let asymptotic = |row: &&MeshRow| row.bricks >= ASYMPTOTIC;
        let enough = rows.iter().filter(asymptotic).count() > 2;
        let fine: Vec<&MeshRow> = rows.iter().filter(|row| !enough || asymptotic(row)).collect();
        let sizes: Vec<f64> = fine.iter().map(|row| row.bricks as f64).collect();
        let limits: [Extrapolation; QUANTITIES.len()] = std::array::from_fn(|index| {
            let values: Vec<f64> = fine.iter().map(|row| row.values[index]).collect();
            let finest = values.last().copied().unwrap_or(f64::NAN);
            extrapolate(&sizes, &values).unwrap_or(Extrapolation { limit: finest, rate: f64::NAN })
        });
        for row in &mut rows {
            row.errors = std::array::from_fn(|index| (row.values[index] / limits[index].limit - 1.0).abs());
        }
        Ok(Self { scene, limits, rows })
    }

    /// The table of errors with the limits.
    pub fn markdown(&self) -> String {
        let rows = self.rows.iter().map(|row| {
            let mut cells = vec![format!("{}³", row.bricks), row.dofs.to_string(), seconds(row.seconds)];
            cells.extend(row.errors.map(|error| format!("{error:.1e}")));
            cells
        });
        let head = format!("bricks | dofs | seconds | {}", QUANTITIES.join(" | "));
        let limit =
            |(name, limit): (&&str, &Extrapolation)| format!("{name} {:.6e} (rate {:.2})", limit.limit, limit.rate);
        let limits: Vec<String> = QUANTITIES.iter().zip(&self.limits).map(limit).collect();
        let title = format!("{}: error of the discretisation", option_name(&self.scene));
        section(&title, &head, rows) + &format!("\nExtrapolated: {}.\n", limits.join("; "))
    }
}

fn measure(scene: SceneName, mesh: usize) -> Result<MeshRow, Failure> {
    let objective = objective_of(scene, mesh)?;
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
    let dofs = bodies.len() * case(mesh).torn_dofs();
    let values = [integral, peak, first, second, energy];
    Ok(MeshRow { bricks: mesh, dofs, seconds, values, errors: [f64::NAN; QUANTITIES.len()] })
}
