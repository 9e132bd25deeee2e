//! Composite objectives as oracles: a closure for outputs and Jacobian, or outputs of a state.

use crate::checks::check_finite;
use crate::composite::{Linearization, Linearized, OuterFunction};
use crate::reduced::{chain_rule, evaluate};
use crate::{
    Accuracy, Answer, Coderivative, ConstraintEvaluation, ConstraintKind, CostGradient, Evaluation, Matrix,
    NonsmoothObjective, OracleError, Request, Vector,
};
use std::convert::Infallible;

/// Θ = h∘c with a closure `x ↦ (c(x), G)`.
///
/// ```
/// use nonsmooth::{BundleTrust, BundleTrustConfig, CompositeFunction, Matrix, Vector, composite::Maximum};
/// // Minimax: max(x⁴ + y², (2 − x)² + (2 − y)², 2 e^{y − x}), all pieces at once.
/// let theta = CompositeFunction::new(2, Maximum, |p: &Vector| {
///     let (x, y) = (p[0], p[1]);
///     let e = 2.0 * (y - x).exp();
///     let outputs = Vector::from_vec(vec![x.powi(4) + y * y, (2.0 - x).powi(2) + (2.0 - y).powi(2), e]);
///     let rows = [4.0 * x.powi(3), 2.0 * y, 2.0 * x - 4.0, 2.0 * y - 4.0, -e, e];
///     (outputs, Matrix::from_row_slice(3, 2, &rows))
/// });
/// let report = BundleTrust::new(BundleTrustConfig::default())?.minimize(&theta, Vector::from_vec(vec![2.0, 2.0]))?;
/// assert!((report.value - 2.0).abs() < 1e-6);
/// assert!(report.termination.is_confirmed() && report.counts.evaluations < 12, "{report}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct CompositeFunction<H, F> {
    dimension: usize,
    outer: H,
    function: F,
}

impl<H: OuterFunction, F: Fn(&Vector) -> (Vector, Matrix)> CompositeFunction<H, F> {
    /// An objective of `dimension` variables; the closure returns m outputs, always as many, and their m × `dimension`
    /// Jacobian.
    pub fn new(dimension: usize, outer: H, function: F) -> Self {
        Self { dimension, outer, function }
    }
}

impl<H: OuterFunction, F: Fn(&Vector) -> (Vector, Matrix)> NonsmoothObjective for CompositeFunction<H, F> {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        Some(&self.outer)
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        self.outer.constraint_kinds()
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let (outputs, jacobian) = (self.function)(request.point);
        let linearization = Linearization { outputs, jacobian, accuracy: 0.0, inactive: None };
        linearization.check(self.dimension)?;
        let value = self.outer.value(&linearization.outputs);
        let subgradient = linearization.jacobian.tr_mul(&self.outer.subgradient(&linearization.outputs));
        let constraints = of_outputs(&self.outer, &linearization);
        let linearization = Linearized::if_asked(request.linearization, linearization);
        let evaluation = Evaluation { linearization, constraints, ..Evaluation::exact(value, subgradient, ()) };
        Ok(Answer::Accurate(evaluation))
    }
}

/// The constraints that go with an outer function, at outputs with their Jacobian.
fn of_outputs(outer: &dyn OuterFunction, known: &Linearization) -> Option<ConstraintEvaluation> {
    let Linearization { outputs, jacobian, .. } = known;
    let count = outer.constraint_kinds().len();
    let gradient = |weights: &Vector| Ok::<_, Infallible>(jacobian.tr_mul(weights));
    let found = |pieces: &[_]| {
        let Ok(found) = ConstraintEvaluation::of_pieces(count, jacobian.ncols(), pieces, gradient, true);
        found
    };
    (count > 0).then(|| found(&outer.constraint_pieces(outputs)))
}

/// The outputs c of a state problem that a convex cost is a function of, with their generalized Jacobian. Their number
/// does not depend on the state.
pub trait OutputJacobian: Coderivative {
    /// c(S(α)), m entries.
    fn outputs(&self, state: &Self::State) -> Vector;

    /// The derivatives of w·c: by the state, y* = (∂c/∂y)ᵀ w in the layout of the solver's dual, what the coderivative
    /// is asked for; and by the control at a fixed state, where outputs depend on it, else 0.
    fn output_dual(&self, control: &Vector, state: &Self::State, weights: &Vector) -> CostGradient;

    /// Outputs and G, to a relative accuracy of its columns. The default takes one coderivative per output, which is
    /// exact and right for few outputs; a solver that has forward derivatives should use them where there are fewer
    /// controls.
    ///
    /// # Errors
    /// [`OracleError`] when a linearized problem cannot be solved.
    fn linearize(
        &self,
        control: &Vector,
        state: &Self::State,
        _accuracy: Accuracy,
    ) -> Result<Linearization, OracleError> {
        let outputs = self.outputs(state);
        let mut jacobian = Matrix::zeros(outputs.len(), control.len());
        for row in 0..outputs.len() {
            let unit = Vector::from_fn(outputs.len(), |i, _| f64::from(u8::from(i == row)));
            let dual = self.output_dual(control, state, &unit);
            let sensitivity = self.coderivative(control, state, &dual.state)?;
            jacobian.set_row(row, &(dual.control + sensitivity.element).transpose());
        }
        Ok(Linearization { outputs, jacobian, accuracy: 0.0, inactive: None })
    }
}

/// Θ(α) = h(c(S(α))) of outputs c of a state and a convex function h of them, the cost.
#[derive(Debug, Clone)]
pub struct CompositeObjective<S, H> {
    solver: S,
    cost: H,
}

impl<S, H> CompositeObjective<S, H> {
    /// Composes a state solver with outputs and a cost of these outputs.
    pub fn new(solver: S, cost: H) -> Self {
        Self { solver, cost }
    }

    /// The state solver S.
    pub fn solver(&self) -> &S {
        &self.solver
    }

    /// The cost h.
    pub fn cost(&self) -> &H {
        &self.cost
    }
}

impl<S: OutputJacobian, H: OuterFunction> CompositeObjective<S, H> {
    /// Θ = h(c) at a state already found.
    pub fn value(&self, state: &S::State) -> f64 {
        self.cost.value(&self.solver.outputs(state))
    }

    /// The derivatives of w·c with w ∈ ∂h(c), at a state already found: by the control, and y* = (∂c/∂y)ᵀ w, what the
    /// coderivative is asked for.
    pub fn cost_gradient(&self, control: &Vector, state: &S::State) -> CostGradient {
        self.solver.output_dual(control, state, &self.cost.subgradient(&self.solver.outputs(state)))
    }

    /// Θ and one subgradient at a state already found.
    ///
    /// # Errors
    /// Whatever the coderivative reports, [`OracleError::NotFinite`], and [`OracleError::Input`] for outputs that are
    /// not finite.
    pub fn differentiate(&self, control: &Vector, state: &S::State) -> Result<Evaluation<S::WarmStart>, OracleError> {
        check_finite("outputs", self.solver.outputs(state).as_slice())?;
        chain_rule(&self.solver, control, state, self.value(state), || self.cost_gradient(control, state))
    }

    /// What [`evaluate`](NonsmoothObjective::evaluate) answers at a state already found for the point of the request,
    /// without its work: for objectives that add something of the state to it.
    ///
    /// # Errors
    /// As [`differentiate`](Self::differentiate).
    pub fn evaluate_at(
        &self,
        request: &Request<'_, S::WarmStart>,
        state: &S::State,
    ) -> Result<Evaluation<S::WarmStart>, OracleError> {
        let mut evaluation = self.differentiate(request.point, state)?;
        if let Some(wanted) = request.linearization.filter(|wanted| evaluation.value <= wanted.below) {
            evaluation.linearization = self.linearize(request.point, state, &evaluation.subgradient, wanted.accuracy);
        }
        evaluation.constraints = match evaluation.linearization.known() {
            Some(known) => of_outputs(&self.cost, known),
            None => self.constraints(request.point, state)?,
        };
        Ok(evaluation)
    }

    /// The constraints at a state whose Jacobian is not known, by one coderivative for each.
    fn constraints(&self, control: &Vector, state: &S::State) -> Result<Option<ConstraintEvaluation>, OracleError> {
        let count = self.cost.constraint_kinds().len();
        if count == 0 {
            return Ok(None);
        }
        let pieces = self.cost.constraint_pieces(&self.solver.outputs(state));
        let gradient = |weights: &Vector| {
            let dual = self.solver.output_dual(control, state, weights);
            Ok(dual.control + self.solver.coderivative(control, state, &dual.state)?.element)
        };
        ConstraintEvaluation::of_pieces(count, control.len(), &pieces, gradient, false).map(Some)
    }

    /// Outputs and G at a state, G corrected so that Gᵀw is the subgradient ξ.
    fn linearize(&self, control: &Vector, state: &S::State, subgradient: &Vector, accuracy: Accuracy) -> Linearized {
        match self.solver.linearize(control, state, accuracy) {
            Ok(mut linearization) => {
                let weights = self.cost.subgradient(&linearization.outputs);
                linearization.correct(&weights, subgradient);
                Linearized::Known(linearization)
            }
            Err(error) => Linearized::Unavailable(error.to_string()),
        }
    }
}

impl<S: OutputJacobian, H: OuterFunction> NonsmoothObjective for CompositeObjective<S, H> {
    type WarmStart = S::WarmStart;

    fn dimension(&self) -> usize {
        self.solver.control_dimension()
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        Some(&self.cost)
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        self.cost.constraint_kinds()
    }

    fn evaluate(&self, request: &Request<'_, S::WarmStart>) -> Result<Answer<S::WarmStart>, OracleError> {
        evaluate(&self.solver, request, |state| self.evaluate_at(request, state))
    }
}
