//! Settings of the bundle-trust method: meaning, default, admissible range, effect.

use super::coordinates::Coordinates;
use crate::checks::check_setting;
use crate::{InputError, Matrix, Vector};
use serde::{Deserialize, Serialize};

/// The declared convexity of the problem: of Θ on the admissible set, and of its nonlinear constraints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Convexity {
    /// Nothing. The model stays the plain cutting-plane model until a pair of cuts proves Θ nonconvex.
    #[default]
    Unknown,
    /// Θ is convex, and so is every nonlinear inequality. The cuts bound how far Θ can still fall within reach of the
    /// variables, this bound decides the end, and no restart is made. Linearization errors below zero by more than
    /// promised errors and rounding are noise of the oracle. Nonlinear equalities, and inequalities that their
    /// linearizations prove nonconvex, leave no bound: the end is then decided as for unknown convexity. A false
    /// declaration may give a false confirmation.
    Convex,
}

/// The units in which distances are measured: ‖d‖² = Σ (dᵢ/Dᵢ)² or |M⁻¹ d|².
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum VariableScaling {
    /// If the box is finite in every variable, Dᵢ is its width, counted up to 1000 times the median width, divided by
    /// the geometric mean of the widths; fixed variables have Dᵢ = 1. Otherwise all Dᵢ = 1.
    #[default]
    FromBox,
    /// Dᵢ = 1.
    Unit,
    /// Given typical sizes Dᵢ > 0 of the variables.
    Typical(Vector),
    /// ‖d‖ = |M⁻¹ d| for a regular n × n matrix M. The run takes the course that it would take in the coordinates β of
    /// x = M β: a direction in which Θ hardly changes is made short if M stretches it, and the first subproblems
    /// already reach along it. Points, cuts, bounds, history and certificate stay in x.
    Linear(Matrix),
}

/// Which accuracy the engine asks of the oracle.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum AccuracyPolicy {
    /// Always as accurate as the oracle can.
    #[default]
    Tightest,
    /// τ = clip(factor · predicted decrease / |Θ(x̂)|, tightest, coarsest). The center is evaluated again when its
    /// promised error exceeds factor · predicted decrease.
    OnDemand {
        /// Tightest accuracy ever asked, 0 ≤ tightest ≤ coarsest.
        tightest: f64,
        /// Coarsest accuracy ever asked, < 1.
        coarsest: f64,
        /// Share of the predicted decrease that the error may have, in (0, 1).
        factor: f64,
    },
}

impl AccuracyPolicy {
    /// Accuracy on demand (docs/bundle.md, rule 4): between 1e-12 and 1e-2, a tenth of the predicted
    /// decrease.
    pub const ON_DEMAND: Self = Self::OnDemand { tightest: 1e-12, coarsest: 1e-2, factor: 0.1 };
}

/// Sizes of the bundle that the method can work with, and why.
const BUNDLE_SIZES: &str = "≥ 3: the best point's cut, the newest one, and one for all others together";

/// Settings of [`BundleTrust`](crate::BundleTrust). The defaults are one setting for all problems.
///
/// ```
/// use nonsmooth::BundleTrustConfig;
/// let config = BundleTrustConfig { max_evaluations: 200, ..Default::default() };
/// assert!(config.validate().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BundleTrustConfig {
    /// Predicted decrease, relative to the size of Θ, that counts as small. Default 1e-7; in (0, 1). Larger stops
    /// earlier; the relative error of the value reached is usually ten times smaller than the tolerance.
    pub tolerance: f64,
    /// The size of Θ that `tolerance` refers to, in units of Θ. Default none: |Θ| at the center, at most what values
    /// and linearizations vary near it. Positive. Larger stops earlier.
    pub objective_scale: Option<f64>,
    /// Largest number of evaluations, failed ones included. Default 2000; ≥ 1.
    pub max_evaluations: usize,
    /// Largest number of steps, each with at most one evaluation. Default 100 000; ≥ 1.
    pub max_iterations: usize,
    /// Largest time in seconds. Default none. Positive.
    pub max_seconds: Option<f64>,
    /// Length of the first step in scaled variables. Default none: the length of the start vector, but at least 1e-6 of
    /// the distance |Θ|/‖g‖* at which a linear Θ would vanish; this distance where the start is zero, and 1 where both
    /// vanish. Positive. A typical change of the variables is the best value; too small or too large costs some
    /// evaluations.
    pub first_step: Option<f64>,
    /// What is known about convexity. Default unknown.
    pub convexity: Convexity,
    /// Units of the variables. Default from the box.
    pub scaling: VariableScaling,
    /// Accuracy asked of the oracle. Default always the tightest; an oracle that ignores the request is not affected.
    pub accuracy: AccuracyPolicy,
    /// Largest number of cuts. Default none: n + 15, at most 500. ≥ 3: the cut of the center, the newest one, and one
    /// for all others together. A large bundle remembers cuts that mislead a nonconvex run; a small one merges active
    /// cuts, and needs more evaluations.
    pub bundle_size: Option<usize>,
    /// Whether an end whose active cuts lie away from the best point is confirmed by evaluations next to it, at most
    /// one more than there are variables. Default true; of no effect where Θ is declared convex. Where false, such a
    /// run ends as unconfirmed.
    pub confirm: bool,
    /// The composite model, for objectives that have an outer function and return Jacobians. Default on.
    pub composite_model: bool,
}

impl Default for BundleTrustConfig {
    fn default() -> Self {
        Self {
            tolerance: 1e-7,
            objective_scale: None,
            max_evaluations: 2000,
            max_iterations: 100_000,
            max_seconds: None,
            first_step: None,
            convexity: Convexity::Unknown,
            scaling: VariableScaling::FromBox,
            accuracy: AccuracyPolicy::Tightest,
            bundle_size: None,
            confirm: true,
            composite_model: true,
        }
    }
}

impl BundleTrustConfig {
    /// Checks every field against its range.
    ///
    /// # Errors
    /// [`InputError::OutOfRange`] naming the first field that is not admissible; [`InputError::Dimension`] or
    /// [`InputError::NotFinite`] for a matrix of [`VariableScaling::Linear`] that is not square or not finite.
    pub fn validate(&self) -> Result<(), InputError> {
        let positive = |setting, value: Option<f64>| {
            value.map_or(Ok(()), |value| check_setting(setting, value, "> 0", value > 0.0 && value.is_finite()))
        };
        check_setting("tolerance", self.tolerance, "0 < x < 1", self.tolerance > 0.0 && self.tolerance < 1.0)?;
        positive("objective_scale", self.objective_scale)?;
        check_setting("max_evaluations", self.max_evaluations, "≥ 1", self.max_evaluations >= 1)?;
        check_setting("max_iterations", self.max_iterations, "≥ 1", self.max_iterations >= 1)?;
        positive("max_seconds", self.max_seconds)?;
        positive("first_step", self.first_step)?;
        self.bundle_size.map_or(Ok(()), |size| check_setting("bundle_size", size, BUNDLE_SIZES, size >= 3))?;
        self.validate_policies()
    }

    fn validate_policies(&self) -> Result<(), InputError> {
        if let AccuracyPolicy::OnDemand { tightest, coarsest, factor } = self.accuracy {
            let ordered = tightest >= 0.0 && tightest <= coarsest && coarsest < 1.0;
            check_setting("accuracy.coarsest", coarsest, "0 ≤ tightest ≤ coarsest < 1", ordered)?;
            check_setting("accuracy.factor", factor, "0 < x < 1", factor > 0.0 && factor < 1.0)?;
        }
        if let VariableScaling::Typical(sizes) = &self.scaling {
            let valid = sizes.iter().all(|size| *size > 0.0 && size.is_finite());
            check_setting("scaling.typical", sizes.as_slice(), "> 0, finite", valid)?;
        }
        if let VariableScaling::Linear(matrix) = &self.scaling {
            Coordinates::try_from(matrix.clone())?;
        }
        Ok(())
    }
}
