//! The states of all cases at one shape.

use crate::contact_shape::ContactState;
use crate::equilibrium::Tangents;
use nonsmooth::Vector;
use std::ops::Deref;
use std::sync::OnceLock;

/// The states of all cases at one shape, in the order of the cases.
#[derive(Debug)]
pub struct CaseStates {
    /// The controls of the shape.
    pub control: Vector,
    states: Vec<ContactState>,
    /// The outputs of every case.
    outputs: Vec<Vec<f64>>,
    /// Forward derivatives with those of the displacements, where a Jacobian has been asked for and a limit needs them.
    tangents: Vec<OnceLock<Tangents>>,
}

impl CaseStates {
    pub(super) fn new(control: Vector, states: Vec<(ContactState, Vec<f64>)>) -> Self {
        let tangents = states.iter().map(|_| OnceLock::new()).collect();
        let (states, outputs) = states.into_iter().unzip();
        Self { control, states, outputs, tangents }
    }

    /// The outputs of a case.
    pub(super) fn outputs(&self, case: usize) -> &[f64] {
        &self.outputs[case]
    }

    /// The states alone, in the order of the cases.
    pub fn into_states(self) -> Vec<ContactState> {
        self.states
    }

    /// Keeps the forward derivatives of a case.
    pub(super) fn keep_tangents(&self, case: usize, tangents: Tangents) {
        // Those found first are as good.
        let _first = self.tangents[case].set(tangents);
    }

    /// The forward derivatives of a case with those of its displacements, if they are known.
    pub(super) fn tangents(&self, case: usize) -> Option<&Tangents> {
        self.tangents[case].get()
    }
}

impl Deref for CaseStates {
    type Target = [ContactState];

    fn deref(&self) -> &[ContactState] {
        &self.states
    }
}
