//! A sum of the absolute values of affine functions with a quadratic term, and its answer.

use super::interior_point::ScaledSide;
use crate::{Matrix, Vector};

/// The data, in units in which they are of order one.
pub(crate) struct Program<'a> {
    /// c, m entries.
    pub outputs: &'a Vector,
    /// The rows g_i, m × n.
    pub jacobian: &'a Matrix,
    /// H, n × n.
    pub quadratic: &'a Matrix,
    /// p, n entries.
    pub linear: &'a Vector,
    /// Sides of the constraints, equalities first.
    pub sides: &'a [ScaledSide],
    pub equalities: usize,
}

/// A minimizer with its multipliers, or an iterate near them.
pub(crate) struct PrimalDual {
    pub x: Vector,
    /// The weights of the outputs, in [−1, 1] up to rounding.
    pub weights: Vector,
    /// One multiplier per side.
    pub multipliers: Vec<f64>,
}
