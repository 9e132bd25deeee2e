//! What a contact solver is doing, told as `tracing` events: a log or a status line follows them, and without a
//! listener they cost nothing. These are also the places where a state that nobody waits for any more is given up. Of
//! several processes that work on one state, none may be watched: one that gives up leaves the others waiting.

use crate::error::ContactError;
use nonsmooth::interruption::interrupted;
use std::fmt;

/// Target of the events: entering a stage has the level debug, a step of an iteration the level trace.
pub const TARGET: &str = "contact::stage";

/// A stage of a state or of its subgradient, in the order in which they come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Rigid body analysis of the scene.
    Equilibrium,
    /// Assembly and factorisation of subdomains or bodies.
    Factorization,
    /// The coarse space of the dual operator.
    CoarseSpace,
    /// The iteration for the contact forces.
    Contact,
    /// The recovery of displacements and certificates from the forces.
    Recovery,
    /// The solution of the adjoint system.
    Adjoint,
    /// The element sums of the shape derivative.
    ShapeDerivative,
}

impl Stage {
    /// Says that the stage begins.
    ///
    /// # Errors
    /// [`ContactError::Interrupted`].
    pub fn enter(self) -> Result<(), ContactError> {
        tracing::debug!(target: TARGET, stage = %self);
        still_wanted()
    }

    /// Says how far its iteration has come: steps so far, relative residual.
    ///
    /// # Errors
    /// [`ContactError::Interrupted`].
    pub fn reached(self, steps: usize, residual: f64) -> Result<(), ContactError> {
        tracing::trace!(target: TARGET, stage = %self, steps, residual);
        still_wanted()
    }
}

fn still_wanted() -> Result<(), ContactError> {
    if interrupted() { Err(ContactError::Interrupted) } else { Ok(()) }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Equilibrium => "equilibrium",
            Self::Factorization => "factorization",
            Self::CoarseSpace => "coarse space",
            Self::Contact => "contact",
            Self::Recovery => "recovery",
            Self::Adjoint => "adjoint",
            Self::ShapeDerivative => "shape derivative",
        })
    }
}
