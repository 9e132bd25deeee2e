//! What is asked about a state beyond its certificates: contraction, condition.
//!
//! ```text
//! Φ: Ψ ↦ 𝓕 λ_N(Ψ), λ_N(Ψ) from the Tresca problem with slip bounds Ψ;    contraction = spectral radius of Φ′ at the state
//! ```
//! Below 1 the successive approximations converge near the state and the state is isolated; an eigenvalue 1 of Φ′ is
//! where Newton's matrix is singular. At 1 and above, contraction proves nothing about uniqueness: others may exist.

use nalgebra::{DMatrix, linalg::Schur};
use serde::{Deserialize, Serialize};
use std::fmt;

/// What a diagnosis found; dimensionless.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// Estimated spectral radius of Φ′; 0 without sliding nodes or friction.
    pub contraction: f64,
    /// Spectral condition number of Newton's matrix on the contact displacements; none where it is not assembled.
    pub condition: Option<f64>,
}

impl Diagnosis {
    /// Whether the contraction argument gives local uniqueness.
    pub fn contracts(&self) -> bool {
        self.contraction < 1.0
    }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.contracts() {
            "successive approximations converge nearby, the state is isolated"
        } else {
            "successive approximations do not converge here, other equilibria may exist"
        };
        write!(f, "contraction {:.3} ({verdict})", self.contraction)?;
        match self.condition {
            Some(condition) => write!(f, ", condition {condition:.1e}"),
            None => Ok(()),
        }
    }
}

/// Sweeps of the eigenvalue iteration allowed per unknown.
const MAX_SWEEPS: usize = 100;

/// Spectral radius of a small dense matrix, row major; NaN if its eigenvalues are not found.
pub fn spectral_radius(size: usize, entries: &[f64]) -> f64 {
    if size == 0 {
        return 0.0;
    }
    let matrix = DMatrix::from_row_slice(size, size, entries);
    if entries.iter().any(|entry| !entry.is_finite()) {
        return f64::NAN;
    }
    match Schur::try_new(matrix, f64::EPSILON, MAX_SWEEPS * size) {
        Some(schur) => schur.complex_eigenvalues().iter().map(|value| value.re.hypot(value.im)).fold(0.0, f64::max),
        None => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radius_of_a_rotation_and_of_a_defective_matrix() {
        assert!((spectral_radius(2, &[0.0, -2.0, 2.0, 0.0]) - 2.0).abs() < 1e-14);
        assert!((spectral_radius(2, &[0.5, 100.0, 0.0, 0.5]) - 0.5).abs() < 1e-6);
        assert_eq!(spectral_radius(0, &[]), 0.0);
        assert!(spectral_radius(1, &[f64::NAN]).is_nan());
    }
}
