//! Error of the contact solvers against tolerance and seconds, with the estimate reported beside the true error.

use crate::accuracy::extent::case;
use crate::accuracy::objective::{METHODS, norm, objective_by};
use crate::scaling::{SceneName, Variant};
use nonsmooth::{Accuracy, StateSolver, Vector};
use problems::commands::{ContactObjective, Failure};
use serde::Serialize;
use std::time::Instant;

/// One solver at one tolerance; errors relative to the tightest state of direct condensation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AlgebraRow {
    /// Name of the solver.
    pub method: &'static str,
    /// Relative accuracy of Θ asked for.
    pub tolerance: f64,
    /// Seconds of state and subgradient.
    pub seconds: f64,
    /// Products with the dual operator; 0 for direct condensation.
    pub products: usize,
    pub residual: f64,
    /// Largest error of a pressure over the largest pressure.
    pub pressure: f64,
    /// Error of Θ over Θ.
    pub value: f64,
    /// Bound of the error of Θ that the solver reports, over Θ.
    pub bound: f64,
    /// Error of Θ less the reported first order error, over Θ.
    pub corrected: f64,
    /// |ξ − ξ*| over |ξ*|.
    pub subgradient: f64,
}

/// All solvers and tolerances on one scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AlgebraStudy {
    pub scene: SceneName,
    pub bricks: usize,
    /// The rows, by solver, tolerances descending.
    pub rows: Vec<AlgebraRow>,
    /// Rows whose bound lies below the true error, rounding of the reference apart.
    pub violations: usize,
    /// Number of rows whose error lies above rounding.
    pub compared: usize,
    /// Median of bound over error among the rows whose error lies above rounding.
    pub median_ratio: f64,
}

/// Relative rounding error of the reference.
pub const ROUNDING: f64 = 1e-13;

struct Exact {
    pressures: Vec<f64>,
    value: f64,
    subgradient: Vector,
}

/// Runs all solvers.
pub fn study(scene: SceneName, bricks: usize, exponents: &[i32]) -> Result<AlgebraStudy, Failure> {
    let objective = |variant| objective_by(variant, scene.scene(case(bricks))?, norm());
    let reference = objective(Variant::Direct)?;
    let control = perturbed(&reference);
    let states = reference.cases().solve(&control, None, Accuracy::TIGHTEST)?;
    let evaluation = reference.differentiate(&control, &states)?;
    let exact = Exact {
        pressures: reference.pressures(&states[0]),
        value: evaluation.value,
        subgradient: evaluation.subgradient,
    };
    let mut rows = Vec::new();
    for (name, variant) in METHODS {
        let objective = objective(variant)?;
        // The first solve pays for what is kept from solve to solve.
        objective.solver().solve(&control, None, Accuracy::relative(0.1)?)?;
        for &exponent in exponents {
            rows.push(row(&objective, name, &control, 10.0_f64.powi(-exponent), &exact)?);
        }
    }
    let mut ratios: Vec<f64> =
        rows.iter().filter(|row| row.value > ROUNDING).map(|row| row.bound / row.value).collect();
    ratios.sort_by(f64::total_cmp);
    Ok(AlgebraStudy {
        scene,
        bricks,
        violations: rows.iter().filter(|row| row.value > row.bound + ROUNDING).count(),
        compared: ratios.len(),
        median_ratio: ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN),
        rows,
    })
}

/// Controls of the start, each lowered at random by 1 to 3 %, so that the shape has no symmetry.
pub fn perturbed(objective: &ContactObjective) -> Vector {
    const SEED: u64 = 5;
    let start = objective.solver().start();
    start.zip_map(&nonsmooth::verify::seeded_direction(start.len(), SEED), |height, change| {
        height * (0.98 + 0.01 * change)
    })
}

fn row(
    objective: &ContactObjective,
    method: &'static str,
    control: &Vector,
    tolerance: f64,
    exact: &Exact,
) -> Result<AlgebraRow, Failure> {
    let shape = objective.solver();
    let clock = Instant::now();
    let states = objective.cases().solve(control, None, Accuracy::relative(tolerance)?)?;
    let state = &states[0];
    let dual = objective.cost_gradient(control, &states).state;
    let (subgradient, error) = shape.pull_back(control, state, &dual)?;
    let seconds = clock.elapsed().as_secs_f64();
    let largest = exact.pressures.iter().copied().fold(0.0, f64::max);
    let pressures = objective.pressures(state);
    let worst = pressures.iter().zip(&exact.pressures).map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max);
    let value = objective.value(&states);
    Ok(AlgebraRow {
        method,
        tolerance,
        seconds,
        products: state.work().dual_operator_applications,
        residual: state.forces.residuals.newton,
        pressure: worst / largest,
        value: (value / exact.value - 1.0).abs(),
        bound: error.bound / exact.value,
        corrected: ((value - error.first_order) / exact.value - 1.0).abs(),
        subgradient: (subgradient - &exact.subgradient).norm() / exact.subgradient.norm(),
    })
}
