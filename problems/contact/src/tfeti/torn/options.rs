//! What a torn model can be asked for.

use crate::communication::{Communication, InProcess};
use crate::tfeti::torn::factored_body::TornShelf;
use crate::tfeti::torn::preconditioner_kind::PreconditionerKind;
use std::sync::Arc;

/// How bodies are torn, preconditioned and divided among processes.
#[derive(Debug, Clone)]
pub struct TornOptions {
    /// The preconditioner of the dual operator.
    pub preconditioner: PreconditionerKind,
    /// Number of clusters into which the subdomains of all bodies are joined, about. The subdomains of a cluster share
    /// six rigid motions, so that the coarse problem has six unknowns per cluster (hybrid total FETI). None: every
    /// subdomain by itself, which is total FETI.
    pub clusters: Option<usize>,
    /// What connects the processes; each of them works on its own clusters.
    pub communication: Arc<dyn Communication>,
    /// Where solvers of this process find the factors of each other.
    pub shelf: Arc<TornShelf>,
}

impl Default for TornOptions {
    fn default() -> Self {
        Self {
            preconditioner: PreconditionerKind::default(),
            clusters: None,
            communication: Arc::new(InProcess),
            shelf: Arc::default(),
        }
    }
}
