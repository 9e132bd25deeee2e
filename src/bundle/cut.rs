//! Cuts: what one evaluation leaves behind.
//!
//! ```text
//! e_i = Θ(x̂) − Θ(y_i) − ⟨g_i, x̂ − y_i⟩        linearization error at the center x̂
//! ```

use super::norm::ScaledNorm;
use crate::qp::kernels::difference_dot;
use crate::{Vector, plain};
use serde::{Deserialize, Serialize};

/// A cut is active if its multiplier exceeds this, where Σ λ = 1: stopping test, noise, scales and certificate count
/// active cuts only. A smaller multiplier is rounding of the subproblem: the cut is idle, and the longest idle cut
/// leaves the bundle first.
pub(crate) const LEAST_ACTIVE_MULTIPLIER: f64 = 1e-9;

/// A subgradient this many times longer than all before cannot be held beside them in double precision.
pub(crate) const MAX_RELATIVE_SLOPE: f64 = 1e15;

/// How far a cut lies below Θ(x̂) at x̂, as model and certificate count it: the linearization error e, what
/// convexification adds, and the errors that the oracle promised. A cut above a convex Θ by no more than those is
/// lowered; one that is farther above shows noise, and counts as far below.
pub(crate) fn offset(error: f64, convexified: f64, promised: f64, convex: bool) -> f64 {
    if convex { (error + promised).abs() } else { (error + convexified).max(error.abs()) + promised }
}

/// One evaluation kept in the bundle, or several merged into one cut.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Cut {
    /// Number of the cut in the order in which cuts were made; unique in a run.
    pub id: u64,
    /// Where Θ was evaluated, y; of merged cuts, the point of the one with the larger multiplier.
    #[serde(with = "plain::vector")]
    pub point: Vector,
    /// Largest distance from `point` of a point that the cut stems from; 0 for a cut that is not merged.
    #[serde(default)]
    pub radius: f64,
    /// Θ(y), or a lower bound of it.
    pub value: f64,
    /// One subgradient of Θ at y.
    #[serde(with = "plain::vector")]
    pub subgradient: Vector,
    /// Bound or estimate of the error of `value` that the oracle promised, in units of Θ.
    pub error_bound: f64,
    /// Whether the oracle certified the cut to lie below Θ (an answer [`NoDescent`](crate::Answer::NoDescent)), or the
    /// cut is merged: it holds, but its value bounds Θ(y) from below only.
    pub certified: bool,
    /// Multiplier λ ≥ 0 in the last subproblem; Σ λ = 1 over all cuts.
    pub multiplier: f64,
    /// Subproblems in a row in which the cut was not active.
    pub idle: usize,
}

impl Cut {
    /// Whether the multiplier is more than rounding of the subproblem: above 1e-9.
    pub(crate) fn is_active(&self) -> bool {
        self.multiplier > LEAST_ACTIVE_MULTIPLIER
    }

    /// How far the points behind the cut lie from a point at most.
    pub(crate) fn farthest_from(&self, x: &Vector, norm: &ScaledNorm) -> f64 {
        norm.squared_distance(x, &self.point).sqrt() + self.radius
    }

    /// The mean of two cuts, weighted by their multipliers. The last subproblem has the same answer with it as with
    /// both.
    pub(super) fn merged(&self, lighter: &Self, id: u64, norm: &ScaledNorm) -> Self {
        let multiplier = self.multiplier + lighter.multiplier;
        let share = lighter.multiplier / multiplier;
        let distance = norm.squared_distance(&self.point, &lighter.point).sqrt();
        let here = |cut: &Self| {
            let slope = cut.subgradient.as_slice();
            cut.value - cut.excess() + difference_dot(slope, self.point.as_slice(), cut.point.as_slice())
        };
        Self {
            id,
            point: self.point.clone(),
            radius: self.radius.max(distance + lighter.radius),
            value: (1.0 - share) * here(self) + share * here(lighter),
            subgradient: &self.subgradient * (1.0 - share) + &lighter.subgradient * share,
            error_bound: 0.0,
            certified: true,
            multiplier,
            idle: 0,
        }
    }

    /// What rounding can hide of the linearization error at a point: that of the value and of the terms of ⟨g, x − y⟩.
    pub(crate) fn rounding_at(&self, x: &Vector) -> f64 {
        let slope = self.subgradient.iter().zip(self.point.iter().zip(x.iter()));
        let terms: f64 = slope.map(|(g, (y, x))| g.abs() * (y.abs() + x.abs())).sum();
        8.0 * f64::EPSILON * self.value.abs().max(terms)
    }

    /// An upper bound of Θ at the point of an accurate cut.
    pub(super) fn highest_value(&self) -> f64 {
        self.value + self.error_bound
    }

    /// How far the cut may lie above a convex Θ: the promised error of its value, 0 if it is certified.
    pub fn excess(&self) -> f64 {
        if self.certified { 0.0 } else { self.error_bound }
    }

    /// e = value − Θ(y) − ⟨g, x − y⟩: the linearization error at a point x where Θ has the value given.
    pub(crate) fn linearization_error(&self, x: &Vector, value: f64) -> f64 {
        value - self.value - difference_dot(self.subgradient.as_slice(), x.as_slice(), self.point.as_slice())
    }
}
