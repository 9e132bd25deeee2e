//! Errors of the engine as Python exceptions.

use nonsmooth::verify::VerifyError;
use nonsmooth::{InputError, JournalError, OptimizeError};
use pyo3::PyErr;
use pyo3::create_exception;
#[cfg(feature = "contact")]
use pyo3::exceptions::PyRuntimeError;
use pyo3::exceptions::{PyException, PyValueError};

create_exception!(
    nonsmooth,
    OutsideDomain,
    PyException,
    "The point lies outside the domain of the function; the step is shortened."
);
create_exception!(nonsmooth, InfeasibleError, PyValueError, "Bounds and constraints contradict each other.");

/// Input that cannot be worked with: `ValueError`.
pub fn input(error: InputError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A run that could not begin; an exception of the user's function comes before this one.
pub fn optimize(error: OptimizeError) -> PyErr {
    match error {
        OptimizeError::Infeasible { .. } => InfeasibleError::new_err(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// A journal that cannot be continued: `OSError` of the kind `PermissionError` for example where the system refuses,
/// else `ValueError`.
pub fn journal(error: JournalError) -> PyErr {
    match &error {
        JournalError::File { source, .. } => std::io::Error::new(source.kind(), error.to_string()).into(),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// A Taylor test without a result.
pub fn verify(error: VerifyError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Bad input, or a computation that failed.
#[cfg(feature = "contact")]
pub fn failed(error: problems::commands::Failure) -> PyErr {
    match error {
        problems::commands::Failure::Input(words) => PyValueError::new_err(words),
        error => PyRuntimeError::new_err(error.to_string()),
    }
}
