//! How far the steps of a model are trusted: its weight, and the longest step.

/// Largest length of the step after a rejected one, in lengths of the rejected step.
const SHORTER: f64 = 0.3;

/// Weight and limit of the next step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepTrust {
    pub weight: f64,
    /// Length that the next step must not exceed, after a rejected one.
    pub longest: f64,
}

impl StepTrust {
    pub(crate) fn new(weight: f64) -> Self {
        Self { weight, longest: f64::INFINITY }
    }

    /// After a step with a weight that has been accepted; a good one lets the weight fall.
    pub(crate) fn accepted(weight: f64, good: bool) -> Self {
        Self::new(if good { weight / 10.0 } else { weight })
    }

    /// After a step with a weight and a length that has been rejected.
    pub(crate) fn rejected(weight: f64, length: f64) -> Self {
        Self { weight: 10.0 * weight, longest: SHORTER * length }
    }
}
