//! Nonlinear constraints: those that the function returns with its value, and those of functions of their own.
//!
//! ```text
//! fun(x) → (value, subgradient, values of the constraints, their Jacobian)          apart(x) → (values, Jacobian)
//! ```

use crate::convert;
use nonsmooth::{ConstraintEvaluation, ConstraintKind, Matrix, Vector};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Nonlinear constraints as the package passes them.
#[derive(Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub struct NonlinearSetup {
    /// JSON of the kinds: first those that the function returns, then those apart.
    kinds: String,
    /// Number of constraints that the function returns.
    returned: usize,
    /// A function x ↦ (values, Jacobian) of the other constraints.
    apart: Option<Py<PyAny>>,
}

/// The nonlinear constraints of a Python function.
#[derive(Debug, Default)]
pub struct Nonlinear {
    pub kinds: Vec<ConstraintKind>,
    returned: usize,
    apart: Option<Py<PyAny>>,
}

impl NonlinearSetup {
    pub fn constraints(&self, py: Python<'_>) -> PyResult<Nonlinear> {
        let unknown = |error| PyValueError::new_err(format!("kinds of constraints: {error}"));
        let apart = self.apart.as_ref().map(|function| function.clone_ref(py));
        Ok(Nonlinear { kinds: serde_json::from_str(&self.kinds).map_err(unknown)?, returned: self.returned, apart })
    }
}

impl Nonlinear {
    /// Whether the function returns constraints.
    pub fn returned_by_function(&self) -> bool {
        self.returned > 0
    }

    /// All constraints at a point; `returned` are the values and the Jacobian that the function has returned.
    pub fn evaluation(
        &self,
        py: Python<'_>,
        point: &Vector,
        returned: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>,
    ) -> PyResult<Option<ConstraintEvaluation>> {
        let n = point.len();
        let mut values = Vec::with_capacity(self.kinds.len());
        let mut jacobian = Matrix::zeros(self.kinds.len(), n);
        let mut add = |count: usize, (own, rows): (&Bound<'_, PyAny>, &Bound<'_, PyAny>)| {
            let own = convert::vector(own, "the vector of constraints that fun returns", Some(count))?;
            let what = "the Jacobian of the constraints that fun returns";
            let rows = convert::jacobian(rows, what, (count, n), "constraints")?;
            jacobian.rows_mut(values.len(), count).copy_from(&rows);
            values.extend(own.iter());
            PyResult::Ok(())
        };
        if let Some((own, rows)) = &returned {
            add(self.returned, (own, rows))?;
        }
        if let Some(apart) = &self.apart {
            let answer = apart.bind(py).call1((convert::array(py, point),))?;
            let parts = convert::parts(&answer, "a constraint", "(values, Jacobian)", (2, false))?;
            add(self.kinds.len() - self.returned, (&parts.get_item(0)?, &parts.get_item(1)?))?;
        }
        let any = !self.kinds.is_empty();
        Ok(any.then(|| ConstraintEvaluation::new(Vector::from_vec(values), jacobian)))
    }
}
