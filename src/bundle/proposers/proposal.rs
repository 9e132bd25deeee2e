//! A trial point, and how it is made admissible.

use crate::bundle::constrained::Tangent;
use crate::bundle::cut::LEAST_ACTIVE_MULTIPLIER;
use crate::bundle::state::BundleState;
use crate::qp::{QpError, corrected, nearest};
use crate::report::Origin;
use crate::{Polyhedron, Vector};
use std::rc::Rc;

/// Share m_S of the predicted decrease that makes a step serious (\[SchrammZowe1992\], test SS). A share of 0.1 takes 6
/// % more evaluations in the mean over moved starts.
pub(crate) const SERIOUS_FRACTION: f64 = 0.02;
/// A trial point and what the model says about it.
#[derive(Debug, Clone)]
pub(crate) struct Proposal {
    pub trial: Vector,
    /// d = trial − x̂, shortened if the solution of the subproblem left the set.
    pub step: Vector,
    /// ‖d‖ in the run's norm.
    pub step_length: f64,
    /// −v ≥ 0: the decrease that the proposer's model predicts.
    pub predicted_decrease: f64,
    /// The change that the plain cuts predict at the trial point; not formed, and 0, for points of the composite model.
    pub cut_change: f64,
    /// Gᵀw of the composite model, in place of the sum of the cuts with their multipliers.
    pub composite_aggregate: Option<Vector>,
    /// Σ slack·|multiplier| of the active rows and bounds, the other part of ẽ.
    pub slack_error: f64,
    /// ‖z̃‖* of the aggregate subgradient.
    pub aggregate_norm: f64,
    /// The aggregate error ẽ.
    pub aggregate_error: f64,
    /// The part Σ λ_i a_i of ẽ.
    pub cut_error: f64,
    pub cut_multipliers: Vec<f64>,
    /// Multipliers of the rows of U, then of the linearized constraints in σ.
    pub row_multipliers: Vector,
    /// The linearized constraints, where there are nonlinear constraints.
    pub tangents: Option<Rc<Vec<Tangent>>>,
    pub bound_multipliers: Vector,
    /// The curvature c added to make the model convex.
    pub convexification: f64,
    /// The weight u of this subproblem.
    pub weight: f64,
    /// Relative violation of the set at the trial point.
    pub violation: f64,
    /// Model that proposes the trial point.
    pub origin: Origin,
    /// Whether most of the predicted decrease is that of the violation: it says nothing about the weight.
    pub restores: bool,
    /// The violation that the step leaves by the linearizations, where its model weighs it against the objective; the
    /// predicted decrease is that of the merit then.
    pub leaves: Option<f64>,
}

/// Trial points violate the set by at most this much, relative to each side, or by as much as the center does.
pub(crate) const FEASIBILITY: f64 = 1e-12;
/// A relative violation below this is rounding that a projection removes; a larger one shortens the step.
const LARGEST_PROJECTED_VIOLATION: f64 = 1e-6;
/// A step is shortened to no less than this share.
const SHORTEST_SHARE: f64 = 1e-3;
/// A step is shortened by at most this share of itself at a time.
const LARGEST_SHORTENING: f64 = 0.3;

/// A trial point that differs from the center by less than this share of every variable cannot be told from it.
const SHORTEST_MOVE: f64 = 2.0 * f64::EPSILON;

/// Why there is no trial point.
#[derive(Debug, Clone, thiserror::Error)]
pub(crate) enum SubproblemError {
    #[error(transparent)]
    Qp(#[from] QpError),
    #[error("its solution violates the constraints by {violation:.1e} and cannot be repaired")]
    Infeasible { violation: f64 },
    #[error("the outer function is not convex: a cut lies above it by {excess:.1e}")]
    NotConvex { excess: f64 },
    #[error("the outer function is not convex: its curvature has the eigenvalue {eigenvalue:.1e}")]
    NegativeCurvature { eigenvalue: f64 },
    #[error("the subgradient of the outer function has {found} entries, expected {expected}")]
    OuterSize { expected: usize, found: usize },
    #[error("value or subgradient of the outer function is not finite")]
    OuterNotFinite { at_base: bool },
    #[error("the outer function panicked: {message}")]
    OuterPanicked { message: String },
    #[error("its solution is not finite or contradicts itself")]
    Unusable,
    #[error("it was interrupted")]
    Interrupted,
}

impl SubproblemError {
    /// Marks an error of h as one at the base of the model, where a shorter step cannot help.
    pub(crate) fn at_base(self) -> Self {
        match self {
            Self::OuterNotFinite { .. } => Self::OuterNotFinite { at_base: true },
            other => other,
        }
    }

    /// Whether the error is a fault of the outer function, which no other step cures.
    pub(crate) fn blames_outer(&self) -> bool {
        matches!(
            self,
            Self::NotConvex { .. }
                | Self::NegativeCurvature { .. }
                | Self::OuterSize { .. }
                | Self::OuterPanicked { .. }
                | Self::OuterNotFinite { at_base: true }
        )
    }
}

/// Shares of a step to be tried, longest first, where its end violates the set. The first one is shorter by twice the
/// violation, but the violation is relative to the sides of the set, and most of a step that is short beside them may
/// lie outside: each shortening is twice the last, up to three tenths.
fn shares(violation: f64) -> impl Iterator<Item = f64> {
    let (mut share, mut shortening) = (1.0, (2.0 * violation).clamp(1e-10, LARGEST_SHORTENING));
    std::iter::from_fn(move || {
        share *= 1.0 - shortening;
        shortening = if share > 0.99 { LARGEST_SHORTENING.min(2.0 * shortening) } else { LARGEST_SHORTENING };
        (share >= SHORTEST_SHARE).then_some(share)
    })
}

impl Proposal {
    /// Another step with its weight, made admissible. Multipliers and certificate quantities stay those of the plain
    /// cuts; the predicted decrease is `−change(step)` and must be positive.
    pub(crate) fn replaced(
        &self,
        set: &Polyhedron,
        state: &BundleState,
        step: Vector,
        weight: f64,
        origin: Origin,
        change: impl Fn(&Vector) -> f64,
    ) -> Result<Self, SubproblemError> {
        let trial = &state.center + &step;
        let other = Self { trial, step, weight, origin, violation: 0.0, ..self.clone() };
        let mut other = other.admissible(set, state)?;
        other.predicted_decrease = -change(&other.step);
        if other.predicted_decrease > 0.0 && other.step_length.is_finite() {
            Ok(other)
        } else {
            Err(SubproblemError::Unusable)
        }
    }

    /// The linearized constraints with a multiplier that is no rounding, and their multipliers in σ.
    pub(crate) fn active_tangents(&self) -> impl Iterator<Item = (&Tangent, f64)> {
        let tangents = self.tangents.as_deref().map_or(&[][..], Vec::as_slice);
        let first = self.row_multipliers.len() - tangents.len();
        let largest = self.row_multipliers.iter().skip(first).fold(0.0_f64, |most, m| most.max(m.abs()));
        let active = tangents.iter().zip(self.row_multipliers.iter().skip(first).copied());
        active.filter(move |(_, multiplier)| multiplier.abs() > LEAST_ACTIVE_MULTIPLIER * largest)
    }

    /// The decrease that an evaluation has to tell from none.
    pub(crate) fn least_decrease(&self) -> f64 {
        if self.origin == Origin::Confirmation {
            SERIOUS_FRACTION * self.predicted_decrease
        } else {
            self.predicted_decrease
        }
    }

    /// Whether the trial point cannot be told from the center in any variable.
    pub(crate) fn is_too_short(&self, center: &Vector) -> bool {
        self.trial.iter().zip(center.iter()).all(|(y, x)| (y - x).abs() <= SHORTEST_MOVE * x.abs())
    }

    /// A proposal with these multipliers at another trial point; it predicts no decrease.
    pub(crate) fn moved_to(
        &self,
        trial: Vector,
        set: &Polyhedron,
        state: &BundleState,
    ) -> Result<Self, SubproblemError> {
        let step = &trial - &state.center;
        Self { trial, step, violation: 0.0, ..self.clone() }.admissible(set, state)
    }

    /// Clips the trial point to the box. Where a row is still violated, projects it, or moves it back towards the
    /// center, which is admissible.
    pub(crate) fn admissible(mut self, set: &Polyhedron, state: &BundleState) -> Result<Self, SubproblemError> {
        let violation = |x: &Vector| set.violation_near(x, &state.center);
        self.trial = set.clamp_to_box(&self.trial);
        self.violation = violation(&self.trial);
        let allowed =
            if self.violation > FEASIBILITY { FEASIBILITY.max(violation(&state.center)) } else { FEASIBILITY };
        if self.violation > allowed
            && self.violation < LARGEST_PROJECTED_VIOLATION
            && let Ok(projected) = nearest(set, &self.trial)
            && violation(&projected) < self.violation
        {
            self.violation = violation(&projected);
            self.trial = projected;
        }
        if self.violation > allowed && self.violation.is_finite() {
            let corrected = corrected(set, &self.trial, &state.center);
            if violation(&corrected) <= allowed {
                (self.violation, self.trial) = (violation(&corrected), corrected);
            }
        }
        let mut shares = shares(self.violation);
        while self.violation > allowed {
            let Some(share) = shares.next() else {
                return Err(SubproblemError::Infeasible { violation: self.violation });
            };
            self.trial = set.clamp_to_box(&(&state.center + &self.step * share));
            self.violation = violation(&self.trial);
        }
        self.step = &self.trial - &state.center;
        self.step_length = state.norm.length(&self.step);
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::shares;

    /// Shortening in proportion to the violation took millions of trials where the step was short beside the sides.
    #[test]
    fn any_violation_takes_few_shares() {
        for exponent in -16..=1 {
            let all: Vec<f64> = shares(10_f64.powi(exponent)).collect();
            assert!((10..60).contains(&all.len()), "1e{exponent}: {}", all.len());
            assert!(all[0] < 1.0 && all.windows(2).all(|pair| pair[1] < pair[0]), "1e{exponent}: {all:?}");
            assert!(all.windows(2).all(|pair| pair[1] > 0.69 * pair[0]), "1e{exponent}: {all:?}");
        }
    }
}
