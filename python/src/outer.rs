//! Convex functions of the outputs: those of the engine, or a Python function with value and subgradient.

use crate::convert;
use crate::failure::Failure;
use nonsmooth::composite::{
    Epigraph, EuclideanNorm, GroupNorms, Maximum, OuterFunction, PositiveParts, SmoothPlus, SumOfPowers,
};
use nonsmooth::{Matrix, Vector};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

/// An outer function as the package passes it.
#[derive(Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub struct OuterSetup {
    /// A name, or a Python function.
    pub function: Py<PyAny>,
    /// The exponent of `power`.
    pub exponent: f64,
    /// Numbers of outputs in the groups of `norm`; none: a single group.
    pub groups: Option<Vec<usize>>,
    /// Factor of the function where a smooth part is added, whose value is the first output.
    pub weight: Option<f64>,
}

/// The convex function h of Θ = h∘c.
#[derive(Debug)]
pub enum Outer {
    /// A function of the engine.
    Max(Maximum),
    /// A function of the engine.
    Powers(SumOfPowers),
    /// A function of the engine.
    Norm(EuclideanNorm),
    /// A function of the engine.
    Groups(GroupNorms),
    /// A function of the engine.
    Hinge(PositiveParts),
    /// A function of the user.
    Python(PythonOuter),
    /// One of these, added to a smooth part.
    Sum(Box<SmoothPlus<Self>>),
}

/// A Python function c ↦ (h(c), one subgradient).
#[derive(Debug)]
pub struct PythonOuter {
    function: Py<PyAny>,
    failure: Failure,
    /// The last call: the engine asks for value and subgradient one after the other.
    last: Mutex<Option<(Vector, f64, Vector)>>,
}

impl Outer {
    /// The function that the package asks for.
    pub fn new(py: Python<'_>, setup: &OuterSetup, failure: &Failure) -> PyResult<Self> {
        let outer = Self::alone(py, setup, failure)?;
        Ok(match setup.weight {
            Some(weight) => Self::Sum(Box::new(SmoothPlus { weight, outer })),
            None => outer,
        })
    }

    fn alone(py: Python<'_>, setup: &OuterSetup, failure: &Failure) -> PyResult<Self> {
        let Ok(name) = setup.function.extract::<String>(py) else {
            let function = setup.function.clone_ref(py);
            return Ok(Self::Python(PythonOuter { function, failure: failure.clone(), last: Mutex::new(None) }));
        };
        match (name.as_str(), &setup.groups) {
            ("max", _) => Ok(Self::Max(Maximum)),
            ("l1", _) => Ok(Self::Powers(SumOfPowers { exponent: 1.0 })),
            ("power", _) => Ok(Self::Powers(SumOfPowers { exponent: setup.exponent })),
            ("hinge", _) => Ok(Self::Hinge(PositiveParts)),
            ("norm", None) => Ok(Self::Norm(EuclideanNorm)),
            ("norm", Some(sizes)) => Ok(Self::Groups(GroupNorms { sizes: sizes.clone() })),
            _ => Err(PyValueError::new_err(format!("outer = '{name}' is unknown"))),
        }
    }

    /// Refuses numbers of outputs that the function does not take.
    pub fn check(&self, outputs: usize) -> PyResult<()> {
        match self {
            Self::Sum(sum) => sum.outer.check(outputs - 1),
            Self::Groups(GroupNorms { sizes }) if sizes.iter().sum::<usize>() != outputs => Err(PyValueError::new_err(
                format!("fun returns {outputs} outputs, but the groups hold {}", sizes.iter().sum::<usize>()),
            )),
            _ => Ok(()),
        }
    }

    fn inner(&self) -> &dyn OuterFunction {
        match self {
            Self::Max(function) => function,
            Self::Powers(function) => function,
            Self::Norm(function) => function,
            Self::Groups(function) => function,
            Self::Hinge(function) => function,
            Self::Python(function) => function,
            Self::Sum(function) => &**function,
        }
    }
}

impl OuterFunction for Outer {
    fn value(&self, outputs: &Vector) -> f64 {
        self.inner().value(outputs)
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        self.inner().subgradient(outputs)
    }

    fn curvature(&self, outputs: &Vector, jacobian: &Matrix) -> Option<Matrix> {
        self.inner().curvature(outputs, jacobian)
    }

    fn epigraph(&self, outputs: usize) -> Option<Epigraph> {
        self.inner().epigraph(outputs)
    }

    fn is_homogeneous(&self) -> bool {
        self.inner().is_homogeneous()
    }
}

impl PythonOuter {
    fn call(&self, outputs: &Vector) -> PyResult<(f64, Vector)> {
        Python::attach(|py| {
            let answer = self.function.bind(py).call1((convert::array(py, outputs),))?;
            let parts = convert::parts(&answer, "outer", "(value, subgradient)", (2, false))?;
            let value = convert::number(&parts.get_item(0)?, "the value that outer returns")?;
            let subgradient = parts.get_item(1)?;
            let subgradient = convert::vector(&subgradient, "the subgradient that outer returns", Some(outputs.len()))?;
            Ok((value, subgradient))
        })
    }

    /// Value and subgradient; NaN once there is an exception, with which the run ends.
    fn both(&self, outputs: &Vector) -> (f64, Vector) {
        if let Some((at, value, subgradient)) = &*self.last.lock().unwrap_or_else(PoisonError::into_inner)
            && at == outputs
        {
            return (*value, subgradient.clone());
        }
        let none = || (f64::NAN, Vector::from_element(outputs.len(), f64::NAN));
        if self.failure.is_set() {
            return none();
        }
        // The lock is not held while Python runs: another thread may hold the interpreter and wait for the lock.
        match self.call(outputs) {
            Ok((value, subgradient)) => {
                let kept = (outputs.clone(), value, subgradient.clone());
                self.last.lock().unwrap_or_else(PoisonError::into_inner).replace(kept);
                (value, subgradient)
            }
            Err(error) => {
                self.failure.set(error);
                none()
            }
        }
    }
}

impl OuterFunction for PythonOuter {
    fn value(&self, outputs: &Vector) -> f64 {
        self.both(outputs).0
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        self.both(outputs).1
    }
}
