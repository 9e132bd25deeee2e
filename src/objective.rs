//! What the engine sees: Θ and one Clarke subgradient, as request and answer.
//!
//! ```text
//! request: point, warm start, accuracy, descent target   →   accurate | certified no descent | failed with reason
//! ```

use crate::{Accuracy, OracleError, Vector};

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
}

impl<'a, W> Request<'a, W> {
    /// A request for the tightest accuracy, without a warm start and without a target.
    pub fn tight(point: &'a Vector) -> Self {
        Self { point, warm_start: None, accuracy: Accuracy::TIGHTEST, descent_target: None }
    }
}

/// Value and one subgradient at a point.
#[derive(Debug, Clone)]
pub struct Evaluation<W> {
    /// Θ(point) up to `error_bound`; in an [`Answer::NoDescent`] a certified lower bound of Θ(point).
    pub value: f64,
    /// One element of the Clarke subdifferential, `dimension()` entries, as accurate relatively as the value.
    pub subgradient: Vector,
    /// Bound or estimate of |value − Θ(point)| in units of Θ; 0 means exact up to rounding. The engine does not use it in
    /// an [`Answer::NoDescent`], whose cut is certified to hold.
    pub error_bound: f64,
    /// Warm start for evaluations at nearby points.
    pub warm_start: W,
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

    /// Θ and one subgradient at `request.point`.
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

    fn evaluate(&self, request: &Request<'_, Self::WarmStart>) -> Result<Answer<Self::WarmStart>, OracleError> {
        (**self).evaluate(request)
    }
}

/// A closure `x ↦ (Θ(x), one subgradient)` as an objective.
///
/// ```
/// use nonsmooth::{FnObjective, NonsmoothObjective, Request, Vector};
/// let theta = FnObjective::new(1, |x: &Vector| (x[0].abs(), Vector::from_element(1, x[0].signum())));
/// let answer = theta.evaluate(&Request::tight(&Vector::from_element(1, -2.0))).unwrap();
/// assert_eq!(answer.evaluation().value, 2.0);
/// assert_eq!(answer.evaluation().subgradient[0], -1.0);
/// ```
#[derive(Debug, Clone)]
pub struct FnObjective<F> {
    dimension: usize,
    function: F,
}

impl<F: Fn(&Vector) -> (f64, Vector)> FnObjective<F> {
    /// An objective of `dimension` variables.
    pub fn new(dimension: usize, function: F) -> Self {
        Self { dimension, function }
    }
}

impl<F: Fn(&Vector) -> (f64, Vector)> NonsmoothObjective for FnObjective<F> {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let (value, subgradient) = (self.function)(request.point);
        Ok(Answer::Accurate(Evaluation { value, subgradient, error_bound: 0.0, warm_start: () }))
    }
}
