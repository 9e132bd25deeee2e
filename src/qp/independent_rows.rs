//! Equality rows that do not depend on each other.
//!
//! ```text
//! rows of A D over the variables that are not fixed, of length 1;  D: sizes of the variables
//! repeat:  take the row of largest remainder, take its direction out of all others, and their sides with it
//! remainder ≤ 1e-10: the row depends on those taken;  its remaining side is a contradiction, or rounding of the sides
//! ```
//! Gram–Schmidt with row pivoting, twice for every row that is taken.

use super::kernels::{add_scaled, dot, norm};
use super::least_violation::least_violation;
use super::problem::QpError;
use crate::{Matrix, Polyhedron, Vector};

/// Remainder of a row of length 1 that is rounding: the row depends on others.
const DEPENDENT: f64 = 1e-10;
/// Contradiction of a dependent row, relative to the sides that it is the difference of, that counts as rounding.
const ROUNDING: f64 = 1e-9;
/// Contradiction that is rounding of the sides in any case, and not worth a word.
const SILENT: f64 = 1e-13;

/// A set without the equality rows that depend on others.
#[derive(Debug, Clone)]
pub(crate) struct IndependentRows {
    pub set: Polyhedron,
    /// The rows that are kept, ascending, by their number in the whole set.
    kept: Vec<usize>,
    /// Number of rows of the whole set.
    count: usize,
    /// The row that contradicts those it depends on most, and by how much, relative to the sides.
    pub contradiction: Option<(usize, f64)>,
}

/// An equality row under work.
struct Row {
    number: usize,
    /// The part of the row outside the span of the others, of length 1 at the start.
    rest: Vec<f64>,
    side: f64,
    /// Size of the terms of the side.
    size: f64,
}

impl IndependentRows {
    /// `sizes`: sizes of the variables relative to each other.
    pub(crate) fn new(set: &Polyhedron, sizes: impl Fn(usize) -> f64) -> Self {
        let is_equality = |i: &usize| set.row_lower()[*i] == set.row_upper()[*i];
        let equalities: Vec<usize> = (0..set.rows().nrows()).filter(is_equality).collect();
        let all = || (0..set.rows().nrows()).collect::<Vec<usize>>();
        let fixes = set.lower().iter().zip(set.upper().iter()).any(|(lower, upper)| lower == upper);
        let whole = Self { set: set.clone(), kept: all(), count: set.rows().nrows(), contradiction: None };
        if equalities.is_empty() || equalities.len() == 1 && !fixes {
            return whole;
        }
        let mut rows: Vec<Row> = equalities.into_iter().map(|number| Row::new(set, number, &sizes)).collect();
        let mut directions: Vec<(Vec<f64>, f64, f64)> = Vec::new();
        while let Some(place) = largest(&rows) {
            let mut row = rows.swap_remove(place);
            for (direction, side, size) in &directions {
                row.reduce(direction, *side, *size);
            }
            let length = norm(&row.rest);
            row.rest.iter_mut().for_each(|entry| *entry /= length);
            let (side, size) = (row.side / length, row.size / length);
            rows.iter_mut().for_each(|other| other.reduce(&row.rest, side, size));
            directions.push((row.rest, side, size));
        }
        if rows.is_empty() {
            return whole;
        }
        let contradictions = rows.iter().map(|row| (row.number, row.side.abs() / row.size.max(f64::MIN_POSITIVE)));
        let contradiction = contradictions.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, by)| *by > SILENT);
        let dependent: Vec<usize> = rows.iter().map(|row| row.number).collect();
        let kept: Vec<usize> = all().into_iter().filter(|row| !dependent.contains(row)).collect();
        Self { set: set.with_rows_kept(&kept), kept, count: whole.count, contradiction }
    }

    /// The set, unless a row contradicts others by more than rounding; `whole`: with all rows, `x`: where the search
    /// for the least violation begins.
    ///
    /// # Errors
    /// [`QpError::Infeasible`].
    pub(crate) fn consistent(&self, whole: &Polyhedron, x: &Vector) -> Result<&Polyhedron, QpError> {
        match self.contradiction {
            Some((_, by)) if by > ROUNDING => {
                Err(QpError::Infeasible { violation: least_violation(whole, &whole.clamp_to_box(x)) })
            }
            _ => Ok(&self.set),
        }
    }

    /// Multipliers of all rows from those of the rows that are kept: 0 for the others.
    pub(crate) fn whole_multipliers(&self, kept: &Vector) -> Vector {
        let mut whole = Vector::zeros(self.count);
        self.kept.iter().zip(kept.iter()).for_each(|(&row, multiplier)| whole[row] = *multiplier);
        whole
    }
}

impl Row {
    /// A row over the variables that are not fixed.
    fn new(set: &Polyhedron, number: usize, sizes: &impl Fn(usize) -> f64) -> Self {
        let (rows, lower): (&Matrix, &Vector) = (set.rows(), set.lower());
        let (mut rest, mut side) = (vec![0.0; set.dimension()], set.row_upper()[number]);
        let (mut size, mut whole) = (side.abs(), 0.0);
        for (j, entry) in rest.iter_mut().enumerate() {
            let a = rows[(number, j)];
            whole += (a * sizes(j)).powi(2);
            if lower[j] == set.upper()[j] {
                side -= a * lower[j];
                size += (a * lower[j]).abs();
            } else {
                *entry = a * sizes(j);
            }
        }
        let length = if whole > 0.0 { whole.sqrt() } else { 1.0 };
        rest.iter_mut().for_each(|entry| *entry /= length);
        Self { number, rest, side: side / length, size: size / length }
    }

    /// Takes a direction out.
    fn reduce(&mut self, direction: &[f64], side: f64, size: f64) {
        let share = dot(&self.rest, direction);
        add_scaled(&mut self.rest, -share, direction);
        self.side -= share * side;
        // Rounding of the share counts as much as a side may be contradicted.
        self.size += (share.abs() + f64::EPSILON / ROUNDING * direction.len() as f64) * size;
    }
}

/// The row with the largest remainder; none if all are rounding.
fn largest(rows: &[Row]) -> Option<usize> {
    let lengths = rows.iter().map(|row| norm(&row.rest)).enumerate();
    lengths.filter(|(_, length)| *length > DEPENDENT).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(place, _)| place)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(rows: &[f64], sides: &[f64]) -> Polyhedron {
        let n = rows.len() / sides.len();
        let sides = Vector::from_column_slice(sides);
        Polyhedron::unbounded(n)
            .with_rows(&Matrix::from_row_slice(sides.len(), n, rows), &sides, &sides)
            .expect("valid set")
    }

    #[test]
    fn the_rows_of_a_network_lose_one() {
        // A triangle: the sum of the rows is zero.
        let found =
            IndependentRows::new(&set(&[1.0, 0.0, -1.0, -1.0, 1.0, 0.0, 0.0, -1.0, 1.0], &[2.0, -0.5, -1.5]), |_| 1.0);
        assert_eq!((found.set.rows().nrows(), found.contradiction), (2, None));
        let whole = found.whole_multipliers(&Vector::from_vec(vec![3.0, 4.0]));
        assert_eq!((whole.len(), whole.sum()), (3, 7.0));
    }

    #[test]
    fn contradictions_are_told_from_rounding_in_units_of_the_rows() {
        for unit in [1e-6, 1.0, 1e6] {
            let rows = [unit, unit, 2.0 * unit, 2.0 * unit];
            for (gap, contradicts) in [(1e-16, false), (1e-11, false), (1e-7, true), (1.0, true)] {
                let whole = set(&rows, &[unit, 2.0 * unit * (1.0 + gap)]);
                let found = IndependentRows::new(&whole, |_| 1.0);
                let refused = found.consistent(&whole, &Vector::zeros(2)).is_err();
                assert_eq!((found.set.rows().nrows(), refused), (1, contradicts), "{unit:e} {gap:e}");
                assert_eq!(found.contradiction.is_some(), gap > 1e-13, "{unit:e} {gap:e}");
            }
        }
    }

    #[test]
    fn fixed_variables_leave_rows_of_constants() {
        let fixed = |value: f64| {
            Polyhedron::boxed(Vector::from_vec(vec![value, 0.0]), Vector::from_vec(vec![value, 1.0]))
                .and_then(|set| {
                    let one = Vector::from_element(1, 1.0);
                    set.with_rows(&Matrix::from_row_slice(1, 2, &[2.0, 0.0]), &one, &one)
                })
                .expect("valid set")
        };
        for (value, is_empty) in [(0.5, false), (0.6, true)] {
            let set = fixed(value);
            assert_eq!(IndependentRows::new(&set, |_| 1.0).consistent(&set, &Vector::zeros(2)).is_err(), is_empty);
        }
    }
}
