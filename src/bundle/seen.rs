//! What a run has seen of Θ, variable by variable.

use crate::Vector;

/// Values and slopes of all evaluations of a run.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    /// The highest value, in units of Θ.
    pub highest: f64,
    /// The largest |g_i| of every variable.
    pub steepest: Vector,
}

impl Seen {
    pub(crate) fn new(value: f64, subgradient: &Vector) -> Self {
        Self { highest: value, steepest: subgradient.abs() }
    }

    /// Takes in an evaluation.
    pub(crate) fn add(&mut self, value: f64, subgradient: &Vector) {
        self.highest = self.highest.max(value);
        self.steepest.zip_apply(subgradient, |steepest, slope| *steepest = steepest.max(slope.abs()));
    }
}
