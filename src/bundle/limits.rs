//! The limits of a run, and the ends that the caller or the values ask for.

use super::builder::BundleTrust;
use super::config::BundleTrustConfig;
use super::state::BundleState;
use crate::report::Termination;
use std::ops::ControlFlow::{self, Break, Continue};
use std::time::{Duration, Instant};

/// A decrease of Θ beyond this many times |Θ(x⁰)| + ‖g⁰‖·max(first step, 1) ends the run as unbounded below.
const UNBOUNDED_DECREASE: f64 = 1e12;

/// Ends the run once a limit of evaluations, steps or time is reached.
pub(super) fn check(state: &BundleState, method: &BundleTrust<'_>, seconds: f64) -> ControlFlow<Termination> {
    let config = &method.config;
    if state.counts.evaluations >= config.max_evaluations {
        Break(Termination::EvaluationLimit)
    } else if state.counts.iterations > config.max_iterations {
        Break(Termination::IterationLimit)
    } else if config.max_seconds.is_some_and(|limit| seconds >= limit) {
        Break(Termination::TimeLimit)
    } else {
        Continue(())
    }
}

/// When the time of a run ends; none without a limit.
pub(super) fn deadline(config: &BundleTrustConfig, start: Instant) -> Option<Instant> {
    let seconds = config.max_seconds.and_then(|limit| Duration::try_from_secs_f64(limit).ok());
    seconds.and_then(|limit| start.checked_add(limit))
}

/// Calls the observers, and tests the stopping rules and divergence.
pub(super) fn after_evaluation(state: &BundleState, method: &mut BundleTrust<'_>) -> ControlFlow<Termination> {
    let Some(record) = state.history.last() else { return Continue(()) };
    let mut stop = false;
    for observer in &mut method.observers {
        stop |= observer.observe(record).is_break();
    }
    if stop {
        return Break(Termination::StoppedByObserver);
    }
    if let Some(rule) = method.stop.as_ref().and_then(|rule| rule.holds(&state.history)) {
        return Break(Termination::StopRule { rule });
    }
    let slope = state.first_weight * state.first_step;
    // Next to zero, the first step may be a rounding, beside which every decrease is large. A length of 1 costs an
    // unbounded run some steps more and says nothing about bounded ones, whatever their units.
    let limit = UNBOUNDED_DECREASE * (state.start_value.abs() + slope * state.first_step.max(1.0));
    // An objective may fall without bound where constraints are violated.
    if state.is_feasible() && state.start_value - state.center_value > limit {
        return Break(Termination::UnboundedBelow);
    }
    Continue(())
}
