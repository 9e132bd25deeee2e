//! The factors of a body in this process, and what they depend on beside the positions of its nodes.

use crate::body::Body;
use crate::shelf::Shelf;
use crate::tfeti::torn::cluster_factors::ClusterFactors;
use crate::tfeti::torn::cluster_rows::ClusterRows;
use crate::tfeti::torn::factors::SubdomainFactors;
use std::ops::Range;
use std::sync::Arc;

/// Factored bodies that solvers share.
pub type TornShelf = Shelf<TornKey, FactoredBody>;

/// The factors of the subdomains and clusters of a body in this process, by their places there.
#[derive(Debug)]
pub struct FactoredBody {
    pub(super) parts: Vec<(usize, Arc<SubdomainFactors>)>,
    pub(super) clusters: Vec<(usize, Arc<ClusterFactors>)>,
}

impl FactoredBody {
    /// Number of numeric factorisations that it took in this process.
    pub(super) fn factorizations(&self) -> usize {
        self.parts.iter().map(|(_, part)| part.factorizations()).sum()
    }
}

/// Mesh, materials, tied nodes and pieces of a body, the places of its subdomains and clusters, and the dofs of their
/// rows: its stiffness, torn. Neither loads nor prescribed displacements are part of it.
#[derive(Debug)]
pub struct TornKey {
    bodies: Arc<[Body]>,
    number: usize,
    own: OwnParts,
}

/// The part of a body in this process.
#[derive(Debug, PartialEq)]
pub(super) struct OwnParts {
    /// Place and piece of every subdomain, and, where the preconditioner has interior factors, its dofs with rows.
    pub(super) subdomains: Vec<(usize, usize, Option<Vec<bool>>)>,
    /// Place, subdomains and rows of every cluster of several subdomains.
    pub(super) clusters: Vec<(usize, Range<usize>, ClusterRows)>,
}

impl TornKey {
    /// The key of a body of a problem.
    pub(super) fn new(bodies: Arc<[Body]>, number: usize, own: OwnParts) -> Self {
        Self { bodies, number, own }
    }
}

impl PartialEq for TornKey {
    fn eq(&self, other: &Self) -> bool {
        let (one, two) = (&self.bodies[self.number], &other.bodies[other.number]);
        let cells = |body: &Body| body.pieces.iter().map(|piece| piece.cells.clone()).collect::<Vec<_>>();
        self.own == other.own && one.solid == two.solid && cells(one) == cells(two)
    }
}
