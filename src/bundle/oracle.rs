//! The one place where the user's code is called: panics, wrong sizes and numbers that are not finite become errors.

use crate::linalg::first_non_finite;
use crate::panics::evaluate_without_panic;
use crate::{Answer, NonsmoothObjective, OracleError, Request};

/// Numbers beyond this cannot be squared.
const LARGEST: f64 = 1e150;

/// What an evaluation can end with.
pub(crate) enum Outcome<W> {
    Answer(Answer<W>),
    /// Θ = −∞.
    MinusInfinity,
    Failure(OracleError),
}

/// Evaluates the objective; never panics.
pub(crate) fn evaluate<O: NonsmoothObjective>(
    objective: &O,
    request: &Request<'_, O::WarmStart>,
) -> Outcome<O::WarmStart> {
    match evaluate_without_panic(objective, request) {
        Ok(answer) => check(answer, request),
        Err(error) => Outcome::Failure(error),
    }
}

fn check<W>(answer: Answer<W>, request: &Request<'_, W>) -> Outcome<W> {
    let evaluation = answer.evaluation();
    let (expected, found) = (request.point.len(), evaluation.subgradient.len());
    if expected != found {
        return Outcome::Failure(crate::InputError::Dimension { what: "subgradient", expected, found }.into());
    }
    if evaluation.value == f64::NEG_INFINITY {
        return Outcome::MinusInfinity;
    }
    if let Some(Ok(linearization)) = &evaluation.linearization
        && let Err(error) = linearization.check(expected)
    {
        return Outcome::Failure(error.into());
    }
    let finite = |what, finite: bool| if finite { None } else { Some(OracleError::NotFinite { what }) };
    let failure = finite("value", evaluation.value.is_finite())
        .or_else(|| finite("subgradient", first_non_finite(evaluation.subgradient.as_slice()).is_none()))
        .or_else(|| finite("error bound", evaluation.error_bound.is_finite()));
    let small = |what, size: f64| (size > LARGEST).then_some(OracleError::TooLarge { what, size, allowed: LARGEST });
    let failure = failure
        .or_else(|| small("value", evaluation.value.abs()))
        .or_else(|| small("subgradient", evaluation.subgradient.amax()));
    match failure {
        Some(error) => Outcome::Failure(error),
        None => Outcome::Answer(answer),
    }
}
