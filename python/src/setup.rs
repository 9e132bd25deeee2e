//! What a run is made of, as the package passes it.

use crate::convert;
use crate::errors;
use crate::nonlinear::NonlinearSetup;
use crate::outer::OuterSetup;
use nonsmooth::{BundleTrustConfig, Polyhedron, VariableScaling, Vector};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Function, start, set, settings. The package has checked names and types; sizes and ranges are checked by the engine.
#[derive(Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub struct Setup {
    /// The function; see [`crate::oracle`].
    pub fun: Py<PyAny>,
    /// Whether the subgradient comes from a function of its own, `jac`.
    pub jac_apart: bool,
    /// Whether it takes the keyword `accuracy`.
    pub takes_accuracy: bool,
    /// The outer function, if `fun` returns outputs.
    pub outer: Option<OuterSetup>,
    /// The smooth function that is added, if there is one.
    pub smooth: Option<Py<PyAny>>,
    pub x0: Vec<f64>,
    pub constraints: Constraints,
    /// Nonlinear constraints, if there are any.
    pub nonlinear: Option<NonlinearSetup>,
    /// The fields of [`BundleTrustConfig`] that are set, as JSON, without the scaling.
    pub options: String,
    /// The scaling of the variables: none, sizes, or a matrix.
    pub scaling: Option<Py<PyAny>>,
    /// Called after every evaluation with x, value and record; true ends the run.
    pub callback: Option<Py<PyAny>>,
    /// Whether a table is printed.
    pub disp: bool,
    /// Folder of the journal and identity of the function.
    pub journal: Option<(String, String)>,
}

/// Bounds and rows as arrays.
#[derive(Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub struct Constraints {
    lower: Py<PyAny>,
    upper: Py<PyAny>,
    rows: Py<PyAny>,
    row_lower: Py<PyAny>,
    row_upper: Py<PyAny>,
}

impl Constraints {
    /// Bounds and rows as the engine's set.
    pub fn polyhedron(&self, py: Python<'_>) -> PyResult<Polyhedron> {
        let vector = |object: &Py<PyAny>, what| convert::vector(object.bind(py), what, None);
        let rows = convert::matrix(self.rows.bind(py), "constraint matrix")?;
        let (row_lower, row_upper) = (
            vector(&self.row_lower, "lower sides of the constraints")?,
            vector(&self.row_upper, "upper sides of the constraints")?,
        );
        Polyhedron::boxed(vector(&self.lower, "lower bounds")?, vector(&self.upper, "upper bounds")?)
            .and_then(|set| set.with_rows(&rows, &row_lower, &row_upper))
            .map_err(errors::input)
    }
}

impl Setup {
    /// The settings of the method.
    pub fn config(&self, py: Python<'_>) -> PyResult<BundleTrustConfig> {
        let mut config: BundleTrustConfig =
            serde_json::from_str(&self.options).map_err(|error| PyValueError::new_err(format!("options: {error}")))?;
        if let Some(scaling) = &self.scaling {
            let object = scaling.bind(py);
            config.scaling = match object.getattr("ndim")?.extract::<usize>()? {
                1 => VariableScaling::Typical(convert::vector(object, "scaling", Some(self.x0.len()))?),
                _ => VariableScaling::Linear(convert::matrix(object, "scaling")?),
            };
        }
        config.validate().map_err(errors::input)?;
        Ok(config)
    }

    pub fn start(&self) -> Vector {
        Vector::from_column_slice(&self.x0)
    }
}
