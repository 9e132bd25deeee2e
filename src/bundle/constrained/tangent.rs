//! Linearizations of constraints.

use crate::Vector;
use crate::qp::kernels::difference_dot;
use std::rc::Rc;

/// A linearization c_j(y) + ⟨h, x − y⟩ of a constraint or of one of its pieces.
#[derive(Debug, Clone)]
pub(crate) struct Tangent {
    /// j.
    pub constraint: usize,
    /// y.
    pub point: Rc<Vector>,
    /// The value at y.
    pub value: f64,
    /// h.
    pub slope: Rc<Vector>,
}

impl Tangent {
    /// The value at a point.
    pub(crate) fn at(&self, x: &Vector) -> f64 {
        self.value + difference_dot(self.slope.as_slice(), x.as_slice(), self.point.as_slice())
    }
}
