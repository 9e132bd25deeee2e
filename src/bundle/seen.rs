//! What a run has seen of Θ, variable by variable.

use crate::Vector;

/// Values and slopes of all evaluations of a run.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    /// The highest value, in units of Θ.
    pub highest: f64,
    /// The largest |g_i| of every variable.
    pub steepest: Vector,
    /// The least and the largest value of every variable at the points that count.
    pub range: (Vector, Vector),
}

impl Seen {
    pub(crate) fn new(point: &Vector, value: f64, subgradient: &Vector) -> Self {
        Self { highest: value, steepest: subgradient.abs(), range: (point.clone(), point.clone()) }
    }

    /// Takes in an evaluation. `counts`: whether the point may lie as far as a minimizer; points above the start say
    /// nothing about where a convex Θ is lower.
    pub(crate) fn add(&mut self, point: &Vector, value: f64, subgradient: &Vector, counts: bool) {
        self.highest = self.highest.max(value);
        if counts {
            self.range = (self.range.0.inf(point), self.range.1.sup(point));
        }
        self.steepest.zip_apply(subgradient, |steepest, slope| *steepest = steepest.max(slope.abs()));
    }

    /// How far a variable has gone from a value.
    pub(crate) fn farthest(&self, i: usize, from: f64) -> f64 {
        (from - self.range.0[i]).max(self.range.1[i] - from)
    }
}
