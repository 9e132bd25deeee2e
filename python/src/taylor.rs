//! The Taylor test of a Python function.

use crate::convert;
use crate::convert::json;
use crate::errors;
use crate::failure::Failure;
use crate::nonlinear::Nonlinear;
use crate::oracle::PythonOracle;
use nonsmooth::verify::{Direction, STEPS};
use pyo3::prelude::*;

/// Compares a function near x with its subgradient along a direction; the numbers as JSON, and the table.
#[pyfunction]
pub fn taylor_test(
    py: Python<'_>,
    fun: Py<PyAny>,
    x: &Bound<'_, PyAny>,
    direction: Option<&Bound<'_, PyAny>>,
    seed: u64,
    takes_accuracy: bool,
    jac_apart: bool,
) -> PyResult<(String, String)> {
    let x = convert::vector(x, "x", None)?;
    let direction = match direction {
        Some(direction) => Direction::Given(convert::vector(direction, "direction", Some(x.len()))?),
        None => Direction::Seeded(seed),
    };
    let failure = Failure::default();
    let oracle = PythonOracle {
        function: fun,
        jac_apart,
        smooth: None,
        dimension: x.len(),
        takes_accuracy,
        outer: None,
        nonlinear: Nonlinear::default(),
        failure: failure.clone(),
        outside: Failure::default(),
    };
    let (result, outside) = py.detach(|| {
        let result = nonsmooth::verify::taylor_test(&oracle, &x, &direction, &STEPS);
        (result, oracle.outside.take())
    });
    match (result, failure.take().or(outside)) {
        (Ok(test), None) => Ok((json(&test)?, test.to_string())),
        (_, Some(error)) => Err(error),
        (Err(error), None) => Err(errors::verify(error)),
    }
}
