//! For the tests alone: the collection of test problems, and the same runs by the engine in Rust.

use crate::convert;
use crate::outcome::RunOutcome;
use crate::setup::Setup;
use nonsmooth::{BundleTrust, FnObjective, Vector};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use testset::Problem;

/// One problem of the collection.
#[pyclass(frozen, module = "nonsmooth._engine")]
pub struct CollectionProblem(Problem);

#[pymethods]
impl CollectionProblem {
    /// The problem of a name.
    #[new]
    fn new(name: &str) -> PyResult<Self> {
        testset::find(name).map(Self).ok_or_else(|| PyKeyError::new_err(name.to_owned()))
    }

    /// Names of all problems.
    #[staticmethod]
    fn names() -> Vec<String> {
        testset::all().into_iter().map(|problem| problem.name).collect()
    }

    /// Value and one subgradient.
    fn __call__<'py>(&self, py: Python<'py>, x: &Bound<'py, PyAny>) -> PyResult<(f64, Bound<'py, PyArray1<f64>>)> {
        let x = convert::vector(x, "x", Some(self.0.dimension))?;
        let (value, gradient) = self.0.evaluate(x.as_slice());
        Ok((value, PyArray1::from_vec(py, gradient)))
    }

    /// Published start.
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.0.start)
    }

    /// Published optimal value.
    #[getter]
    fn optimal_value(&self) -> f64 {
        self.0.optimal_value
    }

    /// Whether the function is convex.
    #[getter]
    fn convex(&self) -> bool {
        self.0.convex
    }

    /// Lower and upper bounds.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray1<f64>>; 2] {
        [PyArray1::from_slice(py, &self.0.lower), PyArray1::from_slice(py, &self.0.upper)]
    }

    /// Rows and their sides.
    #[getter]
    #[allow(clippy::type_complexity, reason = "three arrays")]
    fn rows<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
        let (rows, n) = (&self.0.rows, self.0.dimension);
        let matrix = convert::array2(py, rows.len(), n, |i, j| rows[i][j])?;
        Ok((matrix, PyArray1::from_slice(py, &self.0.row_lower), PyArray1::from_slice(py, &self.0.row_upper)))
    }

    /// The run that the package makes of this setup, without Python: the function is that of the collection.
    fn minimize(&self, py: Python<'_>, setup: Setup) -> PyResult<RunOutcome> {
        let (config, set, start) = (setup.config(py)?, setup.constraints.polyhedron(py)?, setup.start());
        let theta = FnObjective::new(self.0.dimension, |x: &Vector| {
            let (value, gradient) = self.0.evaluate(x.as_slice());
            (value, Vector::from_vec(gradient))
        });
        let report = BundleTrust::new(config)
            .map_err(crate::errors::input)?
            .constraints(set.clone())
            .minimize(&theta, start)
            .map_err(crate::errors::optimize)?;
        Ok(RunOutcome { report, set, subgradient: None })
    }
}
