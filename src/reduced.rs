//! Θ = J∘(I, S) and its subgradient by the chain rule; method.md (1.1), (1.2).

use crate::checks::check_size;
use crate::linalg::first_non_finite;
use crate::{
    Answer, Coderivative, ConstraintEvaluation, ConstraintKind, Cost, CostGradient, Evaluation, Matrix,
    NonsmoothObjective, OracleError, Request, Sensitivity, Vector,
};

/// The objective Θ(α) = J(α, S(α)) of a state solver with coderivative and a cost.
#[derive(Debug, Clone)]
pub struct ReducedObjective<S, J> {
    solver: S,
    cost: J,
}

impl<S, J> ReducedObjective<S, J> {
    /// Composes a state solver and a cost.
    pub fn new(solver: S, cost: J) -> Self {
        Self { solver, cost }
    }

    /// The state solver S.
    pub fn solver(&self) -> &S {
        &self.solver
    }

    /// The cost J.
    pub fn cost(&self) -> &J {
        &self.cost
    }
}

impl<S: Coderivative, J: Cost<S::State>> ReducedObjective<S, J> {
    /// Θ and one subgradient at a state already found.
    ///
    /// # Errors
    /// Whatever the coderivative reports, and [`OracleError::NotFinite`].
    pub fn differentiate(&self, control: &Vector, state: &S::State) -> Result<Evaluation<S::WarmStart>, OracleError> {
        let value = self.cost.value(control, state);
        chain_rule(&self.solver, control, state, value, || self.cost.gradient(control, state))
    }

    /// The constraints that go with the cost, by the chain rule.
    fn constraints(&self, control: &Vector, state: &S::State) -> Result<Option<ConstraintEvaluation>, OracleError> {
        if self.cost.constraint_kinds().is_empty() {
            return Ok(None);
        }
        let found = self.cost.constraints(control, state);
        let mut jacobian = Matrix::zeros(found.len(), control.len());
        for (row, (_, gradient)) in found.iter().enumerate() {
            let element = self.solver.coderivative(control, state, &gradient.state)?.element;
            jacobian.set_row(row, &(&gradient.control + element).transpose());
        }
        let values = Vector::from_iterator(found.len(), found.iter().map(|(value, _)| *value));
        Ok(Some(ConstraintEvaluation::new(values, jacobian)))
    }
}

impl<S: Coderivative, J: Cost<S::State>> NonsmoothObjective for ReducedObjective<S, J> {
    type WarmStart = S::WarmStart;

    fn dimension(&self) -> usize {
        self.solver.control_dimension()
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        self.cost.constraint_kinds()
    }

    fn evaluate(&self, request: &Request<'_, S::WarmStart>) -> Result<Answer<S::WarmStart>, OracleError> {
        evaluate(&self.solver, request, |state| {
            let constraints = self.constraints(request.point, state)?;
            Ok(Evaluation { constraints, ..self.differentiate(request.point, state)? })
        })
    }
}

/// The path of every objective with a state: solve, differentiate the state found, count the work of both.
pub(crate) fn evaluate<S: Coderivative>(
    solver: &S,
    request: &Request<'_, S::WarmStart>,
    differentiate: impl FnOnce(&S::State) -> Result<Evaluation<S::WarmStart>, OracleError>,
) -> Result<Answer<S::WarmStart>, OracleError> {
    check_size("control", solver.control_dimension(), request.point.len())?;
    let state = solver.solve(request.point, request.warm_start, request.accuracy)?;
    let evaluation = differentiate(&state)?;
    Ok(Answer::Accurate(Evaluation { work: solver.work(&state), ..evaluation }))
}

/// Θ with the subgradient ξ = ∇₁J + D*S(∇₂J), method.md (1.2). The gradient is asked for where the value is finite.
pub(crate) fn chain_rule<S: Coderivative>(
    solver: &S,
    control: &Vector,
    state: &S::State,
    value: f64,
    gradient: impl FnOnce() -> CostGradient,
) -> Result<Evaluation<S::WarmStart>, OracleError> {
    if !value.is_finite() {
        return Err(OracleError::NotFinite { what: "value" });
    }
    let gradient = gradient();
    let Sensitivity { element, error_bound } = solver.coderivative(control, state, &gradient.state)?;
    let subgradient = gradient.control + element;
    if first_non_finite(subgradient.as_slice()).is_some() {
        return Err(OracleError::NotFinite { what: "subgradient" });
    }
    Ok(Evaluation { error_bound, ..Evaluation::exact(value, subgradient, solver.warm_start(state)) })
}
