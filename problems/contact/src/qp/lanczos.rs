//! Largest eigenvalue by a few Lanczos steps.

use crate::linear::sums::Whole;
use crate::linear::vector::{dot, norm};
use crate::qp::{QpError, SymmetricOperator};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// A lower estimate of the largest eigenvalue after at most `steps` products; a start vector with all frequencies makes
/// five to ten steps enough for a few per cent.
///
/// # Errors
/// [`QpError::NotFinite`] when the operator returns a number that is not finite.
pub fn largest_eigenvalue(operator: &dyn SymmetricOperator, steps: usize) -> Result<f64, QpError> {
    let dimension = operator.dimension();
    let start: Vec<f64> = (0..dimension).map(|index| (index as f64 * 12.9898).sin() + 0.01).collect();
    let length = norm(&start);
    if length == 0.0 {
        return Ok(0.0);
    }
    let mut basis = vec![start.iter().map(|entry| entry / length).collect::<Vec<f64>>()];
    let (mut diagonal, mut off_diagonal) = (Vec::new(), Vec::new());
    for _step in 0..steps.min(dimension) {
        let current = &basis[basis.len() - 1];
        let mut image = vec![0.0; dimension];
        operator.apply(current, &mut image);
        diagonal.push(dot(current, &image));
        Whole::orthogonalise(&mut image, &basis);
        let length = norm(&image);
        if !length.is_finite() {
            return Err(QpError::NotFinite { what: "product with the quadratic form" });
        }
        let scale = diagonal.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        if length <= 1e-12 * scale || length == 0.0 {
            break;
        }
        off_diagonal.push(length);
        image.iter_mut().for_each(|entry| *entry /= length);
        basis.push(image);
    }
    let mut tridiagonal = DMatrix::from_diagonal(&DVector::from_vec(diagonal));
    for (index, entry) in off_diagonal.iter().enumerate().take(tridiagonal.nrows() - 1) {
        tridiagonal[(index, index + 1)] = *entry;
        tridiagonal[(index + 1, index)] = *entry;
    }
    Ok(SymmetricEigen::new(tridiagonal).eigenvalues.max())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_number_of_steps_is_exact() {
        let h = DMatrix::from_row_slice(3, 3, &[2.0, -1.0, 0.0, -1.0, 2.0, -1.0, 0.0, -1.0, 2.0]);
        let value = largest_eigenvalue(&h, 3).expect("finite");
        assert!((value - (2.0 + 2.0_f64.sqrt())).abs() < 1e-14);
    }

    #[test]
    fn nan_is_reported() {
        assert!(matches!(
            largest_eigenvalue(&DMatrix::from_element(1, 1, f64::NAN), 3),
            Err(QpError::NotFinite { .. })
        ));
    }
}
