//! The one place where the user's objective is called: panics, wrong sizes and numbers that are not finite become
//! errors. Nothing else in the engine depends on the type of the objective, so that the engine is compiled once, not
//! once per objective.

use super::norm::ScaledNorm;
use crate::checks::check_size;
use crate::linalg::first_non_finite;
use crate::panics::evaluate_without_panic;
use crate::{Answer, Evaluation, InputError, NonsmoothObjective, OracleError, Request};

/// Numbers beyond this are refused, because sums of their squares could overflow.
const LARGEST: f64 = 1e150;

/// The outcome of an evaluation.
pub(super) enum OracleResult {
    Answer(Box<Answer<()>>),
    /// Θ = −∞.
    MinusInfinity,
    Failure(OracleError),
}

/// An objective that remembers the warm start of the center.
pub(super) trait Oracle {
    /// Evaluates the objective with the warm start that is kept.
    fn answer(&mut self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError>;

    /// Keeps the warm start of the last answer.
    fn keep_warm_start(&mut self);
}

/// The objective of a user as an [`Oracle`].
pub(super) struct WarmStarted<'r, O: NonsmoothObjective> {
    objective: &'r O,
    kept: Option<O::WarmStart>,
    last: Option<O::WarmStart>,
    /// Number of outputs of a composite objective, once it is known.
    outputs: Option<usize>,
}

impl<'r, O: NonsmoothObjective> WarmStarted<'r, O> {
    pub(super) fn new(objective: &'r O) -> Self {
        Self { objective, kept: None, last: None, outputs: None }
    }
}

impl<O: NonsmoothObjective> Oracle for WarmStarted<'_, O> {
    fn answer(&mut self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        self.last = None;
        let &Request { point, accuracy, descent_target, linearization, .. } = request;
        let warm_start = self.kept.as_ref();
        let request = Request { point, warm_start, accuracy, descent_target, linearization };
        let mut without = |evaluation: Evaluation<O::WarmStart>| {
            let Evaluation { value, subgradient, error_bound, warm_start, linearization, constraints, work } =
                evaluation;
            self.last = Some(warm_start);
            Evaluation { value, subgradient, error_bound, warm_start: (), linearization, constraints, work }
        };
        let answer = match evaluate_without_panic(self.objective, &request)? {
            Answer::Accurate(evaluation) => Answer::Accurate(without(evaluation)),
            Answer::NoDescent(evaluation) => Answer::NoDescent(without(evaluation)),
        };
        if let Some(linearization) = answer.evaluation().linearization.known() {
            let found = linearization.outputs.len();
            let expected = *self.outputs.get_or_insert(found);
            check_size("the vector of outputs", expected, found).map_err(OracleError::Contradiction)?;
        }
        Ok(answer)
    }

    fn keep_warm_start(&mut self) {
        self.kept = self.last.take();
    }
}

/// Evaluates the objective; never panics. `longest` is the largest ‖g‖* that can be held beside the subgradients known,
/// with the norm in which it is measured; none as long as none is known.
pub(super) fn evaluate(
    oracle: &mut dyn Oracle,
    request: &Request<'_, ()>,
    constraints: usize,
    longest: Option<(f64, &ScaledNorm)>,
) -> OracleResult {
    match oracle.answer(request) {
        Ok(answer) => match (check(answer, request.point.len(), constraints), longest) {
            (OracleResult::Answer(answer), Some((allowed, norm))) => {
                let size = norm.dual_length(&answer.evaluation().subgradient);
                if size <= allowed {
                    OracleResult::Answer(answer)
                } else {
                    OracleResult::Failure(OracleError::TooLarge { what: "subgradient", size, allowed })
                }
            }
            (outcome, _) => outcome,
        },
        Err(error) => OracleResult::Failure(error),
    }
}

fn negative(error_bound: f64) -> InputError {
    InputError::OutOfRange { setting: "error bound", value: error_bound.to_string(), allowed: "≥ 0" }
}

fn check(answer: Answer<()>, expected: usize, constraints: usize) -> OracleResult {
    let evaluation = answer.evaluation();
    let found = evaluation.subgradient.len();
    if expected != found {
        return OracleResult::Failure(InputError::Dimension { what: "subgradient", expected, found }.into());
    }
    if evaluation.value == f64::NEG_INFINITY {
        return OracleResult::MinusInfinity;
    }
    if let Some(linearization) = evaluation.linearization.known()
        && let Err(error) = linearization.check(expected)
    {
        return OracleResult::Failure(error.into());
    }
    if let Some(found) = &evaluation.constraints
        && let Err(error) = check_size("the vector of constraints", constraints, found.values.len())
    {
        return OracleResult::Failure(OracleError::Contradiction(error));
    }
    let failure = match &evaluation.constraints {
        Some(found) => found.check(expected).err(),
        None if constraints > 0 && matches!(answer, Answer::Accurate(_)) => {
            Some(InputError::Dimension { what: "the vector of constraints", expected: constraints, found: 0 })
        }
        None => None,
    };
    if let Some(error) = failure {
        return OracleResult::Failure(error.into());
    }
    let finite = |what, finite: bool| if finite { None } else { Some(OracleError::NotFinite { what }) };
    let failure = finite("value", evaluation.value.is_finite())
        .or_else(|| finite("subgradient", first_non_finite(evaluation.subgradient.as_slice()).is_none()))
        .or_else(|| finite("error bound", evaluation.error_bound.is_finite()))
        .or_else(|| (evaluation.error_bound < 0.0).then(|| negative(evaluation.error_bound).into()));
    let small = |what, size: f64| (size > LARGEST).then_some(OracleError::TooLarge { what, size, allowed: LARGEST });
    let failure = failure
        .or_else(|| small("value", evaluation.value.abs()))
        .or_else(|| small("subgradient", evaluation.subgradient.amax()));
    match failure {
        Some(error) => OracleResult::Failure(error),
        None => OracleResult::Answer(Box::new(answer)),
    }
}
