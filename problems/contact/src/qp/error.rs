//! Why a quadratic program was not solved.

use thiserror::Error;

/// Failure of a quadratic programming solver.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum QpError {
    /// Two parts of the data do not fit together.
    #[error("{what} has {found} entries, {expected} expected")]
    Dimension {
        /// Which part.
        what: &'static str,
        /// Size it must have.
        expected: usize,
        /// Size it has.
        found: usize,
    },
    /// A part of the set is no convex set, or parts overlap.
    #[error("block {block} of the separable set: {reason}")]
    Set {
        /// Position in the list of blocks.
        block: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A number that a method is given is outside its range.
    #[error("{name} = {value} is not allowed; allowed: {allowed}")]
    Setting {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The objective has negative curvature, or falls for ever along a direction without curvature.
    #[error("the quadratic form is not positive along a descent direction: dᵀHd/dᵀd = {curvature:.3e}, allowed: > 0")]
    Curvature {
        /// dᵀHd/dᵀd.
        curvature: f64,
    },
    /// A number is not finite.
    #[error("{what} is not finite")]
    NotFinite {
        /// Which quantity.
        what: &'static str,
    },
    /// The step limit was reached.
    #[error("{solver} stopped at residual {residual:.3e} after {steps} steps")]
    NotConverged {
        /// Name of the iteration.
        solver: &'static str,
        /// Last relative residual.
        residual: f64,
        /// Steps spent.
        steps: usize,
        /// Relative residuals on the way.
        history: Vec<f64>,
    },
}
