//! A convex function of residuals that are affine in the variables.
//!
//! ```text
//! Θ(x) = h(A (x − c) − b + q(x)) + s,   q(x) = ½|L (x − c) − d|² in every entry, for the largest entry only
//! ```

use nonsmooth::composite::{EuclideanNorm, FnOuter, Maximum, OuterFunction, SumOfPowers};
use nonsmooth::{Matrix, Vector};

/// The function h of the residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outer {
    /// The sum Σ |r_i|.
    AbsoluteSum,
    /// The maximum of r_i.
    Largest,
    /// Σ |(r_i, …)|₂ over groups of so many entries in a row.
    SumOfNorms(usize),
}

/// The term ½|L (x − c) − d|².
#[derive(Debug, Clone)]
pub struct Quadratic {
    /// The root L.
    pub root: Matrix,
    /// The right side d.
    pub right: Vector,
}

/// Θ with all its data.
#[derive(Debug, Clone)]
pub struct Function {
    /// The outer function h.
    pub outer: Outer,
    /// A, one row per residual.
    pub rows: Matrix,
    /// The centre c.
    pub centre: Vector,
    /// The right side b.
    pub right: Vector,
    /// q, only where h is the largest entry.
    pub quadratic: Option<Quadratic>,
    /// The constant s added to Θ.
    pub offset: f64,
}

impl Function {
    /// h(A x − b).
    pub fn new(outer: Outer, rows: Matrix, right: Vector) -> Self {
        Self { outer, centre: Vector::zeros(rows.ncols()), rows, right, quadratic: None, offset: 0.0 }
    }

    /// max |A x − b|, as the largest entry of the residuals and their negatives.
    pub fn largest_absolute(rows: &Matrix, right: &Vector) -> Self {
        let (m, n) = rows.shape();
        let sign = |i: usize| if i < m { 1.0 } else { -1.0 };
        let both = Matrix::from_fn(2 * m, n, |i, j| sign(i) * rows[(i % m, j)]);
        Self::new(Outer::Largest, both, Vector::from_fn(2 * m, |i, _| sign(i) * right[i % m]))
    }

    pub fn dimension(&self) -> usize {
        self.rows.ncols()
    }

    /// The function x ↦ f(D x), where D holds the units of the variables.
    #[must_use]
    pub fn in_units(&self, units: &Vector) -> Self {
        let quadratic = self.quadratic.as_ref();
        Self {
            rows: columns_over(&self.rows, units),
            centre: self.centre.component_mul(units),
            quadratic: quadratic.map(|q| Quadratic { root: columns_over(&q.root, units), right: q.right.clone() }),
            ..self.clone()
        }
    }

    /// Replaces the constant that is added to the function.
    #[must_use]
    pub fn with_offset(&self, offset: f64) -> Self {
        Self { offset, ..self.clone() }
    }

    /// The arguments of h and their Jacobian.
    pub fn outputs(&self, x: &Vector) -> (Vector, Matrix) {
        let way = x - &self.centre;
        let (mut outputs, mut jacobian) = (&self.rows * &way - &self.right, self.rows.clone());
        // h(r + t) = h(r) + t: offset and q belong to the residuals.
        if self.outer == Outer::Largest {
            outputs.add_scalar_mut(self.offset);
        }
        if let Some(quadratic) = &self.quadratic {
            let rest = &quadratic.root * &way - &quadratic.right;
            outputs.add_scalar_mut(0.5 * rest.norm_squared());
            let gradient = quadratic.root.tr_mul(&rest).transpose();
            jacobian.row_iter_mut().for_each(|mut row| row += &gradient);
        }
        (outputs, jacobian)
    }

    /// h as the engine takes it: a built-in function where there is one.
    pub fn outer_function(&self) -> Box<dyn OuterFunction> {
        let offset = self.offset;
        match self.outer {
            Outer::Largest => Box::new(Maximum),
            Outer::AbsoluteSum if offset == 0.0 => Box::new(SumOfPowers { exponent: 1.0 }),
            Outer::SumOfNorms(group) if offset == 0.0 && group >= self.rows.nrows() => Box::new(EuclideanNorm),
            Outer::AbsoluteSum => Box::new(FnOuter::new(move |r: &Vector| {
                let absolute = SumOfPowers { exponent: 1.0 };
                (absolute.value(r) + offset, absolute.subgradient(r))
            })),
            Outer::SumOfNorms(group) => Box::new(FnOuter::new(move |r: &Vector| sum_of_norms(r, group, offset))),
        }
    }

    /// Θ and one subgradient.
    pub fn at(&self, x: &Vector) -> (f64, Vector) {
        let (outer, (outputs, jacobian)) = (self.outer_function(), self.outputs(x));
        (outer.value(&outputs), jacobian.tr_mul(&outer.subgradient(&outputs)))
    }

    /// The value of Θ.
    pub fn value(&self, x: &Vector) -> f64 {
        self.outer_function().value(&self.outputs(x).0)
    }

    /// Sum of the sizes of all terms that Θ is computed from: its rounding errors are some ε times as large.
    pub fn size_of_terms(&self, x: &Vector) -> f64 {
        let way = (x - &self.centre).abs();
        let of = |rows: &Matrix, right: &Vector| rows.abs() * &way + right.abs();
        let quadratic = self.quadratic.as_ref().map_or(0.0, |q| of(&q.root, &q.right).norm_squared());
        self.offset.abs() + of(&self.rows, &self.right).sum() + quadratic
    }
}

/// Σ |(r_i, …)|₂ + s over groups, and one subgradient.
fn sum_of_norms(residuals: &Vector, group: usize, offset: f64) -> (f64, Vector) {
    let mut subgradient = residuals.clone();
    let mut value = offset;
    for first in (0..residuals.len()).step_by(group) {
        let count = group.min(residuals.len() - first);
        let size = residuals.rows(first, count).norm();
        value += size;
        if size > 0.0 {
            subgradient.rows_mut(first, count).unscale_mut(size);
        }
    }
    (value, subgradient)
}

/// M D⁻¹ for a diagonal D.
pub fn columns_over(matrix: &Matrix, units: &Vector) -> Matrix {
    Matrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] / units[j])
}
