//! The user's Python function as an objective.
//!
//! ```text
//! fun(x) → (value, subgradient)               fun(x, accuracy=τ) → the same, or (value, subgradient, error bound)
//! fun(x) → (outputs, Jacobian)                with an outer function; smooth(x) → (value, gradient) of what is added
//! fun(x) → (…, …, constraints, Jacobian)      with nonlinear constraints of the same call, before the error bound
//! ```
//! `OutsideDomain` and numbers that are not finite shorten the step. All other exceptions end the run and are kept.

use crate::convert;
use crate::errors::OutsideDomain;
use crate::failure::Failure;
use crate::nonlinear::Nonlinear;
use crate::outer::Outer;
use nonsmooth::composite::{Linearization, Linearized, Maximum, OuterFunction, SmoothPlus};
use nonsmooth::{Answer, ConstraintKind, Evaluation, Matrix, NonsmoothObjective, OracleError, Request, Vector};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A Python function with value and subgradient, or with outputs and Jacobian.
#[derive(Debug)]
pub struct PythonOracle {
    /// The user's Python function.
    pub function: Py<PyAny>,
    /// Whether it is made of two functions of the user, `fun` and `jac`.
    pub jac_apart: bool,
    /// A smooth function that is added to that of the outputs.
    pub smooth: Option<Py<PyAny>>,
    pub dimension: usize,
    /// Whether the function takes the keyword `accuracy`.
    pub takes_accuracy: bool,
    /// The convex function of the outputs, if the function returns outputs.
    pub outer: Option<Outer>,
    /// The nonlinear constraints.
    pub nonlinear: Nonlinear,
    /// Where an exception is kept.
    pub failure: Failure,
    /// The first `OutsideDomain`, for a start at which the function is not defined.
    pub outside: Failure,
}

/// An evaluation, or an answer of the right form that the engine takes for a failure.
type Evaluated = Result<Evaluation<()>, OracleError>;

impl PythonOracle {
    fn call<'py>(&self, py: Python<'py>, request: &Request<'_, ()>) -> PyResult<Bound<'py, PyAny>> {
        let x = convert::array(py, request.point);
        let function = self.function.bind(py);
        let answer = if self.takes_accuracy {
            let keywords = PyDict::new(py);
            keywords.set_item(intern!(py, "accuracy"), request.accuracy.tolerance())?;
            function.call((x,), Some(&keywords))
        } else {
            function.call1((x,))
        };
        // A signal that arrived while code without bytecode ran.
        py.check_signals()?;
        answer
    }

    /// The answer of the function; an exception where it has the wrong form.
    fn evaluation(&self, answer: &Bound<'_, PyAny>, request: &Request<'_, ()>) -> PyResult<Evaluated> {
        let constrained = self.nonlinear.returned_by_function();
        let (wanted, count) = match (&self.outer, constrained) {
            (None, false) => ("(value, subgradient)", 2),
            (Some(_), false) => ("(outputs, Jacobian)", 2),
            (None, true) => ("(value, subgradient, constraints, their Jacobian)", 4),
            (Some(_), true) => ("(outputs, Jacobian, constraints, their Jacobian)", 4),
        };
        let parts = convert::parts(answer, "fun", wanted, (count, true))?;
        let (first, second) = (parts.get_item(0)?, parts.get_item(1)?);
        let returned = if constrained { Some((parts.get_item(2)?, parts.get_item(3)?)) } else { None };
        let mut evaluation = match &self.outer {
            None => {
                let value = convert::number(&first, "the value that fun returns")?;
                let source = if self.jac_apart { "jac" } else { "fun" };
                let what = format!("the subgradient that {source} returns");
                let subgradient = convert::vector(&second, &what, Some(self.dimension))?;
                self.plain(value, subgradient, request)
            }
            Some(outer) => match self.composite(outer, (&first, &second), request)? {
                Ok(evaluation) => evaluation,
                failed => return Ok(failed),
            },
        };
        evaluation.constraints = self.nonlinear.evaluation(answer.py(), request.point, returned)?;
        evaluation.error_bound = if parts.len() > count {
            convert::number(&parts.get_item(count)?, "the error bound that fun returns")?
        } else if self.takes_accuracy {
            request.accuracy.tolerance() * evaluation.value.abs()
        } else {
            0.0
        };
        Ok(Ok(evaluation))
    }

    /// Value and subgradient. With nonlinear constraints, the value is an output as well, as in
    /// [`ConstrainedFunction`](nonsmooth::ConstrainedFunction).
    fn plain(&self, value: f64, subgradient: Vector, request: &Request<'_, ()>) -> Evaluation<()> {
        let linearization = match request.linearization {
            Some(_) if !self.nonlinear.kinds.is_empty() => {
                let jacobian = Matrix::from_row_slice(1, subgradient.len(), subgradient.as_slice());
                let outputs = Vector::from_element(1, value);
                Linearized::Known(Linearization { outputs, jacobian, accuracy: 0.0, inactive: None })
            }
            _ => Linearized::NotAsked,
        };
        Evaluation { linearization, ..Evaluation::exact(value, subgradient, ()) }
    }

    fn composite(
        &self,
        outer: &Outer,
        (outputs, jacobian): (&Bound<'_, PyAny>, &Bound<'_, PyAny>),
        request: &Request<'_, ()>,
    ) -> PyResult<Evaluated> {
        let mut outputs = convert::vector(outputs, "the vector of outputs that fun returns", None)?;
        let shape = (outputs.len(), self.dimension);
        let mut jacobian = convert::jacobian(jacobian, "the Jacobian that fun returns", shape, "outputs")?;
        if let Some(smooth) = &self.smooth {
            (outputs, jacobian) = self.with_smooth(smooth, request, (&outputs, &jacobian))?;
        }
        outer.check(outputs.len())?;
        let linearization = Linearization { outputs, jacobian, accuracy: 0.0, inactive: None };
        // Before the outer function receives outputs that are no numbers.
        if let Err(error) = linearization.check(self.dimension) {
            return Ok(Err(error.into()));
        }
        let Linearization { outputs, jacobian, .. } = &linearization;
        let value = outer.value(outputs);
        let subgradient: Vector = jacobian.tr_mul(&outer.subgradient(outputs));
        let linearization = Linearized::if_asked(request.linearization, linearization);
        Ok(Ok(Evaluation { linearization, ..Evaluation::exact(value, subgradient, ()) }))
    }

    /// Outputs and Jacobian with value and gradient of the smooth function on top.
    fn with_smooth(
        &self,
        smooth: &Py<PyAny>,
        request: &Request<'_, ()>,
        others: (&Vector, &Matrix),
    ) -> PyResult<(Vector, Matrix)> {
        Python::attach(|py| {
            let answer = smooth.bind(py).call1((convert::array(py, request.point),))?;
            let parts = convert::parts(&answer, "smooth", "(value, gradient)", (2, false))?;
            let value = convert::number(&parts.get_item(0)?, "the value that smooth returns")?;
            let gradient = parts.get_item(1)?;
            let gradient = convert::vector(&gradient, "the gradient that smooth returns", Some(self.dimension))?;
            Ok(SmoothPlus::stack((value, &gradient), others))
        })
    }

    /// What the engine is told of an exception.
    fn failed(&self, py: Python<'_>, error: PyErr) -> OracleError {
        if error.is_instance_of::<OutsideDomain>(py) {
            let reason = error.value(py).to_string();
            self.outside.set(error);
            return OracleError::OutsideDomain { reason };
        }
        self.failure.set(error);
        OracleError::Interrupted
    }
}

impl NonsmoothObjective for PythonOracle {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        match &self.outer {
            Some(outer) => Some(outer),
            // The largest of a single output is the output itself.
            None if !self.nonlinear.kinds.is_empty() => Some(&Maximum),
            None => None,
        }
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &self.nonlinear.kinds
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        if self.failure.is_set() {
            return Err(OracleError::Interrupted);
        }
        Python::attach(|py| {
            let evaluation = self.call(py, request).and_then(|answer| self.evaluation(&answer, request));
            match evaluation {
                // An outer function that raised has returned no number.
                Ok(_) if self.failure.is_set() => Err(OracleError::Interrupted),
                Ok(evaluation) => evaluation.map(Answer::Accurate),
                Err(error) => Err(self.failed(py, error)),
            }
        })
    }
}
