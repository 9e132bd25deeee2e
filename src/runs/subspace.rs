//! An objective on an affine subspace: x = origin + D β with the variables β.

use crate::composite::{Linearized, OuterFunction};
use crate::{
    Answer, ConstraintKind, Evaluation, InputError, Matrix, NonsmoothObjective, OracleError, Polyhedron, Report,
    Request, Vector,
};

/// Θ(origin + D β).
#[derive(Debug)]
pub struct Subspace<O> {
    inner: O,
    origin: Vector,
    directions: Matrix,
}

impl<O> Subspace<O> {
    /// The objective on the points that some directions, the columns of a matrix, reach from an origin.
    pub fn new(inner: O, origin: Vector, directions: Matrix) -> Self {
        Self { inner, origin, directions }
    }

    /// The point x of β.
    pub fn point(&self, variables: &Vector) -> Vector {
        &self.origin + &self.directions * variables
    }

    /// The β whose points lie in a set that holds the origin: bounds of x become rows.
    ///
    /// # Errors
    /// [`InputError`] for a set of other variables.
    pub fn set(&self, set: &Polyhedron) -> Result<Polyhedron, InputError> {
        let at_origin = set.rows() * &self.origin;
        // The origin lies in the set up to rounding.
        let below = |side: &Vector, at: &Vector| (side - at).map(|room| room.min(0.0));
        let above = |side: &Vector, at: &Vector| (side - at).map(|room| room.max(0.0));
        let bounds = [below(set.lower(), &self.origin), above(set.upper(), &self.origin)];
        let rows = [below(set.row_lower(), &at_origin), above(set.row_upper(), &at_origin)];
        Polyhedron::unbounded(self.directions.ncols()).with_rows(&self.directions, &bounds[0], &bounds[1])?.with_rows(
            &(set.rows() * &self.directions),
            &rows[0],
            &rows[1],
        )
    }

    /// A report on β as one on x. The certificate, which holds within the subspace alone, is left out.
    pub fn reported(&self, report: Report) -> Report {
        let mut report = report;
        report.solution = self.point(&report.solution);
        report.certificate = None;
        report
    }

    /// The evaluation at β that one at x gives.
    fn restricted<W>(&self, mut evaluation: Evaluation<W>) -> Evaluation<W> {
        evaluation.subgradient = self.directions.tr_mul(&evaluation.subgradient);
        if let Linearized::Known(known) = &mut evaluation.linearization {
            known.jacobian = &known.jacobian * &self.directions;
            if let Some(inactive) = &mut known.inactive {
                inactive.jacobian = &inactive.jacobian * &self.directions;
            }
        }
        if let Some(constraints) = &mut evaluation.constraints {
            constraints.jacobian = &constraints.jacobian * &self.directions;
            for piece in &mut constraints.pieces {
                piece.gradient = self.directions.tr_mul(&piece.gradient);
            }
        }
        evaluation
    }
}

impl<O: NonsmoothObjective> NonsmoothObjective for Subspace<O> {
    type WarmStart = O::WarmStart;

    fn dimension(&self) -> usize {
        self.directions.ncols()
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        self.inner.outer()
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        self.inner.constraint_kinds()
    }

    fn evaluate(&self, request: &Request<'_, O::WarmStart>) -> Result<Answer<O::WarmStart>, OracleError> {
        let point = self.point(request.point);
        let answer = self.inner.evaluate(&Request {
            point: &point,
            warm_start: request.warm_start,
            accuracy: request.accuracy,
            descent_target: request.descent_target,
            linearization: request.linearization,
        })?;
        Ok(match answer {
            Answer::Accurate(evaluation) => Answer::Accurate(self.restricted(evaluation)),
            Answer::NoDescent(evaluation) => Answer::NoDescent(self.restricted(evaluation)),
        })
    }
}
