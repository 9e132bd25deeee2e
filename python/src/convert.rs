//! Numbers, vectors and matrices of Python objects.

use nonsmooth::{Matrix, Vector};
use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArrayLike1, PyArrayLike2, PyArrayMethods, ToPyArray};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// A new numpy array of the entries.
pub fn array<'py>(py: Python<'py>, vector: &Vector) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, vector.as_slice())
}

/// A new numpy array of shape rows × columns.
pub fn array2<'py>(
    py: Python<'py>,
    rows: usize,
    columns: usize,
    at: impl Fn(usize, usize) -> f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect();
    flat.to_pyarray(py).reshape([rows, columns])
}

/// A vector of `expected` entries from anything that numpy makes a one-dimensional array of numbers of.
pub fn vector(object: &Bound<'_, PyAny>, what: &str, expected: Option<usize>) -> PyResult<Vector> {
    let entries = match object.cast::<PyArray1<f64>>() {
        Ok(array) => array.try_readonly()?.as_array().to_vec(),
        Err(_) => {
            let array: PyArrayLike1<'_, f64, AllowTypeChange> =
                object.extract().map_err(|_| not_numbers(object, what, "a one-dimensional array"))?;
            array.as_array().to_vec()
        }
    };
    match expected {
        Some(expected) if expected != entries.len() => {
            Err(PyValueError::new_err(format!("{what} has {} entries, expected {expected}", entries.len())))
        }
        _ => Ok(Vector::from_vec(entries)),
    }
}

/// A matrix from anything that numpy makes a two-dimensional array of numbers of, or from a sparse matrix.
pub fn matrix(object: &Bound<'_, PyAny>, what: &str) -> PyResult<Matrix> {
    let dense = if object.hasattr("toarray")? { object.call_method0("toarray")? } else { object.clone() };
    let array: PyArrayLike2<'_, f64, AllowTypeChange> =
        dense.extract().map_err(|_| not_numbers(object, what, "a two-dimensional array"))?;
    let view = array.as_array();
    Ok(Matrix::from_row_iterator(view.nrows(), view.ncols(), view.iter().copied()))
}

/// A number.
pub fn number(object: &Bound<'_, PyAny>, what: &str) -> PyResult<f64> {
    object.extract().map_err(|_| not_numbers(object, what, "a number"))
}

fn not_numbers(object: &Bound<'_, PyAny>, what: &str, expected: &str) -> PyErr {
    let kind = object.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    let shape = object.getattr("shape").map_or_else(|_| String::new(), |shape| format!(" of shape {shape}"));
    PyTypeError::new_err(format!("{what} is {kind}{shape}, expected {expected} of real numbers"))
}
