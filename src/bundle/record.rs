//! The record of an evaluation.

use super::proposers::proposal::Proposal;
use super::state::BundleState;
use crate::Accuracy;
use crate::report::{IterationRecord, Noted, Origin, StepKind};
use std::time::Instant;

/// The outcome of an evaluation.
#[derive(Debug)]
pub(super) struct Event {
    pub kind: StepKind,
    pub value: Option<f64>,
    pub failure: Option<String>,
    /// Whether there was a Jacobian.
    pub noted: Noted,
    /// Work that the evaluation took.
    pub work: usize,
}

/// Counts an evaluation and adds its record to the history.
pub(super) fn record(state: &mut BundleState, proposal: &Proposal, accuracy: Accuracy, event: Event, clock: Instant) {
    let Event { kind, value, failure, noted, work } = event;
    let origin = if kind == StepKind::Refinement { Origin::Given } else { proposal.origin };
    state.counts.add(kind, origin);
    let mut record = IterationRecord {
        evaluation: state.counts.evaluations,
        kind,
        origin,
        value,
        center_value: state.center_value,
        predicted_decrease: proposal.predicted_decrease,
        aggregate_norm: proposal.aggregate_norm,
        aggregate_error: proposal.aggregate_error,
        weight: proposal.weight,
        step_length: proposal.step_length,
        violation: proposal.violation,
        cuts: state.bundle.cuts().len(),
        convexification: proposal.convexification,
        accuracy: accuracy.tolerance(),
        failure,
        jacobian: false,
        note: None,
        work,
        seconds: clock.elapsed().as_secs_f64(),
    };
    record.note(noted);
    state.history.push(record);
}
