//! Vector and matrix types of the public interface.

/// Dense column vector of `f64`: controls, subgradients, multipliers.
pub type Vector = nalgebra::DVector<f64>;

/// Dense column-major matrix of `f64`: constraint rows, metrics.
pub type Matrix = nalgebra::DMatrix<f64>;

/// The median of some numbers, of an even count the upper one; none of no numbers. The numbers change places.
pub(crate) fn upper_median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Index of the first entry that is not finite, if there is one.
pub(crate) fn first_non_finite(values: &[f64]) -> Option<usize> {
    values.iter().position(|value| !value.is_finite())
}
