//! The base of the composite model: a point with its outputs and their Jacobian.

use crate::Vector;
use crate::composite::Linearization;

/// Where the model is built.
#[derive(Debug, Clone)]
pub(crate) struct Base {
    pub point: Vector,
    pub value: f64,
    pub linearization: Linearization,
}
