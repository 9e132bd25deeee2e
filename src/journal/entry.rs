//! One line of a journal: an evaluation as it was asked for and answered.

use super::exact;
use crate::composite::LinearizationRequest;
use crate::{ConstraintEvaluation, ConstraintPiece, Matrix, Request, Vector};
use serde::{Deserialize, Serialize};

/// The record of an evaluation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Entry {
    /// Number of the evaluation, from 1.
    pub evaluation: usize,
    /// The point that was asked for.
    #[serde(with = "exact")]
    pub point: Vec<f64>,
    /// Relative accuracy that was asked for.
    #[serde(with = "exact")]
    pub accuracy: f64,
    /// Descent target of the request.
    #[serde(with = "exact")]
    pub target: Option<f64>,
    /// Request for outputs and Jacobian; none if they were not asked for.
    pub linearization: Option<RecordedRequest>,
    /// Number of the evaluation whose restart data the request carried.
    pub restarted_from: Option<usize>,
    /// Seconds of computation since the start of the run, earlier invocations included.
    pub seconds: f64,
    /// The recorded answer of the oracle.
    pub answer: RecordedAnswer,
}

/// A [`LinearizationRequest`] as it is written down.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedRequest {
    /// Relative accuracy of the Jacobian.
    #[serde(with = "exact")]
    pub accuracy: f64,
    /// Value of Θ above which the Jacobian is not wanted.
    #[serde(with = "exact")]
    pub below: f64,
}

impl From<LinearizationRequest> for RecordedRequest {
    fn from(request: LinearizationRequest) -> Self {
        Self { accuracy: request.accuracy.tolerance(), below: request.below }
    }
}

/// The recorded answer to a request for outputs and Jacobian.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RecordedLinearization {
    /// Outputs and Jacobian are in the file `linearization_K.bin`.
    Stored,
    /// The reason why they could not be had.
    Failed(String),
}

/// A [`ConstraintEvaluation`] as it is written down.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedConstraints {
    /// The values.
    #[serde(with = "exact")]
    pub values: Vec<f64>,
    /// The rows of the Jacobian, one after the other.
    #[serde(with = "exact")]
    pub rows: Vec<f64>,
    /// Constraint, value and gradient of every piece.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pieces: Vec<(usize, f64, Vec<f64>)>,
}

impl From<&ConstraintEvaluation> for RecordedConstraints {
    fn from(found: &ConstraintEvaluation) -> Self {
        let pieces = found.pieces.iter();
        Self {
            values: found.values.as_slice().to_vec(),
            rows: found.jacobian.transpose().as_slice().to_vec(),
            pieces: pieces.map(|p| (p.constraint, p.value, p.gradient.as_slice().to_vec())).collect(),
        }
    }
}

impl RecordedConstraints {
    /// The constraints of `dimension` variables.
    pub(super) fn read(self, dimension: usize) -> ConstraintEvaluation {
        let pieces = self.pieces.into_iter();
        ConstraintEvaluation {
            jacobian: Matrix::from_row_slice(self.values.len(), dimension, &self.rows),
            values: Vector::from_vec(self.values),
            pieces: pieces
                .map(|(constraint, value, gradient)| ConstraintPiece {
                    constraint,
                    value,
                    gradient: Vector::from_vec(gradient),
                })
                .collect(),
        }
    }
}

/// The recorded answer of an evaluation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum RecordedAnswer {
    /// Value and subgradient; the fields are those of [`Evaluation`](crate::Evaluation).
    Evaluated {
        /// Θ(point), or a lower bound of it.
        #[serde(with = "exact")]
        value: f64,
        /// A subgradient at the point.
        #[serde(with = "exact")]
        subgradient: Vec<f64>,
        /// Promised error of the value.
        #[serde(with = "exact")]
        error_bound: f64,
        /// Whether the answer was [`NoDescent`](crate::Answer::NoDescent).
        no_descent: bool,
        /// Whether there were restart data, which then have a file of their own.
        restart_data: bool,
        /// Outputs and Jacobian, if the oracle was asked for them and had an answer to that.
        linearization: Option<RecordedLinearization>,
        /// The nonlinear constraints, if the objective has any.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        constraints: Option<RecordedConstraints>,
        /// Work that the evaluation took, in the oracle's unit.
        work: usize,
    },
    /// The text of the [`OracleError`](crate::OracleError).
    Failed(String),
}

impl Entry {
    /// Whether the request is the recorded one, bit by bit; `restarted_from`: as in the entry.
    pub(super) fn answers<W>(&self, request: &Request<'_, W>, restarted_from: Option<usize>) -> bool {
        let same = |a: f64, b: f64| a.to_bits() == b.to_bits();
        let bits = |wanted: Option<RecordedRequest>| wanted.map(|r| [r.accuracy.to_bits(), r.below.to_bits()]);
        self.point.len() == request.point.len()
            && self.point.iter().zip(request.point.iter()).all(|(a, b)| same(*a, *b))
            && same(self.accuracy, request.accuracy.tolerance())
            && self.target.map(f64::to_bits) == request.descent_target.map(f64::to_bits)
            && bits(self.linearization) == bits(request.linearization.map(RecordedRequest::from))
            && self.restarted_from == restarted_from
    }
}
