//! Problems whose minimiser is chosen first: a vertex of the set, or a kink held by bounds.

use crate::stability::mixed_units::fits::{balanced, dimension, entries, matrix};
use crate::stability::mixed_units::function::{Function, Outer, Quadratic};
use crate::stability::mixed_units::problem::Problem;
use nonsmooth::{Matrix, Vector};
use testset::kit::Random;

/// Names of the families.
pub const VERTICES: [&str; 4] =
    ["linear function in a box", "linear function over rows", "kink on bounds", "kink on bounds plus quadratic"];

/// An affine function with random slopes, none of which is small.
fn slopes(random: &mut Random, n: usize) -> Vector {
    entries(random, n, 1.0).map(|slope| slope + 0.1_f64.copysign(slope))
}

fn linear(slopes: &Vector) -> Function {
    Function::new(Outer::Largest, Matrix::from_row_slice(1, slopes.len(), slopes.as_slice()), Vector::zeros(1))
}

/// Half-spaces R y ≤ s, n of which meet at a random vertex; their combination is the steepest descent.
fn over_rows(random: &mut Random, n: usize) -> Problem {
    let (vertex, more) = (entries(random, n, 3.0), 2);
    let rows = matrix(random, n + more, n);
    let slack = Vector::from_fn(n + more, |i, _| if i < n { 0.0 } else { 0.5 + random.unit() });
    let multipliers = Vector::from_fn(n + more, |i, _| if i < n { 0.2 + random.unit() } else { 0.0 });
    let function = linear(&-rows.tr_mul(&multipliers));
    Problem { sides: &rows * &vertex + slack, rows, ..Problem::free(VERTICES[1], function) }
}

/// max a_i·(y − c) + g·(y − c) (+ ½|L (y − c)|²) in a box: bounds active at c balance g.
fn kink(random: &mut Random, family: &'static str, n: usize) -> Problem {
    let centre = entries(random, n, 3.0);
    let widths = [(); 2].map(|()| Vector::from_fn(n, |_, _| 10_f64.powf(1.3 * random.unit())));
    let (mut lower, mut upper) = (&centre - &widths[0], &centre + &widths[1]);
    let mut slope = Vector::zeros(n);
    for i in 0..n {
        match random.below(3) {
            0 => (lower[i], slope[i]) = (centre[i], 0.1 + random.unit()),
            1 => (upper[i], slope[i]) = (centre[i], -0.1 - random.unit()),
            _ => {}
        }
    }
    let m = (8 + random.below(12)).max(n + 2);
    let mut rows = balanced(random, m, n);
    rows.row_iter_mut().for_each(|mut row| row += slope.transpose());
    let quadratic = Quadratic { root: matrix(random, n, n), right: Vector::zeros(n) };
    let quadratic = (family == VERTICES[3]).then_some(quadratic);
    let function = Function { centre, quadratic, ..Function::new(Outer::Largest, rows, Vector::zeros(m)) };
    Problem::free(family, function).boxed((lower, upper))
}

pub fn vertex(family: &'static str, number: usize, random: &mut Random) -> Problem {
    let n = dimension(random, number);
    match family {
        "linear function in a box" => {
            let lower = entries(random, n, 3.0);
            let upper = lower.map(|side| side + 10_f64.powf(random.unit()));
            Problem::free(family, linear(&slopes(random, n))).boxed((lower, upper))
        }
        "linear function over rows" => over_rows(random, n),
        _ => kink(random, family, n),
    }
}
