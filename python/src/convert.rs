//! From Python objects to numbers, vectors and matrices, and back: arrays and JSON.

use nonsmooth::{Matrix, Vector};
use numpy::{
    Element, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods, ToPyArray,
};
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::type_object::PyTypeCheck;
use pyo3::types::{PyList, PyTuple};

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

/// A new numpy array of the entries in row-major order.
pub fn shaped<'py, T: Element>(
    py: Python<'py>,
    entries: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    PyArray1::from_vec(py, entries).reshape(shape)
}

/// A vector of `expected` entries from anything that numpy makes a one-dimensional array of real numbers of. Where one
/// entry is expected, a number is one.
pub fn vector(object: &Bound<'_, PyAny>, what: &str, expected: Option<usize>) -> PyResult<Vector> {
    let form = "a one-dimensional array of real numbers";
    let entries = match object.cast::<PyArray1<f64>>() {
        Ok(array) => array.try_readonly()?.as_array().to_vec(),
        Err(_) => {
            let shape = (expected == Some(1)).then_some(&[-1][..]);
            real::<PyArray1<f64>>(object, what, form, shape)?.try_readonly()?.as_array().to_vec()
        }
    };
    match expected {
        Some(expected) if expected != entries.len() => {
            Err(PyValueError::new_err(format!("{what} has {} entries, expected {expected}", entries.len())))
        }
        _ => Ok(Vector::from_vec(entries)),
    }
}

/// A matrix from anything that numpy makes a two-dimensional array of real numbers of, or from a sparse matrix.
pub fn matrix(object: &Bound<'_, PyAny>, what: &str) -> PyResult<Matrix> {
    shaped_matrix(object, what, None)
}

/// As [`matrix`], of a shape; where there is one row or one column, its entries alone are enough. `rows` says what the
/// rows belong to.
pub fn jacobian(object: &Bound<'_, PyAny>, what: &str, shape: (usize, usize), rows: &str) -> PyResult<Matrix> {
    let single = match shape {
        (_, 1) => Some(&[-1, 1][..]),
        (1, _) => Some(&[1, -1][..]),
        _ => None,
    };
    let matrix = shaped_matrix(object, what, single)?;
    if matrix.shape() == shape {
        return Ok(matrix);
    }
    let found = matrix.shape();
    Err(PyValueError::new_err(format!("{what} has shape {found:?}, expected {shape:?} ({rows}, variables)")))
}

fn shaped_matrix(object: &Bound<'_, PyAny>, what: &str, shape: Option<&[i32]>) -> PyResult<Matrix> {
    let dense = if object.hasattr("toarray")? { object.call_method0("toarray")? } else { object.clone() };
    let form = "a two-dimensional array of real numbers";
    let array = real::<PyArray2<f64>>(&dense, what, form, shape)?.try_readonly()?;
    let view = array.as_array();
    Ok(Matrix::from_row_iterator(view.nrows(), view.ncols(), view.iter().copied()))
}

/// A real number, also as an array of one entry, which scipy's methods take too.
pub fn number(object: &Bound<'_, PyAny>, what: &str) -> PyResult<f64> {
    let is_array = object.cast::<PyUntypedArray>().is_ok_and(|array| array.len() == 1);
    let number = if is_array { object.call_method0(intern!(object.py(), "item"))? } else { object.clone() };
    number.extract().map_err(|error| refused(Some(error), object, what, "a real number"))
}

/// An array of doubles of an object. Complex numbers, whose imaginary parts numpy would drop with no more than a
/// warning, texts and dates are refused. An array of fewer dimensions is given the shape, if there is one.
fn real<'py, A: PyTypeCheck>(
    object: &Bound<'py, PyAny>,
    what: &str,
    form: &str,
    shape: Option<&[i32]>,
) -> PyResult<Bound<'py, A>> {
    let numpy = object.py().import(intern!(object.py(), "numpy"))?;
    let refuse = |error| refused(Some(error), object, what, form);
    let array = numpy.call_method1("asarray", (object,)).map_err(refuse)?;
    let kind: char = array.getattr("dtype")?.getattr("kind")?.extract()?;
    // Booleans, integers, floats, and Python objects, which may be numbers.
    if !"biufO".contains(kind) {
        return Err(refused(None, object, what, form));
    }
    let mut array = numpy.call_method1("asarray", (array, "float64")).map_err(refuse)?;
    if let Some(shape) = shape
        && array.getattr("ndim")?.extract::<usize>()? < shape.len()
    {
        array = array.call_method1("reshape", (shape.to_vec(),))?;
    }
    array.cast_into().map_err(|_| refused(None, object, what, form))
}

/// What is said of an object that has no numbers of this form. What the object itself raised while it was converted, an
/// interrupt or a failed computation for example, comes back unchanged.
fn refused(error: Option<PyErr>, object: &Bound<'_, PyAny>, what: &str, form: &str) -> PyErr {
    let py = object.py();
    if let Some(error) = &error {
        let of_form = error.is_instance_of::<PyTypeError>(py) || error.is_instance_of::<PyValueError>(py);
        // PyTorch raises this for tensors that carry a gradient; its text names the remedy.
        let is_attached = error.is_instance_of::<PyRuntimeError>(py) && error.to_string().contains("detach()");
        if !of_form && !is_attached {
            return error.clone_ref(py);
        }
    }
    let kind = object.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    let shape = object.getattr("shape").map_or_else(|_| String::new(), |shape| format!(" of shape {shape}"));
    let dtype = object.getattr("dtype").map_or_else(|_| String::new(), |dtype| format!(" of {dtype}"));
    let refusal = PyTypeError::new_err(format!("{what} is {kind}{shape}{dtype}, expected {form}"));
    refusal.set_cause(py, error);
    refusal
}

/// The parts of what a function returns, `count` of them, as a tuple or a list; with one more an error bound, where
/// there `may_be_bound` one.
pub fn parts<'py>(
    answer: &Bound<'py, PyAny>,
    function: &str,
    wanted: &str,
    (count, may_be_bound): (usize, bool),
) -> PyResult<Bound<'py, PyTuple>> {
    let kind = || answer.get_type().name();
    let tuple = match (answer.cast::<PyTuple>(), answer.cast::<PyList>()) {
        (Ok(tuple), _) => Some(tuple.clone()),
        (_, Ok(list)) => Some(list.to_tuple()),
        _ => None,
    };
    let found = match tuple {
        Some(tuple) if tuple.len() == count || (tuple.len() == count + 1 && may_be_bound) => return Ok(tuple),
        Some(tuple) => format!("a {} of {}", kind()?, tuple.len()),
        None => kind()?.to_string(),
    };
    let more = if may_be_bound {
        ", and may add an error bound; if it returns the value alone, pass its subgradient as jac"
    } else {
        ""
    };
    Err(PyTypeError::new_err(format!("{function} must return {wanted}{more}; it returned {found}")))
}

/// JSON of plain data.
pub fn json<T: serde::Serialize>(data: &T) -> PyResult<String> {
    serde_json::to_string(data).map_err(|error| PyValueError::new_err(error.to_string()))
}
