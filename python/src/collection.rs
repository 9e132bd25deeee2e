//! For the tests alone: the collection of test problems, and the same runs by the engine in Rust.

use crate::convert;
use crate::outcome::RunOutcome;
use crate::setup::Setup;
use nonsmooth::{
    BundleTrust, ConstrainedFunction, ConstraintEvaluation, ConstraintKind, FnObjective, Matrix, NonsmoothObjective,
    Vector,
};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use testset::Problem;
use testset::constrained::{self, Kind};

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
        let theta = FnObjective::new(self.0.dimension, |x: &Vector| {
            let (value, gradient) = self.0.evaluate(x.as_slice());
            (value, Vector::from_vec(gradient))
        });
        run(py, &setup, &theta)
    }
}

/// The run of a setup with a function of the collection.
fn run(py: Python<'_>, setup: &Setup, theta: &impl NonsmoothObjective) -> PyResult<RunOutcome> {
    let set = setup.constraints.polyhedron(py)?;
    let report = BundleTrust::new(setup.config(py)?)
        .map_err(crate::errors::input)?
        .constraints(set.clone())
        .minimize(theta, setup.start())
        .map_err(crate::errors::optimize)?;
    Ok(RunOutcome { report, set, subgradient: None, runs: vec![] })
}

/// One problem of the collection with nonlinear constraints.
#[pyclass(frozen, module = "nonsmooth._engine")]
pub struct ConstrainedProblem(constrained::ConstrainedProblem);

/// Value, subgradient, values of the constraints and their Jacobian as Python objects.
type Answer<'py> = (f64, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);

impl ConstrainedProblem {
    fn evaluate(&self, x: &Vector) -> (f64, Vector, ConstraintEvaluation) {
        let found = self.0.evaluate(x.as_slice());
        let (values, rows): (Vec<f64>, Vec<Vec<f64>>) = found.constraints.into_iter().unzip();
        let jacobian = Matrix::from_row_slice(rows.len(), self.0.dimension, &rows.concat());
        let constraints = ConstraintEvaluation::new(Vector::from_vec(values), jacobian);
        (found.value, Vector::from_vec(found.subgradient), constraints)
    }
}

#[pymethods]
impl ConstrainedProblem {
    /// The problem of a name.
    #[new]
    fn new(name: &str) -> PyResult<Self> {
        constrained::find(name).map(Self).ok_or_else(|| PyKeyError::new_err(name.to_owned()))
    }

    /// Names of all problems.
    #[staticmethod]
    fn names() -> Vec<String> {
        constrained::all().into_iter().map(|problem| problem.name).collect()
    }

    fn __call__<'py>(&self, py: Python<'py>, x: &Bound<'py, PyAny>) -> PyResult<Answer<'py>> {
        let (value, subgradient, found) = self.evaluate(&convert::vector(x, "x", Some(self.0.dimension))?);
        let (rows, columns) = found.jacobian.shape();
        let jacobian = convert::array2(py, rows, columns, |i, j| found.jacobian[(i, j)])?;
        Ok((value, convert::array(py, &subgradient), convert::array(py, &found.values), jacobian))
    }

    /// Kinds of the constraints, as `minimize` takes them.
    #[getter]
    fn kinds(&self) -> Vec<&'static str> {
        let name = |kind: &Kind| match kind {
            Kind::Nonsmooth => "nonsmooth",
            Kind::Smooth => "smooth",
            Kind::SmoothEquality => "equality",
        };
        self.0.kinds.iter().map(name).collect()
    }

    /// Published start.
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.0.start)
    }

    /// Optimal value, and values of other local minima.
    #[getter]
    fn optima(&self) -> Vec<f64> {
        [&[self.0.optimum][..], &self.0.other_optima].concat()
    }

    /// Lower and upper bounds.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray1<f64>>; 2] {
        [PyArray1::from_slice(py, &self.0.lower), PyArray1::from_slice(py, &self.0.upper)]
    }

    /// As for the problems without nonlinear constraints.
    fn minimize(&self, py: Python<'_>, setup: Setup) -> PyResult<RunOutcome> {
        let kind = |kind: &Kind| match kind {
            Kind::Nonsmooth => ConstraintKind::Nonsmooth,
            Kind::Smooth => ConstraintKind::Smooth,
            Kind::SmoothEquality => ConstraintKind::SmoothEquality,
        };
        let kinds = self.0.kinds.iter().map(kind).collect();
        run(py, &setup, &ConstrainedFunction::new(self.0.dimension, kinds, |x: &Vector| self.evaluate(x)))
    }
}
