//! What a user implements: state solver, coderivative, cost.
//!
//! ```text
//! Θ(α) = J(α, S(α)),     ξ = ∇₁J(α, y) + D*S(α)(∇₂J(α, y)),     y = S(α)                       method.md (1.1), (1.2)
//! ```

use crate::{Accuracy, ConstraintKind, OracleError, Vector};

/// A parametrised, possibly nonsmooth equilibrium y = S(α); method.md (1.1).
pub trait StateSolver {
    /// The solution at one control with all that its coderivative needs (factors, contact status). May be heavy.
    type State;
    /// Data that restart a solve at a nearby control (multipliers, active sets); `()` if there are none. Should be
    /// light: the engine keeps one per center.
    type WarmStart;

    /// Number of controls d.
    fn control_dimension(&self) -> usize;

    /// S(α) for `control_dimension()` finite controls, to the relative accuracy asked for.
    ///
    /// # Errors
    /// An [`OracleError`] when the control is outside the domain of S or the solver does not converge.
    fn solve(
        &self,
        control: &Vector,
        start: Option<&Self::WarmStart>,
        accuracy: Accuracy,
    ) -> Result<Self::State, OracleError>;

    /// The part of a state that restarts a solve at a nearby control.
    fn warm_start(&self, state: &Self::State) -> Self::WarmStart;

    /// Work that a state and what was derived from it have taken so far, in a unit of the solver's own (products with
    /// its operator, for example); 0 (the default) where none is counted. It goes into the records of a run.
    fn work(&self, _state: &Self::State) -> usize {
        0
    }
}

/// The derivative information of a [`StateSolver`]: one element of its coderivative; method.md (1.2).
pub trait Coderivative: StateSolver {
    /// One element of D*S(α)(y*); `direction` is y*, a dual of the state in the layout that the solver's documentation
    /// states.
    ///
    /// # Errors
    /// An [`OracleError`] when the adjoint system cannot be solved.
    fn coderivative(
        &self,
        control: &Vector,
        state: &Self::State,
        direction: &Vector,
    ) -> Result<Sensitivity, OracleError>;
}

/// An element of the coderivative for a dual y* at an inexact state y, with its error.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// One element of D*S(α)(y*), `control_dimension()` entries.
    pub element: Vector,
    /// Bound or estimate of |⟨y*, y − S(α)⟩|, the error that y causes in a cost with the gradient y*; 0 means exact up
    /// to rounding. An adjoint solver gets it by weighing the residuals of y. Where only ‖y − S(α)‖ is known, it is the
    /// product with the dual norm of y*.
    pub error_bound: f64,
}

impl Sensitivity {
    /// An element at a state that is exact up to rounding.
    pub fn exact(element: Vector) -> Self {
        Self { element, error_bound: 0.0 }
    }
}

/// A continuously differentiable cost J(α, y). A nonsmooth J may return one subgradient in place of the gradient.
pub trait Cost<State: ?Sized> {
    /// J(α, y).
    fn value(&self, control: &Vector, state: &State) -> f64;

    /// (∇₁J, ∇₂J) at (α, y).
    fn gradient(&self, control: &Vector, state: &State) -> CostGradient;

    /// The kinds of the nonlinear constraints c_j(α, y) that go with the cost; none by default.
    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &[]
    }

    /// The constraints at (α, y), one per kind: values with their two partial gradients. Each costs one coderivative.
    fn constraints(&self, _control: &Vector, _state: &State) -> Vec<(f64, CostGradient)> {
        vec![]
    }
}

/// The two partial gradients of a [`Cost`].
#[derive(Debug, Clone)]
pub struct CostGradient {
    /// ∇₁J(α, y), `control_dimension()` entries.
    pub control: Vector,
    /// ∇₂J(α, y), in the layout of the state solver's dual.
    pub state: Vector,
}
