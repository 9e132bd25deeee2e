//! Nonlinear constraints c_j(x) ≤ 0 beside the admissible set.
//!
//! ```text
//! minimise Θ(x)  over  x ∈ U  with  c_j(x) ≤ 0 (inequality)  or  c_j(x) = 0 (equality),   j = 1 … m
//! ```
//! Values and subgradients of the constraints come from the evaluation that gives Θ. A constraint may be nonsmooth: one
//! subgradient of c_j at the point is enough, and further linearizations of c_j at the point ([`ConstraintPiece`]) make
//! the model sharper. Points that are evaluated may violate nonlinear constraints; they never violate U.

use crate::checks::{check_finite, check_size};
use crate::{InputError, Matrix, Vector};
use serde::{Deserialize, Serialize};

/// The condition of a nonlinear constraint, and how it may be modelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ConstraintKind {
    /// c(x) ≤ 0 with a locally Lipschitz c: the evaluation returns one subgradient.
    Nonsmooth,
    /// c(x) ≤ 0 with a continuously differentiable c: the evaluation returns its gradient.
    Smooth,
    /// c(x) = 0 with a continuously differentiable c. A nonsmooth equality has no linearization that could be satisfied
    /// near a kink.
    SmoothEquality,
}

impl ConstraintKind {
    /// By how much a value violates the constraint: c⁺, or |c| for an equality.
    pub fn violation(self, value: f64) -> f64 {
        if self == Self::SmoothEquality { value.abs() } else { value.max(0.0) }
    }
}

/// A further linearization of a constraint at the point of an evaluation: c_j(y) ≥ value + ⟨gradient, y − x⟩ up to
/// second order for one of the pieces of which c_j is the maximum.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstraintPiece {
    /// The constraint j, counted from 0.
    pub constraint: usize,
    /// The value of the piece at the point, at most c_j there.
    pub value: f64,
    /// The gradient of the piece, n entries.
    pub gradient: Vector,
}

/// A piece of a constraint that is a function of the outputs c, with its gradient at these outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputPiece {
    /// The constraint j, counted from 0.
    pub constraint: usize,
    /// The value of the piece.
    pub value: f64,
    /// The gradient by the outputs, m entries.
    pub weights: Vector,
}

/// Values of the constraints at a point, with one subgradient of each.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstraintEvaluation {
    /// c, m entries, each in the unit of its constraint.
    pub values: Vector,
    /// One subgradient of c_j in row j, m × n.
    pub jacobian: Matrix,
    /// Further linearizations at the point.
    pub pieces: Vec<ConstraintPiece>,
}

impl ConstraintEvaluation {
    /// Values with one subgradient of each constraint.
    pub fn new(values: Vector, jacobian: Matrix) -> Self {
        Self { values, jacobian, pieces: vec![] }
    }

    /// The constraints whose pieces are functions of outputs; `gradient` is the gradient by the variables for weights
    /// of the outputs.
    pub(crate) fn of_pieces<E>(
        count: usize,
        dimension: usize,
        pieces: &[OutputPiece],
        mut gradient: impl FnMut(&Vector) -> Result<Vector, E>,
        all: bool,
    ) -> Result<Self, E> {
        let mut values = Vector::from_element(count, f64::NAN);
        let mut largest: Vec<Option<usize>> = vec![None; count];
        for (index, piece) in pieces.iter().enumerate().filter(|(_, piece)| piece.constraint < count) {
            // A value that is NaN stays, to be refused.
            if largest[piece.constraint].is_none() || piece.value.is_nan() || piece.value > values[piece.constraint] {
                (values[piece.constraint], largest[piece.constraint]) = (piece.value, Some(index));
            }
        }
        let mut found = Self::new(values, Matrix::zeros(count, dimension));
        for (index, piece) in pieces.iter().enumerate().filter(|(_, piece)| piece.constraint < count) {
            let own = largest[piece.constraint] == Some(index);
            if !(own || all) {
                continue;
            }
            let gradient = gradient(&piece.weights)?;
            if own {
                found.jacobian.set_row(piece.constraint, &gradient.transpose());
            } else {
                found.pieces.push(ConstraintPiece { constraint: piece.constraint, value: piece.value, gradient });
            }
        }
        Ok(found)
    }

    /// Refuses wrong sizes, and entries that are not finite.
    ///
    /// # Errors
    /// [`InputError`], with the number of the constraint as the entry.
    pub(crate) fn check(&self, dimension: usize) -> Result<(), InputError> {
        check_finite("constraint values", self.values.as_slice())?;
        check_size("rows of the Jacobian of the constraints", self.values.len(), self.jacobian.nrows())?;
        check_size("columns of the Jacobian of the constraints", dimension, self.jacobian.ncols())?;
        for (index, row) in self.jacobian.row_iter().enumerate() {
            if let Some(&value) = row.iter().find(|entry| !entry.is_finite()) {
                return Err(InputError::NotFinite { what: "Jacobian of the constraints (row)", index, value });
            }
        }
        for piece in &self.pieces {
            let (what, count) = ("constraints", self.values.len());
            if piece.constraint >= count {
                return Err(InputError::Dimension { what, expected: count, found: piece.constraint + 1 });
            }
            check_size("gradient of a piece of a constraint", dimension, piece.gradient.len())?;
            check_finite("value of a piece of a constraint", &[piece.value])?;
            check_finite("gradient of a piece of a constraint", piece.gradient.as_slice())?;
        }
        Ok(())
    }
}
