//! From model, weight and admissible set to a trial point with its certificate quantities.
//!
//! ```text
//! min over (d, v)  v + u‖d‖²/2,   ⟨h_i, d⟩ − a_i ≤ v,   x̂ + d ∈ U
//! z̃ = Σ λ_i h_i + Aᵀμ + ν = −u W d      aggregate subgradient, constraints included
//! ẽ = −v − u‖d‖² = Σ λ_i a_i + slack of the active constraints ≥ 0      aggregate error
//! ```

use super::curvature::{CurvedModel, Origin};
use super::model::Model;
use super::state::State;
use crate::qp::{EpigraphQp, EpigraphQpSolver, Metric, QpError, QpSolution, project};
use crate::{Polyhedron, Vector};

/// A trial point and what the model says about it.
#[derive(Debug, Clone)]
pub(crate) struct Proposal {
    pub trial: Vector,
    /// d = trial − x̂, shortened if the subproblem's solution left the set.
    pub step: Vector,
    /// ‖d‖ in the run's norm.
    pub step_length: f64,
    /// −v ≥ 0: what the model promises.
    pub predicted_decrease: f64,
    /// ‖z̃‖*.
    pub aggregate_norm: f64,
    /// ẽ.
    pub aggregate_error: f64,
    /// The part Σ λ_i a_i of ẽ.
    pub cut_error: f64,
    pub cut_multipliers: Vec<f64>,
    pub row_multipliers: Vector,
    pub bound_multipliers: Vector,
    pub convexification: f64,
    /// u of this subproblem.
    pub weight: f64,
    /// Relative violation of the set at the trial point.
    pub violation: f64,
    /// The model behind it.
    pub origin: Origin,
    /// Changes that the plain and the curved model predict at the trial point.
    pub predictions: Option<(f64, f64)>,
}

/// Trial points violate the set by at most this much, relative to each side.
pub(crate) const FEASIBILITY: f64 = 1e-12;

/// Why there is no trial point.
#[derive(Debug, Clone, thiserror::Error)]
pub(crate) enum SubproblemError {
    #[error("the quadratic program was not solved: {0}")]
    Qp(#[from] QpError),
    #[error("its solution violates the constraints by {violation:.1e} and cannot be repaired")]
    Infeasible { violation: f64 },
    #[error("its solution is not finite or contradicts itself")]
    Unusable,
}

/// Solves the subproblem at the state's weight.
pub(crate) fn solve(
    solver: &mut EpigraphQpSolver,
    set: &Polyhedron,
    state: &State,
    model: &Model,
) -> Result<Proposal, SubproblemError> {
    let weight = state.weight;
    let diagonal = state.norm.weights() * weight;
    let solution =
        solve_qp(solver, set, state, Metric::Diagonal(&diagonal), (&model.slopes, &model.offsets, &model.ids))?;
    let proposal = interpret(solution, state, model);
    // Every solution has −v ≥ u‖d‖²; one that promises less is not a solution.
    let least = 0.5 * proposal.aggregate_norm * proposal.step_length - state.rounding();
    if !(proposal.predicted_decrease >= least && proposal.step_length.is_finite()) {
        return Err(SubproblemError::Unusable);
    }
    make_feasible(proposal, set, state)
}

/// Solves the subproblem of a model with curvature and a weight beside it. Certificate quantities and multipliers stay those
/// of the plain proposal.
pub(crate) fn solve_curved(
    solver: &mut EpigraphQpSolver,
    set: &Polyhedron,
    state: &State,
    model: &CurvedModel,
    (plain, weight): (&Proposal, f64),
) -> Result<Proposal, SubproblemError> {
    let step = curved_step(solver, set, state, model, weight)?;
    let proposal = Proposal { trial: &state.center + &step, weight, violation: 0.0, ..plain.clone() };
    let mut proposal = make_feasible(Proposal { step, ..proposal }, set, state)?;
    proposal.predicted_decrease = -model.change(&proposal.step);
    if proposal.predicted_decrease > 0.0 && proposal.step_length.is_finite() {
        Ok(proposal)
    } else {
        Err(SubproblemError::Unusable)
    }
}

/// The step of least model value and penalty among those found with the multipliers of the solve before.
fn curved_step(
    solver: &mut EpigraphQpSolver,
    set: &Polyhedron,
    state: &State,
    model: &CurvedModel,
    weight: f64,
) -> Result<Vector, SubproblemError> {
    let cuts = (&model.slopes[..], &model.offsets[..], &model.ids[..]);
    let mut multipliers = first_multipliers(state, model);
    let mut best: Option<(f64, Vector)> = None;
    for _ in 0..model.rounds() {
        let mut metric = model.matrix(state.center.len(), &multipliers);
        for (i, scale) in state.norm.weights().iter().enumerate() {
            metric[(i, i)] += weight * scale;
        }
        let solution = match solve_qp(solver, set, state, Metric::Dense(&metric), cuts) {
            Ok(solution) => solution,
            // A later round only refines what an earlier one has found.
            Err(_) if best.is_some() => break,
            Err(error) => return Err(error.into()),
        };
        let total = model.change(&solution.step) + 0.5 * weight * state.norm.squared(&solution.step);
        if best.as_ref().is_none_or(|(least, _)| total < *least) {
            best = Some((total, solution.step));
        }
        multipliers = solution.cut_multipliers;
    }
    best.map(|(_, step)| step).ok_or(SubproblemError::Unusable)
}

/// Multipliers of the plain subproblem; what its other cuts carry goes to the center, which stands for them here.
fn first_multipliers(state: &State, model: &CurvedModel) -> Vec<f64> {
    let of = |id: &u64| state.bundle.cut(*id).map_or(0.0, |cut| cut.multiplier);
    let mut multipliers: Vec<f64> = model.ids.iter().map(of).collect();
    let rest = 1.0 - multipliers.iter().sum::<f64>();
    if let Some(center) = model.ids.iter().position(|id| *id == state.center_id) {
        multipliers[center] += rest.max(0.0);
    }
    multipliers
}

/// The quadratic program of slopes, offsets and identities of cuts.
fn solve_qp(
    solver: &mut EpigraphQpSolver,
    set: &Polyhedron,
    state: &State,
    metric: Metric<'_>,
    (slopes, offsets, cut_ids): (&[Vector], &[f64], &[u64]),
) -> Result<QpSolution, QpError> {
    let at_center = set.rows() * &state.center;
    let terms = set.rows().abs() * state.center.abs();
    solver.solve(&EpigraphQp {
        metric,
        slopes,
        offsets,
        cut_ids,
        rows: set.rows(),
        row_lower: &slack(set.row_lower(), &at_center, &terms, f64::min),
        row_upper: &slack(set.row_upper(), &at_center, &terms, f64::max),
        lower: &(set.lower() - &state.center),
        upper: &(set.upper() - &state.center),
    })
}

/// Sides of the rows as seen from the center; what is rounding of the center counts as zero, so that d = 0 is admissible.
fn slack(side: &Vector, at_center: &Vector, terms: &Vector, outward: fn(f64, f64) -> f64) -> Vector {
    Vector::from_fn(side.len(), |i, _| {
        let slack = side[i] - at_center[i];
        if slack.is_finite() && slack.abs() <= FEASIBILITY * terms[i].max(side[i].abs()) {
            0.0
        } else {
            outward(slack, 0.0)
        }
    })
}

fn interpret(mut solution: QpSolution, state: &State, model: &Model) -> Proposal {
    let step = solution.step;
    let squared = state.norm.squared(&step);
    let predicted_decrease = (-solution.epigraph).max(0.0);
    let cut_error: f64 = solution.cut_multipliers.iter().zip(&model.offsets).map(|(l, a)| l * a).sum();
    model.distribute(&mut solution.cut_multipliers);
    Proposal {
        trial: &state.center + &step,
        step_length: squared.sqrt(),
        step,
        predicted_decrease,
        aggregate_norm: state.weight * squared.sqrt(),
        aggregate_error: (predicted_decrease - state.weight * squared).max(0.0),
        cut_error,
        cut_multipliers: solution.cut_multipliers,
        row_multipliers: Vector::from_vec(solution.row_multipliers),
        bound_multipliers: Vector::from_vec(solution.bound_multipliers),
        convexification: model.convexification,
        weight: state.weight,
        violation: 0.0,
        origin: Origin::Plain,
        predictions: None,
    }
}

/// Clips to the box; where a row is still violated, projects or moves back towards the center, which is admissible.
fn make_feasible(mut proposal: Proposal, set: &Polyhedron, state: &State) -> Result<Proposal, SubproblemError> {
    let violation = |x: &Vector| set.violation_near(x, &state.center);
    let allowed = FEASIBILITY.max(violation(&state.center));
    proposal.trial = set.clamp_to_box(&proposal.trial);
    proposal.violation = violation(&proposal.trial);
    if proposal.violation > allowed
        && proposal.violation < 1e-6
        && let Ok(projected) = project(set, &proposal.trial)
        && violation(&projected) < proposal.violation
    {
        proposal.violation = violation(&projected);
        proposal.trial = projected;
    }
    let mut factor = 1.0;
    while proposal.violation > allowed {
        factor *= if factor > 0.99 { 1.0 - (2.0 * proposal.violation).clamp(1e-10, 0.3) } else { 0.7 };
        if factor < 1e-3 {
            return Err(SubproblemError::Infeasible { violation: proposal.violation });
        }
        proposal.trial = set.clamp_to_box(&(&state.center + &proposal.step * factor));
        proposal.violation = violation(&proposal.trial);
    }
    proposal.step = &proposal.trial - &state.center;
    proposal.step_length = state.norm.length(&proposal.step);
    Ok(proposal)
}
