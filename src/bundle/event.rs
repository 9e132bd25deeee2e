//! Between an evaluation and its record.

use crate::report::StepKind;

/// What became of an evaluation.
#[derive(Debug)]
pub(super) struct Event {
    pub kind: StepKind,
    pub value: Option<f64>,
    pub failure: Option<String>,
    /// Whether a Jacobian was returned, or the reason why it could not be had; none if neither was reported.
    pub linearized: Option<Result<(), String>>,
    /// Work that the evaluation took.
    pub work: usize,
}
