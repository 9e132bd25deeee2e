//! Closures that return nonlinear constraints with the objective.

use crate::composite::{Linearization, Linearized, OuterFunction};
use crate::{
    Answer, ConstraintEvaluation, ConstraintKind, Evaluation, Matrix, NonsmoothObjective, OracleError, Request, Vector,
};

/// The identity of a single output: an objective that is an output itself.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Identity;

impl OuterFunction for Identity {
    fn value(&self, outputs: &Vector) -> f64 {
        outputs[0]
    }

    fn subgradient(&self, _outputs: &Vector) -> Vector {
        Vector::from_element(1, 1.0)
    }

    fn is_homogeneous(&self) -> bool {
        true
    }
}

/// A closure `x ↦ (Θ(x), one subgradient, constraints)` as an objective with nonlinear constraints.
#[derive(Debug, Clone)]
pub struct ConstrainedFunction<F> {
    dimension: usize,
    kinds: Vec<ConstraintKind>,
    function: F,
}

impl<F: Fn(&Vector) -> (f64, Vector, ConstraintEvaluation)> ConstrainedFunction<F> {
    /// An objective of `dimension` variables with one constraint per kind.
    pub fn new(dimension: usize, kinds: Vec<ConstraintKind>, function: F) -> Self {
        Self { dimension, kinds, function }
    }
}

impl<F: Fn(&Vector) -> (f64, Vector, ConstraintEvaluation)> NonsmoothObjective for ConstrainedFunction<F> {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        Some(&Identity)
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &self.kinds
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let (value, subgradient, constraints) = (self.function)(request.point);
        let jacobian = Matrix::from_row_slice(1, subgradient.len(), subgradient.as_slice());
        let outputs = Vector::from_element(1, value);
        let linearization = Linearization { outputs, jacobian, accuracy: 0.0, inactive: None };
        let linearization = Linearized::if_asked(request.linearization, linearization);
        let exact = Evaluation::exact(value, subgradient, ());
        Ok(Answer::Accurate(Evaluation { linearization, constraints: Some(constraints), ..exact }))
    }
}
