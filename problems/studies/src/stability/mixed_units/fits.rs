//! Fits of random data, and maxima of random affine functions: the minimiser is where the data put it.

use crate::stability::mixed_units::function::{Function, Outer, Quadratic};
use crate::stability::mixed_units::problem::Problem;
use nonsmooth::{Matrix, Vector};
use testset::kit::Random;

/// Names of the families.
pub const FITS: [&str; 5] =
    ["L1 fit", "Chebyshev fit", "sum of norms", "max of affine functions", "max of affine functions plus quadratic"];

/// Number of variables: 10 in every eighth problem, otherwise 2 to 6.
pub fn dimension(random: &mut Random, number: usize) -> usize {
    if number % 8 == 7 { 10 } else { 2 + random.below(5) }
}

/// Entries in [−size, size).
pub fn entries(random: &mut Random, count: usize, size: f64) -> Vector {
    Vector::from_fn(count, |_, _| size * random.signed())
}

/// A matrix with entries in [−1, 1).
pub fn matrix(random: &mut Random, rows: usize, columns: usize) -> Matrix {
    Matrix::from_fn(rows, columns, |_, _| random.signed())
}

/// Random rows such that zero lies within their convex hull.
pub fn balanced(random: &mut Random, rows: usize, columns: usize) -> Matrix {
    let mut all = matrix(random, rows, columns);
    let mut last = Vector::zeros(columns);
    for i in 0..rows - 1 {
        last -= all.row(i).transpose() * (0.1 + 0.4 * random.unit());
    }
    all.set_row(rows - 1, &last.transpose());
    all
}

/// The matrix of a fit: powers of a variable in [−1, 1] for few columns in half of the cases, random entries otherwise.
fn regressors(random: &mut Random, rows: usize, columns: usize) -> Matrix {
    if columns > 4 || random.below(2) == 0 {
        return matrix(random, rows, columns);
    }
    let at = entries(random, rows, 1.0);
    Matrix::from_fn(rows, columns, |i, j| at[i].powi(j as i32))
}

/// A x + noise for a random x, which is returned too; rounded to one decimal in half of the cases.
fn data(random: &mut Random, rows: &Matrix) -> (Vector, Vector) {
    let truth = entries(random, rows.ncols(), 3.0);
    let exact = rows * &truth;
    let rounded = random.below(2) == 0;
    let noisy = exact.map(|value| value + random.signed());
    (truth, if rounded { noisy.map(|value| (10.0 * value).round() / 10.0) } else { noisy })
}

/// A box around a point that cuts it off now and then; widths from 1 to 40.
fn surrounding(random: &mut Random, centre: &Vector) -> (Vector, Vector) {
    let width = centre.map(|_| 10_f64.powf(1.3 * random.unit()));
    let lower = Vector::from_fn(centre.len(), |i, _| centre[i] - width[i] * (1.15 * random.unit() - 0.15));
    let upper = Vector::from_fn(centre.len(), |i, _| {
        (centre[i] + width[i] * (1.15 * random.unit() - 0.15)).max(lower[i] + 0.2 * width[i])
    });
    (lower, upper)
}

/// The problem of a family with this number, in a box or without one.
pub fn fit(family: &'static str, number: usize, boxed: bool, random: &mut Random) -> Problem {
    let n = dimension(random, number);
    let m = (8 + random.below(12)).max(n + 3);
    let (function, centre) = match family {
        "L1 fit" | "Chebyshev fit" => {
            let rows = regressors(random, m, n);
            let (centre, right) = data(random, &rows);
            let absolute = |rows, right| Function::new(Outer::AbsoluteSum, rows, right);
            let l1 = family == "L1 fit";
            (if l1 { absolute(rows, right) } else { Function::largest_absolute(&rows, &right) }, centre)
        }
        "sum of norms" => {
            // One norm of all residuals in every fourth problem.
            let group = [2, 3, 2, m][number % 4];
            let rows = matrix(random, m, n);
            let (centre, right) = data(random, &rows);
            (Function::new(Outer::SumOfNorms(group), rows, right), centre)
        }
        _ => {
            let affine = Function::new(Outer::Largest, balanced(random, m, n), entries(random, m, 2.0));
            let curved = family == FITS[4];
            let quadratic = Quadratic { root: matrix(random, n, n), right: entries(random, n, 2.0) };
            (Function { quadratic: curved.then_some(quadratic), ..affine }, Vector::zeros(n))
        }
    };
    let problem = Problem::free(family, function);
    if boxed { problem.boxed(surrounding(random, &centre)) } else { problem }
}
