//! Open, stick, slip.

use serde::{Deserialize, Serialize};

/// What a contact node does; method.md (3.2), (3.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ContactStatus {
    /// No contact: λ_N = 0.
    Open,
    /// Closed, |λ_T| ≤ 𝓕λ_N, no tangential jump; also a closed node that supports keep from sliding.
    Stick,
    /// Closed, |λ_T| = 𝓕λ_N; without friction, every closed node that is free to slide.
    Slip,
}

/// Numbers of nodes per status.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct StatusCounts {
    /// Nodes without contact.
    pub open: usize,
    /// Closed nodes that do not slide.
    pub stick: usize,
    /// Closed nodes that slide.
    pub slip: usize,
}

impl StatusCounts {
    /// Counts a list of statuses.
    pub fn of(statuses: &[ContactStatus]) -> Self {
        let count = |status| statuses.iter().filter(|&&other| other == status).count();
        Self { open: count(ContactStatus::Open), stick: count(ContactStatus::Stick), slip: count(ContactStatus::Slip) }
    }
}
