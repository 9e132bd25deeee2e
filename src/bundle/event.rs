//! Between an evaluation and its record.

use crate::report::{Noted, StepKind};

/// What became of an evaluation.
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
