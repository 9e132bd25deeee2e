//! The certificate of a run as a Python object: its arrays, its check, its pickled form.

use crate::convert::{self, json};
use crate::errors;
use crate::failure::Failure;
use crate::outer::{Outer, OuterSetup};
use nonsmooth::{Cut, Polyhedron};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// How stationary the solution is, with all that is needed to compute that again.
///
/// Attributes are the quantities of the last subproblem: cuts with their multipliers, multipliers of the rows and of
/// the bounds, and norm and error of the aggregate subgradient.
#[pyclass(frozen, module = "nonsmooth._engine")]
#[derive(Debug)]
pub struct Certificate {
    /// Certificate as the engine returns it.
    pub certificate: nonsmooth::Certificate,
    /// The set that it refers to.
    pub set: Polyhedron,
}

impl Certificate {
    fn of_cuts<'py>(&self, py: Python<'py>, entry: impl Fn(&Cut) -> f64) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.certificate.cuts.iter().map(entry).collect())
    }
}

#[pymethods]
impl Certificate {
    /// The certificate from its pickled form.
    #[new]
    fn new(certificate: &str, set: &str) -> PyResult<Self> {
        let bad = |error: serde_json::Error| PyValueError::new_err(format!("not a certificate: {error}"));
        Ok(Self {
            certificate: serde_json::from_str(certificate).map_err(bad)?,
            set: serde_json::from_str(set).map_err(bad)?,
        })
    }

    fn __getnewargs__(&self) -> PyResult<(String, String)> {
        Ok((json(&self.certificate)?, json(&self.set)?))
    }

    /// The point that the certificate is about.
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        convert::array(py, &self.certificate.point)
    }

    /// Value of the function at the point.
    #[getter]
    fn fun(&self) -> f64 {
        self.certificate.value
    }

    /// Norm of the aggregate subgradient, constraints included, in the dual of the run's norm.
    #[getter]
    fn aggregate_norm(&self) -> f64 {
        self.certificate.aggregate_norm
    }

    /// Error of the aggregate subgradient, in units of the function.
    #[getter]
    fn aggregate_error(&self) -> f64 {
        self.certificate.aggregate_error
    }

    /// Decrease that the model still predicts, in units of the function.
    #[getter]
    fn predicted_decrease(&self) -> f64 {
        self.certificate.predicted_decrease
    }

    /// Curvature that was added to make the model convex; 0 if the function looks convex.
    #[getter]
    fn convexification(&self) -> f64 {
        self.certificate.convexification
    }

    /// Largest distance of an active cut from the point, in the run's norm.
    #[getter]
    fn active_radius(&self) -> f64 {
        self.certificate.active_radius
    }

    /// Noise of the values, promised or seen, in units of the function.
    #[getter]
    fn noise(&self) -> f64 {
        self.certificate.noise
    }

    /// Points of the cuts, one per row.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let cuts = &self.certificate.cuts;
        convert::array2(py, cuts.len(), self.certificate.point.len(), |i, j| cuts[i].point[j])
    }

    /// Values of the cuts.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.of_cuts(py, |cut| cut.value)
    }

    /// Subgradients of the cuts, one per row.
    #[getter]
    fn subgradients<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let cuts = &self.certificate.cuts;
        convert::array2(py, cuts.len(), self.certificate.point.len(), |i, j| cuts[i].subgradient[j])
    }

    /// Multipliers of the cuts, ≥ 0, with sum 1.
    #[getter]
    fn multipliers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.of_cuts(py, |cut| cut.multiplier)
    }

    /// Multipliers of the rows of the constraints, > 0 at the upper and < 0 at the lower side.
    #[getter]
    fn row_multipliers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        convert::array(py, &self.certificate.row_multipliers)
    }

    /// Multipliers of the bounds, signed likewise.
    #[getter]
    fn bound_multipliers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        convert::array(py, &self.certificate.bound_multipliers)
    }

    /// Computes norm and error again from cuts, multipliers and set alone; as JSON.
    fn recheck(&self) -> PyResult<String> {
        json(&self.certificate.recheck(&self.set).map_err(errors::input)?)
    }

    /// Computes the cuts of a composite certificate again from outputs, Jacobian and outer function; the largest
    /// relative difference, or none if the certificate has no such proof.
    fn recheck_composite(&self, py: Python<'_>, outer: OuterSetup) -> PyResult<Option<f64>> {
        let Some(proof) = &self.certificate.composite else { return Ok(None) };
        let failure = Failure::default();
        let outer = Outer::new(py, &outer, &failure)?;
        let check = proof.recheck(&self.certificate, &outer).map_err(errors::input)?;
        failure.take().map_or_else(|| Ok(Some(check.largest())), Err)
    }

    fn __str__(&self) -> String {
        self.certificate.to_string()
    }

    fn __repr__(&self) -> String {
        format!("<Certificate: {}>", self.certificate)
    }
}
