//! The factors that the solvers of one process share.

use crate::direct::CondensedShelf;
use crate::tfeti::TornShelf;
use std::sync::Arc;

/// Factors of bodies that solvers of this process still hold, by total FETI and by direct condensation.
#[derive(Debug, Clone, Default)]
pub struct SharedFactors {
    pub(super) torn: Arc<TornShelf>,
    pub(super) condensed: Arc<CondensedShelf>,
}
