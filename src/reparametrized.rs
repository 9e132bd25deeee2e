//! Linear change of variables: the engine works in coordinates in which the objective is better scaled.
//!
//! ```text
//! α = M β:   Θ̂(β) = Θ(M β),   ∂Θ̂ = Mᵀ ∂Θ,   Û = { β : lower ≤ M β ≤ upper,  row_lower ≤ (A M) β ≤ row_upper }
//! ```
//! A direction in which Θ hardly changes is made short, so that the first subproblems already reach along it.

use crate::{Answer, Evaluation, InputError, Matrix, NonsmoothObjective, OracleError, Polyhedron, Request, Vector};

/// An objective in the coordinates β = M⁻¹ α.
///
/// ```
/// use nonsmooth::{FnObjective, Matrix, NonsmoothObjective, Reparametrized, Request, Vector};
/// let theta = FnObjective::new(1, |x: &Vector| (x[0].abs(), Vector::from_element(1, x[0].signum())));
/// let scaled = Reparametrized::new(theta, Matrix::from_element(1, 1, 10.0))?;
/// let answer = scaled.evaluate(&Request::tight(&Vector::from_element(1, -2.0)))?.into_evaluation();
/// assert_eq!((answer.value, answer.subgradient[0]), (20.0, -10.0));
/// # Ok::<(), nonsmooth::OracleError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Reparametrized<O> {
    inner: O,
    matrix: Matrix,
    inverse: Matrix,
}

impl<O: NonsmoothObjective> Reparametrized<O> {
    /// An objective with a regular square matrix M of its dimension.
    ///
    /// # Errors
    /// [`InputError::Dimension`] on a wrong size, [`InputError::OutOfRange`] for a singular matrix.
    pub fn new(inner: O, matrix: Matrix) -> Result<Self, InputError> {
        let expected = inner.dimension();
        for found in [matrix.nrows(), matrix.ncols()] {
            if found != expected {
                return Err(InputError::Dimension { what: "change of variables", expected, found });
            }
        }
        match matrix.clone().try_inverse() {
            Some(inverse) => Ok(Self { inner, matrix, inverse }),
            None => Err(InputError::OutOfRange {
                setting: "change of variables",
                value: "a singular matrix".into(),
                allowed: "a regular matrix",
            }),
        }
    }

    /// α = M β.
    pub fn original(&self, point: &Vector) -> Vector {
        &self.matrix * point
    }

    /// β = M⁻¹ α.
    pub fn transformed(&self, point: &Vector) -> Vector {
        &self.inverse * point
    }

    /// The set in the coordinates β; bounds become rows.
    ///
    /// # Errors
    /// [`InputError`] if the sizes differ.
    pub fn transformed_set(&self, set: &Polyhedron) -> Result<Polyhedron, InputError> {
        Polyhedron::unbounded(set.dimension()).with_rows(&self.matrix, set.lower(), set.upper())?.with_rows(
            &(set.rows() * &self.matrix),
            set.row_lower(),
            set.row_upper(),
        )
    }
}

impl<O: NonsmoothObjective> NonsmoothObjective for Reparametrized<O> {
    type WarmStart = O::WarmStart;

    fn dimension(&self) -> usize {
        self.inner.dimension()
    }

    fn evaluate(&self, request: &Request<'_, O::WarmStart>) -> Result<Answer<O::WarmStart>, OracleError> {
        let point = self.original(request.point);
        let pull_back = |evaluation: Evaluation<O::WarmStart>| Evaluation {
            subgradient: self.matrix.tr_mul(&evaluation.subgradient),
            ..evaluation
        };
        let request = Request {
            point: &point,
            warm_start: request.warm_start,
            accuracy: request.accuracy,
            descent_target: request.descent_target,
        };
        Ok(match self.inner.evaluate(&request)? {
            Answer::Accurate(evaluation) => Answer::Accurate(pull_back(evaluation)),
            Answer::NoDescent(evaluation) => Answer::NoDescent(pull_back(evaluation)),
        })
    }
}
