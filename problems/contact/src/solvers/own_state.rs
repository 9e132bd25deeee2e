//! What the solver of one process keeps of a solved shape.

use crate::direct::DirectState;
use crate::equilibrium::ContactWarmStart;
use crate::tfeti::TornState;

/// What the solver of one process keeps of a solved shape.
#[derive(Debug)]
pub enum OwnState {
    Torn(Box<TornState>),
    Direct(Box<DirectState>),
}

impl OwnState {
    /// What a similar shape can be solved from.
    pub fn warm_start(&self) -> ContactWarmStart {
        match self {
            Self::Torn(state) => state.warm_start(),
            Self::Direct(state) => state.warm_start(),
        }
    }
}

impl From<TornState> for OwnState {
    fn from(state: TornState) -> Self {
        Self::Torn(Box::new(state))
    }
}

impl From<DirectState> for OwnState {
    fn from(state: DirectState) -> Self {
        Self::Direct(Box::new(state))
    }
}
