//! Accuracy asked of an oracle.

use crate::InputError;

/// Relative accuracy τ asked of a value or a state: |value − Θ| ≤ τ·|Θ| for an objective, and the corresponding
/// relative tolerance of the inner solver for a state. Dimensionless, 0 ≤ τ < 1; 0 means "as accurate as you can".
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, serde::Serialize, serde::Deserialize)]
pub struct Accuracy(f64);

impl Accuracy {
    /// As accurate as the oracle can.
    pub const TIGHTEST: Self = Self(0.0);

    /// Relative accuracy τ.
    ///
    /// # Errors
    /// [`InputError::OutOfRange`] unless 0 ≤ τ < 1.
    pub fn relative(tolerance: f64) -> Result<Self, InputError> {
        if (0.0..1.0).contains(&tolerance) {
            Ok(Self(tolerance))
        } else {
            Err(InputError::OutOfRange { setting: "accuracy", value: tolerance.to_string(), allowed: "0 ≤ τ < 1" })
        }
    }

    /// The relative tolerance τ.
    pub fn tolerance(self) -> f64 {
        self.0
    }
}
