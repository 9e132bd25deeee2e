//! Generalised conjugate residuals for many right sides in lockstep: every column has its own Krylov space, and every
//! product is taken for all columns at once.
//!
//! ```text
//! per column:   z_k = M r,   q_k = A z_k made orthogonal to q_0 … q_{k−1},   α_k = q_kᵀr/q_kᵀq_k,   r ← r − α_k q_k
//! x = Σ_k x_k z_k,   R x = α,   A z_k = Σ_i R_ik q_i   (R_kk = 1)
//! ```

use crate::linear::columns::{add_combination, norms, products};
use crate::linear::entry::Row;
use crate::linear::gmres::MAX_STALLED_ITERATIONS;
use crate::linear::real::Real;
use crate::linear::sums::Sums;
use nonsmooth::interruption::interrupted;

/// Directions, payloads and their coefficients: X = Σ coefficients∘directions.
pub struct ColumnCombination<E, P, const N: usize> {
    /// The preconditioned residuals z_k.
    pub directions: Vec<Vec<Row<E, N>>>,
    /// What the operator attached to A z_k.
    pub payloads: Vec<P>,
    /// One coefficient per column for every direction.
    pub coefficients: Vec<Row<f64, N>>,
    /// Norms of the residuals by the recurrence.
    pub residuals: Row<f64, N>,
}

/// What a block of columns is mapped to.
type Map<'a, E, R, const N: usize> = &'a dyn Fn(&[Row<E, N>]) -> R;

/// Whether all columns have reached their targets.
fn reached<const N: usize>(residuals: &Row<f64, N>, targets: &Row<f64, N>) -> bool {
    residuals.iter().zip(targets.iter()).all(|(residual, target)| residual <= target)
}

/// Minimises |r − A x| per column over growing Krylov spaces until every norm is at most its target, `max_iterations`
/// is reached, or the largest ratio of a norm to its target does not halve in 40 iterations; the caller checks the
/// residuals.
///
/// `sums`: inner products; `precondition(r)` returns M r; `apply(z)` returns (A z, payload).
pub fn gcr<E: Real, P, const N: usize>(
    sums: &dyn Sums,
    mut residual: Vec<Row<E, N>>,
    targets: &Row<f64, N>,
    max_iterations: usize,
    precondition: Map<'_, E, Vec<Row<E, N>>, N>,
    apply: Map<'_, E, (Vec<Row<E, N>>, P), N>,
) -> ColumnCombination<E, P, N> {
    let residuals = norms(sums, &residual);
    let mut result =
        ColumnCombination { directions: Vec::new(), payloads: Vec::new(), coefficients: Vec::new(), residuals };
    let (mut images, mut squares) = (Vec::<Vec<Row<E, N>>>::new(), Vec::<Row<f64, N>>::new());
    let (mut triangle, mut history) = (Vec::new(), vec![largest_share(&result.residuals, targets)]);
    while !reached(&result.residuals, targets) && result.directions.len() < max_iterations && !interrupted() {
        let direction = precondition(&residual);
        let (mut image, payload) = apply(&direction);
        let earlier: Vec<&[Row<E, N>]> = images.iter().map(Vec::as_slice).collect();
        let column: Vec<Row<f64, N>> = products(sums, &earlier, &image)
            .iter()
            .zip(&squares)
            .map(|(product, square)| ratio(product, square))
            .collect();
        let terms: Vec<_> = column.iter().map(|entry| entry.map(|entry| -entry)).zip(earlier).collect();
        add_combination(&mut image, &terms);
        let [square, along] = [&image, &residual].map(|other| products(sums, &[&image], other).swap_remove(0));
        let coefficient = ratio(&along, &square);
        add_combination(&mut residual, &[(coefficient.map(|entry| -entry), image.as_slice())]);
        result.residuals = norms(sums, &residual);
        result.directions.push(direction);
        result.payloads.push(payload);
        result.coefficients.push(coefficient);
        triangle.push(column);
        images.push(image);
        squares.push(square);
        history.push(largest_share(&result.residuals, targets));
        let last = history.len() - 1;
        let stalled = last >= MAX_STALLED_ITERATIONS && history[last] > 0.5 * history[last - MAX_STALLED_ITERATIONS];
        if history[last].is_nan() || stalled {
            break;
        }
    }
    for k in (1..triangle.len()).rev() {
        let (before, rest) = result.coefficients.split_at_mut(k);
        for (coefficient, entry) in before.iter_mut().zip(&triangle[k]) {
            *coefficient = coefficient.zip(&entry.zip(&rest[0], |r, x| r * x), |alpha, product| alpha - product);
        }
    }
    result
}

/// a/b per column; 0 where b is: a column without a residual gets no direction.
fn ratio<const N: usize>(a: &Row<f64, N>, b: &Row<f64, N>) -> Row<f64, N> {
    a.zip(b, |a, b| if b == 0.0 { 0.0 } else { a / b })
}

/// The largest norm over its target among the columns that have not reached theirs; NaN if a norm is.
fn largest_share<const N: usize>(norms: &Row<f64, N>, targets: &Row<f64, N>) -> f64 {
    let shares = norms.iter().zip(targets.iter());
    shares.fold(0.0, |largest: f64, (norm, target)| {
        let share = if norm <= target { 0.0 } else { norm / target };
        if share.is_nan() || share > largest { share } else { largest }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::entry::Entry;
    use crate::linear::sums::Whole;

    #[test]
    fn every_column_is_solved_in_at_most_n_steps() {
        let a = [[4.0, 1.0, 0.0], [-1.0, 3.0, 2.0], [0.5, 0.0, 2.0]];
        let apply = |x: &[Row<f64, 1>]| -> Vec<Row<f64, 1>> {
            let product = |row: &[f64; 3]| {
                let mut sum = Row::ZERO;
                row.iter().zip(x).for_each(|(&a, x)| sum.add_scaled(a, x));
                sum
            };
            a.iter().map(product).collect()
        };
        // All columns but the first and the third are zero and have nothing to do.
        let mut expected = [Row::<f64, 1>::ZERO; 3];
        for (column, values) in [[1.0, -2.0, 3.0], [0.0, 0.0, 0.0], [0.0, 1.0, 5.0]].into_iter().enumerate() {
            (0..3).for_each(|row| expected[row].set(column, values[row]));
        }
        let targets = Row::ZERO.map(|_: f64| 1e-12);
        let krylov = gcr(&Whole, apply(&expected), &targets, 10, &|r| r.to_vec(), &|z| (apply(z), ()));
        assert_eq!(krylov.directions.len(), 3);
        assert!(reached(&krylov.residuals, &targets));
        let mut found = vec![Row::<f64, 1>::ZERO; 3];
        let terms: Vec<_> =
            krylov.coefficients.iter().copied().zip(krylov.directions.iter().map(Vec::as_slice)).collect();
        add_combination(&mut found, &terms);
        for (found, expected) in found.iter().zip(&expected) {
            assert!(found.iter().zip(expected.iter()).all(|(a, b)| (a - b).abs() < 1e-11), "{found:?}");
        }
    }
}
