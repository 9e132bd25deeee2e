//! Error of the contact solvers against tolerance and seconds, with the estimate reported beside the true error.

use crate::accuracy::objective::{objective, perturbed};
use crate::markdown::{seconds, section};
use crate::scaling::{SceneName, Variant, option_name};
use nonsmooth::{Accuracy, Evaluation, StateSolver, Vector};
use problems::commands::{ContactObjective, Failure};
use serde::Serialize;
use std::time::Instant;

/// All contact solvers and preconditioners, with their names in tables and pictures.
const METHODS: [(&str, Variant); 6] = [
    ("descent, Dirichlet", Variant::Dirichlet),
    ("descent, lumped", Variant::Lumped),
    ("descent, none", Variant::None),
    ("Newton–GMRES", Variant::Gmres),
    ("augmented Lagrangian", Variant::AugmentedLagrangian),
    ("direct condensation", Variant::Direct),
];
/// Relative rounding error of the reference.
const ROUNDING: f64 = 1e-13;

/// One solver at one tolerance; errors relative to the tightest state of direct condensation.
#[derive(Debug, Serialize)]
pub struct AlgebraRow {
    /// Name of the solver.
    pub method: &'static str,
    /// Relative accuracy of Θ asked for.
    tolerance: f64,
    /// Seconds of state and subgradient.
    pub seconds: f64,
    /// Products with the dual operator; 0 for direct condensation.
    products: usize,
    /// Largest error of a pressure over the largest pressure.
    pressure: f64,
    /// Error of Θ over Θ.
    pub value: f64,
    /// Bound of the error of Θ that the solver reports, over Θ.
    bound: f64,
    /// Error of Θ less the reported first order error, over Θ.
    corrected: f64,
    /// |ξ − ξ*| over |ξ*|.
    subgradient: f64,
}

/// All solvers and tolerances on one scene.
#[derive(Debug, Serialize)]
pub struct AlgebraStudy {
    pub scene: SceneName,
    pub bricks: usize,
    /// The rows, by solver, tolerances descending.
    pub rows: Vec<AlgebraRow>,
    /// Rows whose bound lies below the true error, rounding of the reference apart.
    violations: usize,
    /// Number of rows whose error lies above rounding.
    compared: usize,
    /// Median of bound over error among the rows whose error lies above rounding.
    median_ratio: f64,
}

impl AlgebraStudy {
    /// Runs all solvers.
    pub fn new(scene: SceneName, bricks: usize, exponents: &[i32]) -> Result<Self, Failure> {
        let by = |variant| objective(variant, scene, bricks);
        let reference = by(Variant::Direct)?;
        let control = perturbed(&reference);
        let states = reference.cases().solve(&control, None, Accuracy::TIGHTEST)?;
        let exact = (reference.pressures(&states[0]), reference.differentiate(&control, &states)?);
        let mut rows = Vec::new();
        for (name, variant) in METHODS {
            let objective = by(variant)?;
            // The first solve pays for what is kept from solve to solve.
            objective.solver().solve(&control, None, Accuracy::relative(0.1)?)?;
            for &exponent in exponents {
                rows.push(row(&objective, name, &control, 10.0_f64.powi(-exponent), &exact)?);
            }
        }
        let above = rows.iter().filter(|row| row.value > ROUNDING);
        let mut ratios: Vec<f64> = above.map(|row| row.bound / row.value).collect();
        ratios.sort_by(f64::total_cmp);
        Ok(Self {
            scene,
            bricks,
            violations: rows.iter().filter(|row| row.value > row.bound + ROUNDING).count(),
            compared: ratios.len(),
            median_ratio: ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN),
            rows,
        })
    }

    /// The table of errors, and how the bounds compare with them.
    pub fn markdown(&self) -> String {
        let rows = self.rows.iter().map(|row| {
            let mut cells = vec![row.method.to_owned(), format!("{:.0e}", row.tolerance)];
            cells.extend([seconds(row.seconds), row.products.to_string()]);
            let errors = [row.pressure, row.value, row.bound, row.corrected, row.subgradient];
            cells.extend(errors.map(|error| format!("{error:.1e}")));
            cells
        });
        let head = "solver | tolerance | seconds | products | pressure error | Θ error | bound reported | Θ corrected | ξ error";
        let title = format!("{}, {}³ bricks: error of the contact solvers", option_name(&self.scene), self.bricks);
        let Self { violations, compared, median_ratio, .. } = self;
        section(&title, head, rows)
            + &format!(
                "\nBound below the true error: {violations} of {} rows; bound over error among the {compared} rows above \
                 rounding: median {median_ratio:.1}.\n",
                self.rows.len()
            )
    }
}

/// Pressures and evaluation of the reference.
type Exact<W> = (Vec<f64>, Evaluation<W>);

fn row<W>(
    objective: &ContactObjective,
    method: &'static str,
    control: &Vector,
    tolerance: f64,
    (exact_pressures, exact): &Exact<W>,
) -> Result<AlgebraRow, Failure> {
    let clock = Instant::now();
    let states = objective.cases().solve(control, None, Accuracy::relative(tolerance)?)?;
    let state = &states[0];
    let dual = objective.cost_gradient(control, &states).state;
    let (subgradient, error) = objective.solver().pull_back(control, state, &dual)?;
    let seconds = clock.elapsed().as_secs_f64();
    let pressures = objective.pressures(state);
    let largest = exact_pressures.iter().copied().fold(0.0, f64::max);
    let worst = pressures.iter().zip(exact_pressures).map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max);
    let value = objective.value(&states);
    Ok(AlgebraRow {
        method,
        tolerance,
        seconds,
        products: state.work().dual_operator_applications,
        pressure: worst / largest,
        value: (value / exact.value - 1.0).abs(),
        bound: error.bound / exact.value,
        corrected: ((value - error.first_order) / exact.value - 1.0).abs(),
        subgradient: (subgradient - &exact.subgradient).norm() / exact.subgradient.norm(),
    })
}
