//! The admissible set: a box and two-sided linear rows.
//!
//! ```text
//! U = { x : lower ≤ x ≤ upper,  row_lower ≤ A x ≤ row_upper }                                        method.md (1.1)
//! ```
//! Equal sides make an equality; ±∞ leaves a side open.

use crate::checks::{check_finite, check_intervals, check_size};
use crate::{InputError, Matrix, Vector};

/// A polyhedron given by bounds and two-sided rows.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "Stored", into = "Stored")]
pub struct Polyhedron {
    lower: Vector,
    upper: Vector,
    rows: Matrix,
    row_lower: Vector,
    row_upper: Vector,
    /// Number of the last rows that are linearizations at a center: a violation of them is not taken for rounding of
    /// the center.
    tangents: usize,
}

/// A polyhedron in a file: open sides are `null`, because text formats have no infinity.
#[derive(serde::Serialize, serde::Deserialize)]
struct Stored {
    lower: Vec<Option<f64>>,
    upper: Vec<Option<f64>>,
    rows: Vec<Vec<f64>>,
    row_lower: Vec<Option<f64>>,
    row_upper: Vec<Option<f64>>,
}

impl From<Polyhedron> for Stored {
    fn from(set: Polyhedron) -> Self {
        let sides = |side: &Vector| side.iter().map(|value| value.is_finite().then_some(*value)).collect();
        Self {
            lower: sides(&set.lower),
            upper: sides(&set.upper),
            rows: set.rows.row_iter().map(|row| row.iter().copied().collect()).collect(),
            row_lower: sides(&set.row_lower),
            row_upper: sides(&set.row_upper),
        }
    }
}

impl TryFrom<Stored> for Polyhedron {
    type Error = InputError;

    fn try_from(stored: Stored) -> Result<Self, InputError> {
        let sides = |side: &[Option<f64>], open: f64| {
            Vector::from_iterator(side.len(), side.iter().map(|value| value.unwrap_or(open)))
        };
        let dimension = stored.lower.len();
        if let Some(row) = stored.rows.iter().find(|row| row.len() != dimension) {
            return Err(InputError::Dimension { what: "constraint row", expected: dimension, found: row.len() });
        }
        let rows = Matrix::from_fn(stored.rows.len(), dimension, |i, j| stored.rows[i][j]);
        Self::boxed(sides(&stored.lower, f64::NEG_INFINITY), sides(&stored.upper, f64::INFINITY))?.with_rows(
            &rows,
            &sides(&stored.row_lower, f64::NEG_INFINITY),
            &sides(&stored.row_upper, f64::INFINITY),
        )
    }
}

impl Polyhedron {
    /// The whole space of `dimension` variables.
    pub fn unbounded(dimension: usize) -> Self {
        Self {
            lower: Vector::from_element(dimension, f64::NEG_INFINITY),
            upper: Vector::from_element(dimension, f64::INFINITY),
            rows: Matrix::zeros(0, dimension),
            row_lower: Vector::zeros(0),
            row_upper: Vector::zeros(0),
            tangents: 0,
        }
    }

    /// The box lower ≤ x ≤ upper; infinite entries leave a side open, equal entries fix a variable.
    ///
    /// # Errors
    /// [`InputError`] on sizes that differ, NaN, or a lower bound above its upper bound.
    pub fn boxed(lower: Vector, upper: Vector) -> Result<Self, InputError> {
        check_size("upper bounds", lower.len(), upper.len())?;
        check_intervals("variable", &lower, &upper)?;
        Ok(Self { rows: Matrix::zeros(0, lower.len()), lower, upper, ..Self::unbounded(0) })
    }

    /// Adds the rows `row_lower ≤ A x ≤ row_upper`, with A of shape rows × dimension, to those already there.
    ///
    /// # Errors
    /// [`InputError`] on sizes that differ, entries that are not finite, or an empty interval.
    pub fn with_rows(mut self, rows: &Matrix, row_lower: &Vector, row_upper: &Vector) -> Result<Self, InputError> {
        check_size("constraint row", self.dimension(), rows.ncols())?;
        check_size("row_lower", rows.nrows(), row_lower.len())?;
        check_size("row_upper", rows.nrows(), row_upper.len())?;
        check_finite("constraint rows", rows.as_slice())?;
        check_intervals("row", row_lower, row_upper)?;
        let old = self.rows.nrows();
        self.rows = self.rows.resize_vertically(old + rows.nrows(), 0.0);
        self.rows.rows_mut(old, rows.nrows()).copy_from(rows);
        self.row_lower = stack(&self.row_lower, row_lower);
        self.row_upper = stack(&self.row_upper, row_upper);
        Ok(self)
    }

    /// Adds rows that are linearizations at a center.
    pub(crate) fn with_tangents(mut self, rows: &Matrix, lower: &Vector, upper: &Vector) -> Self {
        let old = self.rows.nrows();
        self.rows = self.rows.resize_vertically(old + rows.nrows(), 0.0);
        self.rows.rows_mut(old, rows.nrows()).copy_from(rows);
        self.row_lower = stack(&self.row_lower, lower);
        self.row_upper = stack(&self.row_upper, upper);
        self.tangents = rows.nrows();
        self
    }

    /// The set with the sides of its linearizations moved apart.
    pub(crate) fn with_tangents_relaxed(&self, by: f64) -> Self {
        let mut other = self.clone();
        let (own, count) = (self.rows.nrows() - self.tangents, self.tangents);
        other.row_lower.rows_mut(own, count).add_scalar_mut(-by);
        other.row_upper.rows_mut(own, count).add_scalar_mut(by);
        other
    }

    /// The set with some of its linearizations only, given by their positions among them.
    pub(crate) fn with_tangents_kept(&self, kept: &[usize]) -> Self {
        let own = self.rows.nrows() - self.tangents;
        let rows: Vec<usize> = (0..own).chain(kept.iter().map(|i| own + i)).collect();
        Self {
            rows: self.rows.select_rows(&rows),
            row_lower: self.row_lower.select_rows(&rows),
            row_upper: self.row_upper.select_rows(&rows),
            tangents: kept.len(),
            ..self.clone()
        }
    }

    /// The set with some of its rows only; none of them is a linearization.
    pub(crate) fn with_rows_kept(&self, kept: &[usize]) -> Self {
        Self {
            rows: self.rows.select_rows(kept),
            row_lower: self.row_lower.select_rows(kept),
            row_upper: self.row_upper.select_rows(kept),
            ..self.clone()
        }
    }

    /// Number of the last rows that are linearizations at a center.
    pub(crate) fn tangents(&self) -> usize {
        self.tangents
    }

    /// Number of variables.
    pub fn dimension(&self) -> usize {
        self.lower.len()
    }

    /// Lower bounds, −∞ where open.
    pub fn lower(&self) -> &Vector {
        &self.lower
    }

    /// Upper bounds, +∞ where open.
    pub fn upper(&self) -> &Vector {
        &self.upper
    }

    /// The matrix A, rows × dimension.
    pub fn rows(&self) -> &Matrix {
        &self.rows
    }

    /// Lower sides of the rows.
    pub fn row_lower(&self) -> &Vector {
        &self.row_lower
    }

    /// Upper sides of the rows.
    pub fn row_upper(&self) -> &Vector {
        &self.row_upper
    }

    /// Largest violation of any side at x, relative to the size of that side's bound and of its terms
    /// (max(|bound|, Σⱼ|aⱼxⱼ|), so it does not depend on units); 0 for an admissible point.
    pub fn violation(&self, x: &Vector) -> f64 {
        self.violation_near(x, x)
    }

    /// As [`violation`](Self::violation), but each term has the larger of its sizes at x and at `reference`. A point
    /// whose entries happen to be near zero then does not depend on its rounding errors.
    pub(crate) fn violation_near(&self, x: &Vector, reference: &Vector) -> f64 {
        let mut worst: f64 = 0.0;
        let sides = self.lower.as_slice().iter().zip(self.upper.as_slice());
        // Nearly all entries lie within their sides: a test without a maximum passes over them fast. NaN lies within
        // none.
        let entries = x.as_slice().iter().zip(reference.as_slice()).zip(sides);
        for ((x, reference), (&lower, &upper)) in
            entries.filter(|((x, _), (lower, upper))| !(**lower..=**upper).contains(*x))
        {
            worst = worst.max(side_violation(*x, lower, upper, x.abs().max(reference.abs())));
        }
        (0..self.rows.nrows()).map(|i| self.row_violation(i, x, reference)).fold(worst, f64::max)
    }

    fn row_violation(&self, i: usize, x: &Vector, reference: &Vector) -> f64 {
        let (mut value, mut scale) = (0.0, 0.0);
        for (a, (x, y)) in self.rows.row(i).iter().zip(x.iter().zip(reference.iter())) {
            value += a * x;
            scale += (a * x).abs().max((a * y).abs());
        }
        side_violation(value, self.row_lower[i], self.row_upper[i], scale)
    }

    /// x with every entry moved into its box.
    pub(crate) fn clamp_to_box(&self, x: &Vector) -> Vector {
        Vector::from_fn(x.len(), |i, _| x[i].max(self.lower[i]).min(self.upper[i]))
    }
}

fn stack(a: &Vector, b: &Vector) -> Vector {
    Vector::from_iterator(a.len() + b.len(), a.iter().chain(b.iter()).copied())
}

/// Violation of lower ≤ value ≤ upper relative to the violated bound and the terms that make up the value.
fn side_violation(value: f64, lower: f64, upper: f64, scale: f64) -> f64 {
    if value >= lower && value <= upper {
        return 0.0;
    }
    if value.is_nan() {
        return f64::INFINITY;
    }
    let relative = |excess: f64, bound: f64| {
        if excess > 0.0 { excess / bound.abs().max(scale).max(f64::MIN_POSITIVE) } else { 0.0 }
    };
    relative(lower - value, lower).max(relative(value - upper, upper))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Polyhedron {
        let rows = Matrix::from_row_slice(1, 2, &[1.0, 1.0]);
        let side = |value| Vector::from_element(1, value);
        Polyhedron::boxed(Vector::zeros(2), Vector::from_element(2, 10.0))
            .and_then(|set| set.with_rows(&rows, &side(f64::NEG_INFINITY), &side(1.0)))
            .expect("valid set")
    }

    #[test]
    fn violation_is_zero_inside_and_relative_outside() {
        assert_eq!(triangle().violation(&Vector::from_vec(vec![0.25, 0.75])), 0.0);
        let outside = triangle().violation(&Vector::from_vec(vec![1.0, 1.0]));
        assert!((outside - 0.5).abs() < 1e-15);
    }

    #[test]
    fn empty_interval_is_refused_with_its_position() {
        let error = Polyhedron::boxed(Vector::from_vec(vec![0.0, 2.0]), Vector::from_vec(vec![1.0, 1.0]));
        assert_eq!(error, Err(InputError::EmptyInterval { what: "variable", index: 1, lower: 2.0, upper: 1.0 }));
    }

    #[test]
    fn nan_bound_is_refused() {
        let error = Polyhedron::boxed(Vector::from_vec(vec![f64::NAN]), Vector::zeros(1));
        assert!(matches!(error, Err(InputError::NotFinite { index: 0, .. })));
    }
}
