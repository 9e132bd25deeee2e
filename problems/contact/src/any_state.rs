//! What a solver of any kind keeps of a solved shape.

use crate::direct::DirectState;
use crate::equilibrium::{ContactWarmStart, SolverState};
use crate::tfeti::TornState;

/// What a solver of any kind keeps of a solved shape.
#[derive(Debug)]
pub enum AnyState {
    /// By total FETI.
    Torn(Box<TornState>),
    /// By direct condensation.
    Direct(Box<DirectState>),
}

impl SolverState for AnyState {
    fn warm_start(&self) -> ContactWarmStart {
        match self {
            Self::Torn(state) => state.warm_start(),
            Self::Direct(state) => state.warm_start(),
        }
    }
}

impl From<TornState> for AnyState {
    fn from(state: TornState) -> Self {
        Self::Torn(Box::new(state))
    }
}

impl From<DirectState> for AnyState {
    fn from(state: DirectState) -> Self {
        Self::Direct(Box::new(state))
    }
}
