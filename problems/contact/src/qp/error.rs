//! Why a quadratic program was not solved.

use thiserror::Error;

/// Failure of a quadratic programming solver.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum QpError {
    /// Two parts of the data do not fit together.
    #[error("{what} has {found} entries, {expected} expected")]
    Dimension {
        /// The part of the program whose size is wrong.
        what: &'static str,
        /// Size it must have.
        expected: usize,
        /// The size of that part.
        found: usize,
    },
    /// A part of the set is no convex set, or parts overlap.
    #[error("block {block} of the separable set: {reason}")]
    Set {
        /// Position in the list of blocks.
        block: usize,
        /// What is wrong with the block.
        reason: &'static str,
    },
    /// A number that a method is given is outside its range.
    #[error("{name} = {value} is not allowed; allowed: {allowed}")]
    Setting {
        /// Name of the parameter.
        name: &'static str,
        /// The value as it was given.
        value: f64,
        /// The values that are allowed.
        allowed: &'static str,
    },
    /// The objective has negative curvature, or falls for ever along a direction without curvature.
    #[error("the quadratic form is not positive along a descent direction: dᵀHd/dᵀd = {curvature:.3e}, allowed: > 0")]
    Curvature {
        /// The curvature dᵀHd/dᵀd.
        curvature: f64,
    },
    /// A number is not finite.
    #[error("{what} is not finite")]
    NotFinite {
        /// The quantity that is not finite.
        what: &'static str,
    },
    /// The step limit was reached.
    #[error("{solver} stopped at residual {residual:.3e} after {steps} steps")]
    NotConverged {
        /// Name of the iteration.
        solver: &'static str,
        /// The relative residual at the end.
        residual: f64,
        /// The number of steps spent.
        steps: usize,
        /// Relative residuals on the way.
        history: Vec<f64>,
    },
}
