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

    /// What an evaluation at x says on β.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BundleTrust, BundleTrustConfig, CompositeFunction, composite::Maximum};

    /// max(x², 2 y + 3 z) on the line (1, 1, 0) + β (1, −1, 0), with its minimum where x² = 2 y.
    #[test]
    fn a_line_through_a_kink() {
        let theta = CompositeFunction::new(3, Maximum, |p: &Vector| {
            let rows = [2.0 * p[0], 0.0, 0.0, 0.0, 2.0, 3.0];
            (Vector::from_vec(vec![p[0] * p[0], 2.0 * p[1] + 3.0 * p[2]]), Matrix::from_row_slice(2, 3, &rows))
        });
        let origin = Vector::from_vec(vec![1.0, 1.0, 0.0]);
        let line = Subspace::new(theta, origin, Matrix::from_vec(3, 1, vec![1.0, -1.0, 0.0]));
        let lower = Vector::from_vec(vec![-9.0, -9.0, -1.0]);
        let whole = Polyhedron::boxed(lower, Vector::from_element(3, 9.0)).expect("a box");
        let set = line.set(&whole).expect("the same variables");
        let mut method = BundleTrust::new(BundleTrustConfig::default()).expect("defaults").constraints(set);
        let report = line.reported(method.minimize(&line, Vector::zeros(1)).expect("a line"));
        // x² = 2 (2 − x).
        let x = 5.0_f64.sqrt() - 1.0;
        assert!((report.solution[0] - x).abs() < 1e-6 && (report.solution[1] - 2.0 + x).abs() < 1e-6, "{report}");
        assert!(report.solution.len() == 3 && report.certificate.is_none());
    }
}
