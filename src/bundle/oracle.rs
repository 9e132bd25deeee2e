//! The one place where the user's code is called: panics, wrong sizes and numbers that are not finite become errors.

use crate::linalg::first_non_finite;
use crate::{Answer, NonsmoothObjective, OracleError, Request};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

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
    // The state behind `&objective` may be torn after a panic; the engine only calls it again, it never reads it.
    match catch_unwind(AssertUnwindSafe(|| objective.evaluate(request))) {
        Ok(Ok(answer)) => check(answer, request),
        Ok(Err(error)) => Outcome::Failure(error),
        Err(payload) => Outcome::Failure(OracleError::Panicked { message: panic_text(payload.as_ref()) }),
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
    let finite = |what, finite: bool| if finite { None } else { Some(OracleError::NotFinite { what }) };
    let failure = finite("value", evaluation.value.is_finite())
        .or_else(|| finite("subgradient", first_non_finite(evaluation.subgradient.as_slice()).is_none()))
        .or_else(|| finite("error bound", evaluation.error_bound.is_finite()));
    match failure {
        Some(error) => Outcome::Failure(error),
        None => Outcome::Answer(answer),
    }
}

fn panic_text(payload: &(dyn Any + Send)) -> String {
    payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a payload that is not text".to_owned())
}
