//! The call of the user's code: a panic becomes an error.

use crate::{Answer, NonsmoothObjective, OracleError, Request};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Evaluates an objective; a panic becomes [`OracleError::Panicked`].
pub(crate) fn evaluate_without_panic<O: NonsmoothObjective>(
    objective: &O,
    request: &Request<'_, O::WarmStart>,
) -> Result<Answer<O::WarmStart>, OracleError> {
    without_panic(|| objective.evaluate(request)).unwrap_or_else(|message| Err(OracleError::Panicked { message }))
}

/// Calls a function of the user; the text of its panic if it panics.
pub(crate) fn without_panic<T>(function: impl FnOnce() -> T) -> Result<T, String> {
    // What the function holds may be torn after a panic; it is only called again, never read.
    catch_unwind(AssertUnwindSafe(function)).map_err(|payload| text(payload.as_ref()))
}

fn text(payload: &(dyn Any + Send)) -> String {
    payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a payload that is not text".to_owned())
}
