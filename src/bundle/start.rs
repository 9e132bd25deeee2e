//! The first evaluation: admissible start, norm, first weight.

use super::config::AccuracyPolicy;
use super::curvature::CurvatureRecord;
use super::cut::{Bundle, Cut};
use super::norm::ScaledNorm;
use super::oracle::{Outcome, evaluate};
use super::state::State;
use crate::linalg::first_non_finite;
use crate::qp::{QpError, project};
use crate::report::{Counts, IterationRecord, StepKind};
use crate::{
    Accuracy, BundleTrustConfig, Evaluation, InputError, NonsmoothObjective, OptimizeError, OracleError, Polyhedron,
    Request, Vector,
};

/// Checks sizes, and moves the start into the admissible set.
pub(super) fn admissible_start(set: &Polyhedron, dimension: usize, x0: Vector) -> Result<Vector, OptimizeError> {
    for (what, found) in [("start point", x0.len()), ("constraints", set.dimension())] {
        if found != dimension {
            return Err(InputError::Dimension { what, expected: dimension, found }.into());
        }
    }
    if let Some(index) = first_non_finite(x0.as_slice()) {
        return Err(InputError::NotFinite { what: "start point", index, value: x0[index] }.into());
    }
    let before = set.violation(&x0);
    if before <= super::subproblem::FEASIBILITY {
        return Ok(set.clamp_to_box(&x0));
    }
    let projected = project(set, &x0).map_err(|error| match error {
        QpError::Infeasible { violation } => OptimizeError::Infeasible { violation },
        _ => OptimizeError::Infeasible { violation: before },
    })?;
    let violation = set.violation_near(&projected, &x0);
    if violation <= 1e-9 { Ok(projected) } else { Err(OptimizeError::Infeasible { violation }) }
}

/// Evaluates the start and sets up the state.
pub(super) fn first_evaluation<O: NonsmoothObjective>(
    objective: &O,
    config: &BundleTrustConfig,
    set: &Polyhedron,
    start: Vector,
) -> Result<(State, O::WarmStart), OptimizeError> {
    let norm = ScaledNorm::new(&config.scaling, set)?;
    let accuracy = match config.accuracy {
        AccuracyPolicy::OnDemand { coarsest, .. } => Accuracy::relative(coarsest)?,
        AccuracyPolicy::Tightest => Accuracy::TIGHTEST,
    };
    let request = Request { point: &start, warm_start: None, accuracy, descent_target: None };
    let evaluation = match evaluate(objective, &request) {
        Outcome::Answer(answer) => answer.into_evaluation(),
        Outcome::MinusInfinity => return Err(OptimizeError::Oracle(OracleError::NotFinite { what: "value" })),
        Outcome::Failure(error) => return Err(OptimizeError::Oracle(error)),
    };
    let Evaluation { value, subgradient, error_bound, warm_start } = evaluation;
    let slope = norm.dual_length(&subgradient);
    let first_step = config.first_step.unwrap_or_else(|| natural_step(norm.length(&start), value, slope));
    let weight = if slope > 0.0 { slope / first_step } else { 1.0 };
    let cut = Cut {
        id: 1,
        point: start.clone(),
        value,
        subgradient,
        error_bound,
        certified: false,
        multiplier: 0.0,
        idle: 0,
    };
    let mut state = State {
        norm,
        start: start.clone(),
        start_value: value,
        center: start,
        center_value: value,
        center_id: 1,
        bundle: Bundle::from(vec![cut]),
        next_id: 2,
        weight,
        first_weight: weight,
        first_step,
        streak: 0,
        variation: None,
        restarts: 0,
        center_accuracy: accuracy.tolerance(),
        nonconvex: false,
        noise: 0.0,
        failures: 0,
        curvature: CurvatureRecord::new(weight),
        counts: Counts { evaluations: 1, ..Counts::default() },
        history: vec![],
    };
    state.history.push(first_record(&state, set, slope));
    Ok((state, warm_start))
}

/// A first step length that follows the units of variables and values: the size of the start, or the distance at which a
/// linear Θ would vanish if the start is zero.
fn natural_step(size: f64, value: f64, slope: f64) -> f64 {
    if size > 0.0 {
        size
    } else if value != 0.0 && slope > 0.0 {
        value.abs() / slope
    } else {
        1.0
    }
}

fn first_record(state: &State, set: &Polyhedron, slope: f64) -> IterationRecord {
    IterationRecord {
        evaluation: 1,
        kind: StepKind::Start,
        value: Some(state.start_value),
        center_value: state.start_value,
        predicted_decrease: 0.0,
        aggregate_norm: slope,
        aggregate_error: 0.0,
        weight: state.weight,
        step_length: 0.0,
        violation: set.violation(&state.start),
        cuts: 1,
        convexification: 0.0,
        accuracy: state.center_accuracy,
        failure: None,
        seconds: 0.0,
    }
}
