//! Volumetric locking, measured: a divergence-free field in the unit cube, whose load does not depend on λ.
//!
//! ```text
//! u = (sin²πx₁ sin 2πx₂, −sin 2πx₁ sin²πx₂, 0)·sin πx₃,   u = 0 on the boundary,   div u = 0,   f = −μ Δu
//! ```
//! The error of the displacements against h for ν → ½: trilinear bricks lose their rate, mean dilatation keeps it.

use crate::held_block::{body, solution};
use crate::stability::case::{Case, CaseOutcome, Record};
use contact::body::elasticity::{Formulation, Material};
use contact::body::mesh::{Grid, block};
use problems::commands::Failure;
use std::f64::consts::PI;

const GROUP: &str = "locking";
/// Meshes of a case.
const MESHES: [usize; 3] = [4, 8, 16];
/// Rate below which a formulation counts as locked (2 is that of trilinear bricks).
const LOCKED: f64 = 1.5;

/// The field, and −Δ of it.
fn field([x, y, z]: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let square = |t: f64| (PI * t).sin().powi(2);
    let square_second = |t: f64| 2.0 * PI * PI * (2.0 * PI * t).cos();
    let double = |t: f64| (2.0 * PI * t).sin();
    let height = (PI * z).sin();
    let laplacian =
        |p: f64, q: f64| (square_second(p) * double(q) - (4.0 + 1.0) * PI * PI * square(p) * double(q)) * height;
    ([square(x) * double(y) * height, -double(x) * square(y) * height, 0.0], [-laplacian(x, y), laplacian(y, x), 0.0])
}

/// Relative error of the displacements (2-norm over the nodes) on n³ bricks of the unit cube.
///
/// # Errors
/// [`Failure`] for a bad Poisson ratio or a matrix that cannot be factored.
pub fn field_error(cells: usize, poisson_ratio: f64, formulation: Formulation) -> Result<f64, Failure> {
    let material = Material::new(1.0, poisson_ratio)?.with_formulation(formulation);
    let grid = Grid { cells: [cells; 3], corner: [0.0; 2], size: [1.0; 2] };
    let columns = grid.column_count();
    let body = body(block(&grid, [1; 3], &vec![0.0; columns], &vec![1.0; columns])?, material)?;
    let force = |x| field(x).1.map(|f| material.shear_modulus() * f);
    let (_, solution) = solution(&body, (&force, &|_| [0.0; 3]))?;
    let (mut error, mut size) = (0.0, 0.0);
    for (dof, value) in solution.iter().enumerate() {
        let exact = field(body.mesh.nodes()[dof / 3]).0[dof % 3];
        error += (value - exact).powi(2);
        size += exact.powi(2);
    }
    Ok((error / size).sqrt())
}

fn record(poisson_ratio: f64, formulation: Formulation) -> Record {
    let errors: Result<Vec<f64>, Failure> =
        MESHES.iter().map(|&cells| field_error(cells, poisson_ratio, formulation)).collect();
    let errors = match errors {
        Ok(errors) => errors,
        Err(error) => return Record::plain(CaseOutcome::Broken, error.to_string()),
    };
    let rate = (errors[1] / errors[2]).log2();
    let listed: Vec<String> = errors.iter().map(|error| format!("{error:.2e}")).collect();
    let text = format!("relative error for n = 4, 8, 16: {}; last rate {rate:.2}", listed.join(", "));
    if rate > LOCKED {
        return Record::plain(CaseOutcome::Solved, text);
    }
    let known = formulation == Formulation::Standard && poisson_ratio > 0.49;
    let outcome = if known { CaseOutcome::Limit } else { CaseOutcome::Broken };
    let cause = "eight volume constraints per brick leave too few deformations; choose mean dilatation";
    Record::plain(outcome, format!("{text}; locks: {cause}"))
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (formulation, label) in [(Formulation::Standard, "standard"), (Formulation::MeanDilatation, "mean dilatation")]
    {
        for poisson_ratio in [0.3, 0.499, 0.4999, 0.499_999] {
            let name = format!("ν = {poisson_ratio}, {label}, divergence-free field");
            cases.push(Case::new(GROUP, name, move || record(poisson_ratio, formulation)));
        }
    }
    cases
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_load_is_minus_the_laplacian_of_a_divergence_free_field() {
        let (x, h) = ([0.3, 0.6, 0.2], 1e-4);
        let at = |axis: usize, step: f64| {
            let mut place = x;
            place[axis] += step;
            field(place).0
        };
        let divergence: f64 = (0..3).map(|axis| (at(axis, h)[axis] - at(axis, -h)[axis]) / (2.0 * h)).sum();
        assert!(divergence.abs() < 1e-6);
        for component in 0..3 {
            let laplacian: f64 = (0..3)
                .map(|axis| (at(axis, h)[component] - 2.0 * field(x).0[component] + at(axis, -h)[component]) / (h * h))
                .sum();
            assert!((laplacian + field(x).1[component]).abs() < 1e-5, "{laplacian}");
        }
    }
}
