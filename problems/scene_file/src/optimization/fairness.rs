//! Of shapes that are equally good, the one that bends least.
//!
//! ```text
//! min ½ (α + d)ᵀB(α + d)   over   |G d| ≤ ε max σ,   s + S d ≥ 0,   α + d ∈ U
//! ```
//! G is the Jacobian of the pressures σ, case by case, s > 0 are the gaps of open nodes with their Jacobian S: to first
//! order all nodes that carry go on as they do, and no other one begins to. Θ does not see what is left.

use crate::optimization::OptimizationError;
use contact::contact_objective::ContactObjective;
use contact::error::SceneError;
use contact::shape::bending_rows;
use nonsmooth::composite::{Linearization, LinearizationRequest, Linearized};
use nonsmooth::qp::{EpigraphQp, EpigraphQpSolver, Metric, project};
use nonsmooth::{Accuracy, Matrix, NonsmoothObjective, Polyhedron, Request, Vector};

/// ε, the change of a pressure over the largest one that counts as none, and that of any other output over itself.
const SAME: f64 = 1e-3;
/// Share of the bending that must go for another shape to be worth a run.
const WORTH: f64 = 0.2;
/// Weight of the distance to the shape itself, over the largest entry of B: it decides among planes.
const DISTANCE: f64 = 1e-9;

/// Relative rounding of sums of differences.
const ROUNDING: f64 = 1e-12;

/// A fairer shape and what it changes.
#[derive(Debug, Clone, PartialEq)]
pub struct FairShape {
    /// Its controls.
    pub controls: Vector,
    /// Bending before.
    pub before: f64,
}

/// αᵀBα of the controls of all bodies.
///
/// # Errors
/// As [`bending_rows`].
pub fn bending_of(objective: &ContactObjective, controls: &Vector) -> Result<f64, SceneError> {
    Ok(bending(&bending_rows(&objective.solver().problem().scene)?, controls))
}

/// |Rα|²; 0 where it is rounding, which decides nothing.
fn bending(rows: &Matrix, controls: &Vector) -> f64 {
    let (found, terms) = (rows * controls, rows.abs() * controls.abs());
    if found.norm() > ROUNDING * terms.norm() { found.norm_squared() } else { 0.0 }
}

/// The shape of least bending that is as good as this one to first order; none where it would hardly bend less, or
/// where Θ is no function of the pressures. Takes an evaluation with a Jacobian.
///
/// # Errors
/// [`OptimizationError::Derivatives`] from the contact solver.
pub fn fair_shape(objective: &ContactObjective, controls: &Vector) -> Result<Option<FairShape>, OptimizationError> {
    let rows = bending_rows(&objective.solver().problem().scene)?;
    let accuracy = Accuracy::relative(1e-4).unwrap_or(Accuracy::TIGHTEST);
    let wanted = LinearizationRequest { accuracy, below: f64::INFINITY };
    let request = Request { linearization: Some(wanted), ..Request::tight(controls) };
    let evaluation = objective.evaluate(&request)?.into_evaluation();
    let Linearized::Known(linearization) = &evaluation.linearization else { return Ok(None) };
    let set = objective.solver().problem().admissible.polyhedron();
    let sizes = objective.cost().sizes(&linearization.outputs);
    let Some(step) = fairest(&rows.tr_mul(&rows), (linearization, &sizes), set, controls) else { return Ok(None) };
    let Ok(fair) = project(set, &(controls + step)) else { return Ok(None) };
    let [before, after] = [controls, &fair].map(|controls| bending(&rows, controls));
    Ok((after < (1.0 - WORTH) * before).then_some(FairShape { controls: fair, before }))
}

/// The minimiser d of the program; `sizes`: what changes of the outputs are compared with, where they count.
fn fairest(
    matrix: &Matrix,
    (linearization, sizes): (&Linearization, &[Option<f64>]),
    set: &Polyhedron,
    controls: &Vector,
) -> Option<Vector> {
    let mut rows: Vec<(Vector, [f64; 2])> = Vec::new();
    let mut push = |row: Vector, sides: [f64; 2]| {
        let size = row.amax();
        if size > 0.0 {
            rows.push((row / size, sides.map(|side| side / size)));
        }
    };
    for (row, size) in linearization.jacobian.row_iter().zip(sizes) {
        size.iter().for_each(|size| push(row.transpose(), [-SAME * size, SAME * size]));
    }
    if let Some(inactive) = &linearization.inactive {
        for (row, slack) in inactive.jacobian.row_iter().zip(&inactive.slacks) {
            push(row.transpose(), [-slack, f64::INFINITY]);
        }
    }
    // The shape lies in the set up to rounding.
    let room = |lower: f64, upper: f64, at: f64| [(lower - at).min(0.0), (upper - at).max(0.0)];
    let products = set.rows() * controls;
    for (index, row) in set.rows().row_iter().enumerate() {
        push(row.transpose(), room(set.row_lower()[index], set.row_upper()[index], products[index]));
    }
    let count = controls.len();
    let table = Matrix::from_fn(rows.len(), count, |i, j| rows[i].0[j]);
    let side = |which: usize| Vector::from_iterator(rows.len(), rows.iter().map(|(_, sides)| sides[which]));
    let bounds: Vec<[f64; 2]> = (0..count).map(|i| room(set.lower()[i], set.upper()[i], controls[i])).collect();
    let bound = |which: usize| Vector::from_iterator(count, bounds.iter().map(|sides| sides[which]));
    let metric = matrix + Matrix::identity(count, count) * (DISTANCE * matrix.diagonal().amax());
    let program = EpigraphQp {
        metric: Metric::Dense(&metric),
        slopes: &[matrix * controls],
        offsets: &[0.0],
        cut_ids: &[0],
        rows: &table,
        row_lower: &side(0),
        row_upper: &side(1),
        lower: &bound(0),
        upper: &bound(1),
    };
    EpigraphQpSolver::new().solve(&program).ok().map(|solution| solution.step)
}
