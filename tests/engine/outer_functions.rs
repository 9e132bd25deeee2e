//! Outer functions: subgradient inequality, curvature by differences, outputs that are no numbers.

use nonsmooth::composite::{EuclideanNorm, GroupNorms, Maximum, OuterFunction, PositiveParts, SumOfPowers};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{Matrix, Vector};

#[test]
fn curvature_is_the_derivative_of_the_subgradient() {
    let jacobian = Matrix::from_fn(5, 3, |i, j| ((3 * i + j) as f64).sin());
    let (c, d) = (seeded_direction(5, 1), seeded_direction(3, 2));
    let h = SumOfPowers { exponent: 4.0 };
    let step = 1e-6;
    let at = |t: f64| jacobian.tr_mul(&h.subgradient(&(&c + &jacobian * &d * t)));
    let quotient = (at(step) - at(-step)) / (2.0 * step);
    let product = h.curvature(&c, &jacobian).expect("smooth") * &d;
    assert!((quotient - &product).norm() < 1e-8 * product.norm());
}

#[test]
fn functions_of_outputs_that_are_no_numbers_are_no_numbers() {
    let functions: [&dyn OuterFunction; 3] = [&Maximum, &SumOfPowers { exponent: 1.0 }, &EuclideanNorm];
    for outputs in [[f64::NAN; 2], [f64::NAN, 1.0], [1.0, f64::NAN]] {
        assert!(functions.iter().all(|h| h.value(&Vector::from_row_slice(&outputs)).is_nan()), "{outputs:?}");
    }
}

#[test]
fn subgradients_lie_below_the_function() {
    let groups = GroupNorms { sizes: vec![1, 3, 2] };
    let (sum, cubes) = (SumOfPowers { exponent: 1.0 }, SumOfPowers { exponent: 3.0 });
    let functions: [&dyn OuterFunction; 6] = [&Maximum, &sum, &cubes, &EuclideanNorm, &PositiveParts, &groups];
    for h in functions {
        for seed in 0..50 {
            let (a, b) = (seeded_direction(6, seed), seeded_direction(6, seed + 1000));
            let cut = h.value(&a) + h.subgradient(&a).dot(&(&b - &a));
            assert!(cut <= h.value(&b) + 1e-14);
        }
    }
}
