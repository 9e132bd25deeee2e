//! What the engine sees: Θ and one Clarke subgradient, as request and answer.
//!
//! ```text
//! request: point, warm start, accuracy, descent target   →   accurate | certified no descent | failed with reason
//! ```

use crate::composite::{LinearizationRequest, Linearized, OuterFunction};
use crate::{Accuracy, ConstraintEvaluation, ConstraintKind, OracleError, Vector};

/// One question to a [`NonsmoothObjective`].
#[derive(Debug)]
pub struct Request<'a, W> {
    /// Where to evaluate; `dimension()` finite entries.
    pub point: &'a Vector,
    /// Warm start of an earlier answer, usually that of the stability center.
    pub warm_start: Option<&'a W>,
    /// Relative accuracy that the value must have.
    pub accuracy: Accuracy,
    /// The value below which the point would be a serious step. An oracle that can prove Θ(point) > target before its
    /// value is accurate may stop and answer [`Answer::NoDescent`].
    pub descent_target: Option<f64>,
    /// Outputs and Jacobian of a composite objective, where they are wanted.
    pub linearization: Option<LinearizationRequest>,
}

impl<'a, W> Request<'a, W> {
    /// A request for the tightest accuracy, without a warm start and without a target.
    pub fn tight(point: &'a Vector) -> Self {
        Self { point, warm_start: None, accuracy: Accuracy::TIGHTEST, descent_target: None, linearization: None }
    }
}

/// Value and one subgradient at a point.
#[derive(Debug, Clone)]
pub struct Evaluation<W> {
    /// Θ(point) up to `error_bound`; in an [`Answer::NoDescent`] a certified lower bound of Θ(point).
    pub value: f64,
    /// One element of the Clarke subdifferential, `dimension()` entries, as accurate relatively as the value.
    pub subgradient: Vector,
    /// Bound or estimate of |value − Θ(point)| in units of Θ; 0 means exact up to rounding. The engine does not use it
    /// in an [`Answer::NoDescent`], whose cut is certified to hold.
    pub error_bound: f64,
    /// Warm start for evaluations at nearby points.
    pub warm_start: W,
    /// Outputs and Jacobian of a composite objective, or why there are none.
    pub linearization: Linearized,
    /// Values and subgradients of the nonlinear constraints; none for an objective without any.
    pub constraints: Option<ConstraintEvaluation>,
    /// Work that the evaluation took, in a unit of the oracle's own; 0 where none is counted. It goes into the records
    /// of a run.
    pub work: usize,
}

impl<W> Evaluation<W> {
    /// A value and a subgradient that are exact up to rounding.
    pub fn exact(value: f64, subgradient: Vector, warm_start: W) -> Self {
        Self {
            value,
            subgradient,
            error_bound: 0.0,
            warm_start,
            linearization: Linearized::NotAsked,
            constraints: None,
            work: 0,
        }
    }
}

/// The answer of a [`NonsmoothObjective`].
#[derive(Debug, Clone)]
pub enum Answer<W> {
    /// Value and subgradient with the accuracy that was asked for (or the best the oracle has; see `error_bound`).
    Accurate(Evaluation<W>),
    /// Θ(point) is certified to lie above the descent target: `value` is a lower bound above the target and
    /// `value + subgradientᵀ(· − point)` is a valid cut. Enough for a null step, never accepted as a new center.
    NoDescent(Evaluation<W>),
}

impl<W> Answer<W> {
    /// The evaluation, whatever its kind.
    pub fn evaluation(&self) -> &Evaluation<W> {
        match self {
            Self::Accurate(evaluation) | Self::NoDescent(evaluation) => evaluation,
        }
    }

    /// The evaluation, whatever its kind.
    pub fn into_evaluation(self) -> Evaluation<W> {
        match self {
            Self::Accurate(evaluation) | Self::NoDescent(evaluation) => evaluation,
        }
    }
}

/// A locally Lipschitz function that returns its value and one Clarke subgradient at a point.
pub trait NonsmoothObjective {
    /// Data that restart an evaluation at a nearby point (multipliers, active sets); `()` if there are none.
    type WarmStart;

    /// Number of variables.
    fn dimension(&self) -> usize;

    /// The convex function h of a composite objective Θ = h∘c; none (the default) for all others.
    fn outer(&self) -> Option<&dyn OuterFunction> {
        None
    }

    /// The kinds of the nonlinear constraints, one per constraint; none (the default) for an objective without any.
    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &[]
    }

    /// Θ and one subgradient at `request.point`, with the values and subgradients of the constraints.
    ///
    /// # Errors
    /// An [`OracleError`] when there is no answer; the engine then shortens its step.
    fn evaluate(&self, request: &Request<'_, Self::WarmStart>) -> Result<Answer<Self::WarmStart>, OracleError>;
}

impl<O: NonsmoothObjective + ?Sized> NonsmoothObjective for &O {
    type WarmStart = O::WarmStart;

    fn dimension(&self) -> usize {
        (**self).dimension()
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        (**self).outer()
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        (**self).constraint_kinds()
    }

    fn evaluate(&self, request: &Request<'_, Self::WarmStart>) -> Result<Answer<Self::WarmStart>, OracleError> {
        (**self).evaluate(request)
    }
}

/// What a closure behind [`FnObjective`] may return: the pair (Θ(x), one subgradient), or a `Result` of it with any
/// error that fits into a box, text included.
pub trait FnAnswer {
    /// The pair, or why there is none.
    ///
    /// # Errors
    /// The closure's own error, as an [`OracleError`].
    fn into_pair(self) -> Result<(f64, Vector), OracleError>;
}

impl FnAnswer for (f64, Vector) {
    fn into_pair(self) -> Result<(f64, Vector), OracleError> {
        Ok(self)
    }
}

impl<E: Into<Box<dyn std::error::Error + Send + Sync>>> FnAnswer for Result<(f64, Vector), E> {
    fn into_pair(self) -> Result<(f64, Vector), OracleError> {
        self.map_err(|error| match error.into().downcast::<OracleError>() {
            Ok(own) => *own,
            Err(other) => OracleError::Failed(other),
        })
    }
}

/// A closure `x ↦ (Θ(x), one subgradient)` as an objective. A closure that may fail returns a `Result` of the pair; a
/// failure shortens the step.
///
/// ```
/// use nonsmooth::{FnObjective, NonsmoothObjective, Request, Vector};
/// let theta = FnObjective::new(1, |x: &Vector| (x[0].abs(), Vector::from_element(1, x[0].signum())));
/// let answer = theta.evaluate(&Request::tight(&Vector::from_element(1, -2.0))).unwrap();
/// assert_eq!(answer.evaluation().value, 2.0);
/// assert_eq!(answer.evaluation().subgradient[0], -1.0);
///
/// let guarded = FnObjective::new(1, |x: &Vector| {
///     if x[0] > 0.0 { Ok((-x[0].ln(), Vector::from_element(1, -1.0 / x[0]))) } else { Err(format!("ln of {}", x[0])) }
/// });
/// let error = guarded.evaluate(&Request::tight(&Vector::from_element(1, -2.0))).unwrap_err();
/// assert_eq!(error.to_string(), "ln of -2");
/// ```
#[derive(Debug, Clone)]
pub struct FnObjective<F> {
    dimension: usize,
    function: F,
}

impl<F: Fn(&Vector) -> A, A: FnAnswer> FnObjective<F> {
    /// An objective of `dimension` variables.
    pub fn new(dimension: usize, function: F) -> Self {
        Self { dimension, function }
    }
}

impl<F: Fn(&Vector) -> A, A: FnAnswer> NonsmoothObjective for FnObjective<F> {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let (value, subgradient) = (self.function)(request.point).into_pair()?;
        Ok(Answer::Accurate(Evaluation::exact(value, subgradient, ())))
    }
}
