//! Outputs with their generalized Jacobian, as an oracle returns them when it is asked to.

use crate::checks::{check_finite, check_size};
use crate::{Accuracy, InputError, Matrix, Vector};

/// The request for outputs and Jacobian of a composite objective, besides value and subgradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearizationRequest {
    /// Relative accuracy of the Jacobian.
    pub accuracy: Accuracy,
    /// The Jacobian is wanted only where Θ is at most this, in units of Θ; ∞ means everywhere.
    pub below: f64,
}

/// Relative accuracy that the engine asks of a Jacobian: a model of first order needs no more.
const JACOBIAN_ACCURACY: f64 = 1e-4;

impl LinearizationRequest {
    /// The request of the engine, for points where Θ is at most the value given.
    pub(crate) fn below(below: f64) -> Self {
        let accuracy = Accuracy::relative(JACOBIAN_ACCURACY).unwrap_or(Accuracy::TIGHTEST);
        Self { accuracy, below }
    }
}

/// Outputs c(x) and one element G of their generalized Jacobian; m outputs, n variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearization {
    /// c(x), m entries; m is the same at all points.
    pub outputs: Vector,
    /// G, m × n.
    pub jacobian: Matrix,
    /// Relative error of the columns of G; 0 means exact up to rounding.
    pub accuracy: f64,
    /// Constraints inside the outputs that are inactive here, if the problem has any.
    pub inactive: Option<InactiveConstraints>,
}

/// Slacks of constraints that change the piece of c when they become active: gaps of open contact nodes, for example.
/// The engine uses them once it has found a stationary point, to look at the neighbouring piece.
#[derive(Debug, Clone, PartialEq)]
pub struct InactiveConstraints {
    /// Slacks s > 0, k entries, each in a unit of its own.
    pub slacks: Vector,
    /// Derivative S of the slacks with respect to the variables, k × n.
    pub jacobian: Matrix,
}

/// Outputs and Jacobian in an answer.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Linearized {
    /// Nothing: the request did not ask for them, or asked only where Θ is lower.
    #[default]
    NotAsked,
    /// Outputs and Jacobian are known.
    Known(Linearization),
    /// The reason why they cannot be had, which costs the run nothing but its composite model.
    Unavailable(String),
}

impl Linearized {
    /// The answer of an oracle that has outputs and Jacobian at hand: they are known if the request asked for them.
    pub fn if_asked(request: Option<LinearizationRequest>, linearization: Linearization) -> Self {
        if request.is_some() { Self::Known(linearization) } else { Self::NotAsked }
    }

    /// Outputs and Jacobian, if they are known.
    pub fn known(&self) -> Option<&Linearization> {
        match self {
            Self::Known(linearization) => Some(linearization),
            Self::NotAsked | Self::Unavailable(_) => None,
        }
    }
}

impl Linearization {
    /// Refuses sizes that do not fit `dimension` variables, and entries that are not finite.
    ///
    /// # Errors
    /// [`InputError::Dimension`], [`InputError::NotFinite`].
    pub fn check(&self, dimension: usize) -> Result<(), InputError> {
        check_size("rows of the Jacobian", self.outputs.len(), self.jacobian.nrows())?;
        check_size("columns of the Jacobian", dimension, self.jacobian.ncols())?;
        check_finite("outputs", self.outputs.as_slice())?;
        check_finite("Jacobian", self.jacobian.as_slice())?;
        let Some(inactive) = &self.inactive else { return Ok(()) };
        check_size("rows of the slacks' Jacobian", inactive.slacks.len(), inactive.jacobian.nrows())?;
        check_size("columns of the slacks' Jacobian", dimension, inactive.jacobian.ncols())?;
        check_finite("slacks", inactive.slacks.as_slice())?;
        check_finite("Jacobian of the slacks", inactive.jacobian.as_slice())
    }

    /// Changes G by a matrix of rank one so that Gᵀw, for weights w of m entries, equals a subgradient of n entries
    /// that is known to be more accurate. G stays where w = 0.
    pub fn correct(&mut self, weights: &Vector, subgradient: &Vector) {
        let size = weights.norm_squared();
        if size > 0.0 && size.is_finite() {
            let defect = subgradient - self.jacobian.tr_mul(weights);
            self.jacobian.ger(1.0 / size, weights, &defect, 1.0);
        }
    }
}
