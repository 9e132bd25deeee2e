//! The minimum of a problem, from a linear, quadratic or cone program in variables whose units are all 1.
//!
//! ```text
//! Σ|r_i|: min Σ t_i, −t ≤ r ≤ t      max r_i: min t + q, r ≤ t      Σ|r_k|₂: min Σ t_k, |r_k|₂ ≤ t_k
//! r = A (y − c) − b
//! ```
//! A linear program ends at a vertex, which its active rows give to the last digits.

use crate::stability::mixed_units::cone_program::ConeProgram;
use crate::stability::mixed_units::function::Outer;
use crate::stability::mixed_units::problem::Problem;
use nonsmooth::{Matrix, Vector};

/// Largest difference of minimum and dual value, relative to the size of Θ.
const PROVED: f64 = 1e-9;
/// A variable so near to a bound, in units of 1, lies on it.
const ON_BOUND: f64 = 1e-8;

/// What is known about a problem.
#[derive(Debug, Clone)]
pub struct Truth {
    /// A point at which the minimum is attained.
    pub minimiser: Vector,
    /// The minimum, without an offset.
    pub minimum: f64,
    /// By how much the true minimum can lie below it.
    pub uncertainty: f64,
    /// How much Θ rises one unit away from the minimiser, the mean over the variables: the size of Θ.
    pub rise: f64,
}

impl Truth {
    /// Solves a problem.
    ///
    /// # Errors
    /// A text if the program could not be solved to [`PROVED`].
    pub fn of(problem: &Problem) -> Result<Self, String> {
        let (program, constant) = program(problem);
        let optimum = program.solve()?;
        let vertex = program.vertex(&optimum.point);
        let n = problem.lower.len();
        let points = [Some(optimum.point), vertex].into_iter().flatten().map(|z| within(problem, z.rows(0, n).into()));
        let violation = |y: &Vector| (&problem.rows * y - &problem.sides).iter().copied().fold(0.0, f64::max);
        let valued = points.filter(|y| violation(y) <= PROVED).map(|y| (problem.function.value(&y), y));
        let Some((minimum, minimiser)) = valued.min_by(|one, next| one.0.total_cmp(&next.0)) else {
            return Err("the program has no admissible point".to_owned());
        };
        let rise = rise(problem, &minimiser, minimum);
        let uncertainty = minimum - optimum.dual_value - constant;
        if !uncertainty.is_finite() || uncertainty.abs() > PROVED * (rise + minimum.abs()) {
            return Err(format!("{}: the minimum {minimum} is uncertain by {uncertainty:.1e}", problem.family));
        }
        Ok(Self { minimiser, minimum, uncertainty: uncertainty.max(0.0), rise })
    }

    /// A point outside of the bounds that are active at the minimiser.
    pub fn beyond(&self, problem: &Problem) -> Vector {
        Vector::from_fn(self.minimiser.len(), |i, _| {
            let y = self.minimiser[i];
            y - f64::from(u8::from(y == problem.lower[i])) + f64::from(u8::from(y == problem.upper[i]))
        })
    }
}

/// The point moved into the box, and onto bounds that it nearly touches.
fn within(problem: &Problem, mut y: Vector) -> Vector {
    for i in 0..y.len() {
        for side in [problem.lower[i], problem.upper[i]] {
            if (y[i] - side).abs() <= ON_BOUND {
                y[i] = side;
            }
        }
        y[i] = y[i].max(problem.lower[i]).min(problem.upper[i]);
    }
    y
}

fn rise(problem: &Problem, minimiser: &Vector, minimum: f64) -> f64 {
    let n = minimiser.len();
    let moved = |i: usize, by: f64| Vector::from_fn(n, |j, _| minimiser[j] + if i == j { by } else { 0.0 });
    let at = |i: usize, by: f64| (problem.function.value(&moved(i, by)) - minimum).abs();
    (0..n).map(|i| at(i, 1.0).max(at(i, -1.0))).sum::<f64>() / n as f64
}

/// The program in (y, t), and the constant of its objective.
fn program(problem: &Problem) -> (ConeProgram, f64) {
    let function = &problem.function;
    let (m, n) = function.rows.shape();
    // A y − e are the residuals.
    let right = &function.right + &function.rows * &function.centre;
    let auxiliary = match function.outer {
        Outer::AbsoluteSum => m,
        Outer::Largest => 1,
        Outer::SumOfNorms(group) => m.div_ceil(group),
    };
    let size = n + auxiliary;
    let row = |entries: &dyn Fn(usize) -> f64, slack: Option<usize>| {
        Vector::from_fn(size, |j, _| if j < n { entries(j) } else { f64::from(u8::from(slack == Some(j - n))) })
    };
    let mut half_spaces = vec![];
    let mut cones = vec![];
    for i in 0..m {
        let (below, above) = (|j: usize| function.rows[(i, j)], |j: usize| -function.rows[(i, j)]);
        match function.outer {
            Outer::AbsoluteSum => {
                half_spaces.push((-row(&above, Some(i)), right[i]));
                half_spaces.push((-row(&below, Some(i)), -right[i]));
            }
            Outer::Largest => half_spaces.push((-row(&above, Some(0)), right[i])),
            Outer::SumOfNorms(group) if i % group == 0 => {
                let count = group.min(m - i);
                let residuals = |k: usize| row(&|j| function.rows[(i + k, j)], None).transpose();
                let mut matrix = Matrix::zeros(count + 1, size);
                matrix[(0, n + i / group)] = 1.0;
                (0..count).for_each(|k| matrix.set_row(k + 1, &residuals(k)));
                cones.push((matrix, Vector::from_fn(count + 1, |k, _| if k == 0 { 0.0 } else { right[i + k - 1] })));
            }
            Outer::SumOfNorms(_) => {}
        }
    }
    half_spaces.extend(constraints(problem, size));
    let mut linear = Vector::from_fn(size, |j, _| f64::from(u8::from(j >= n)));
    let (mut hessian, mut constant) = (Matrix::zeros(size, size), 0.0);
    if let Some(quadratic) = &function.quadratic {
        let rest = &quadratic.right + &quadratic.root * &function.centre;
        hessian.view_mut((0, 0), (n, n)).copy_from(&quadratic.root.tr_mul(&quadratic.root));
        linear.rows_mut(0, n).copy_from(&-quadratic.root.tr_mul(&rest));
        constant = 0.5 * rest.norm_squared();
    }
    (ConeProgram { hessian, linear, half_spaces, cones }, constant)
}

/// Bounds and rows as half-spaces of a space with further variables.
fn constraints(problem: &Problem, size: usize) -> Vec<(Vector, f64)> {
    let n = problem.lower.len();
    let unit = |i: usize, sign: f64| Vector::from_fn(size, |j, _| if i == j { sign } else { 0.0 });
    let lower = (0..n).map(|i| (unit(i, -1.0), -problem.lower[i]));
    let upper = (0..n).map(|i| (unit(i, 1.0), problem.upper[i]));
    let row = |i: usize| Vector::from_fn(size, |j, _| if j < n { problem.rows[(i, j)] } else { 0.0 });
    let rows = (0..problem.sides.len()).map(|i| (row(i), problem.sides[i]));
    lower.chain(upper).chain(rows).filter(|(_, side)| side.is_finite()).collect()
}
