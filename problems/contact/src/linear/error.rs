//! Why a matrix was not factored.

use thiserror::Error;

/// A factorisation that failed: its matrix was not positive definite, or a check of its result did not hold.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{what}: {reason}")]
pub struct FactorizationError {
    /// The step of the algorithm that failed.
    pub what: &'static str,
    /// What was found, and what is allowed.
    pub reason: String,
}
