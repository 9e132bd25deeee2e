//! The factored subdomains of one shape, and the clusters that they are joined to.

use crate::body::MOTIONS;
use crate::linear::entry::Entry;
use crate::linear::parallel;
use crate::linear::right_side::RightSide;
use crate::shelf::Factored;
use crate::tfeti::torn::cluster_factors::ClusterFactors;
use crate::tfeti::torn::cluster_rows::ClusterRows;
use crate::tfeti::torn::constraints::TornRows;
use crate::tfeti::torn::factored_body::FactoredBody;
use crate::tfeti::torn::factors::{SubdomainFactors, SubdomainLoad};
use crate::tfeti::torn::vectors::parts_mut;
use std::ops::Range;
use std::sync::Arc;

/// The factored subdomains of one shape, with the rows of B.
#[derive(Debug)]
pub struct TornSystem {
    /// The subdomains of this process, in their order.
    pub parts: Vec<Arc<SubdomainFactors>>,
    /// What their loads do to them.
    pub loads: Vec<SubdomainLoad>,
    /// First dof of every subdomain of this process in its torn vectors, then their number.
    pub starts: Arc<[usize]>,
    /// B and B_D.
    pub rows: Arc<TornRows>,
    /// What joins the clusters of this process; none where every subdomain is a cluster.
    pub(super) clusters: Vec<Arc<ClusterFactors>>,
    /// First subdomain of every cluster of this process, then their number.
    pub(super) cluster_starts: Arc<[usize]>,
    /// The bodies that the subdomains and clusters belong to, for others to find.
    #[expect(dead_code, reason = "what a system holds, other solvers find on their shelf")]
    pub(super) bodies: Vec<Arc<Factored<FactoredBody>>>,
    /// Numeric factorisations done for this shape, by all processes.
    pub factorizations: usize,
    /// Largest [`SubdomainFactors::forward_error`] of all subdomains.
    pub forward_error: f64,
}

impl TornSystem {
    /// Whether clusters consist of several subdomains.
    pub(crate) fn is_joined(&self) -> bool {
        !self.clusters.is_empty()
    }

    /// The cluster of a subdomain of this process: its number, and the place of the subdomain in it; none where it is a
    /// cluster of its own.
    fn cluster_of(&self, index: usize) -> Option<(usize, usize)> {
        let cluster = self.cluster_starts.partition_point(|&start| start <= index) - 1;
        self.is_joined().then(|| (cluster, index - self.cluster_starts[cluster]))
    }

    /// The torn dofs of a subdomain of this process.
    pub(crate) fn dofs(&self, index: usize) -> Range<usize> {
        self.starts[index]..self.starts[index + 1]
    }

    /// One of the six orthonormal motions of the cluster of a dof, at a dof of this process.
    pub(crate) fn motion(&self, dof: usize, motion: usize) -> f64 {
        let index = self.starts.partition_point(|&start| start <= dof) - 1;
        let local = dof - self.starts[index];
        let modes = &self.parts[index].modes;
        match self.cluster_of(index) {
            None => modes[motion][local],
            Some((cluster, place)) => {
                let amplitudes = self.clusters[cluster].motion_of(place, motion);
                modes.iter().zip(amplitudes).map(|(mode, amplitude)| mode[local] * amplitude).sum()
            }
        }
    }

    /// Amplitudes along the modes of a subdomain of this process, from those of the clusters of this process.
    pub(crate) fn amplitudes_of(&self, index: usize, clusters: &[f64]) -> [f64; MOTIONS] {
        let of = |number: usize| &clusters[MOTIONS * number..MOTIONS * (number + 1)];
        match self.cluster_of(index) {
            None => std::array::from_fn(|mode| of(index)[mode]),
            Some((cluster, place)) => self.clusters[cluster].amplitudes_of(place, of(cluster)),
        }
    }

    /// Resultants along the motions of the clusters of this process, from those along the modes of its subdomains.
    pub(crate) fn cluster_resultants<V: Entry>(&self, own_resultants: Vec<V>) -> Vec<V> {
        if !self.is_joined() {
            return own_resultants;
        }
        let mut resultants = vec![V::ZERO; MOTIONS * self.clusters.len()];
        let own = |cluster: usize| MOTIONS * self.cluster_starts[cluster]..MOTIONS * self.cluster_starts[cluster + 1];
        for (cluster, sums) in resultants.chunks_exact_mut(MOTIONS).enumerate() {
            for (place, own) in own_resultants[own(cluster)].chunks_exact(MOTIONS).enumerate() {
                self.clusters[cluster].add_resultants(place, own, sums);
            }
        }
        resultants
    }

    /// K̂⁺ f over the subdomains of this process from K⁺ f and Rᵀ f; `rows`: B_c of its clusters.
    pub(crate) fn join<V: RightSide>(&self, rows: &[ClusterRows], resultants: &[[V; MOTIONS]], torn: &mut [V]) {
        if !self.is_joined() {
            return;
        }
        let free = &*torn;
        let reactions: Vec<Vec<V>> = parallel::map(self.clusters.len(), &|cluster| {
            let members = self.cluster_starts[cluster]..self.cluster_starts[cluster + 1];
            let free: Vec<&[V]> = members.clone().map(|index| &free[self.dofs(index)]).collect();
            self.clusters[cluster].reactions(&rows[cluster], &free, &resultants[members])
        });
        parallel::for_parts(parts_mut(torn, &self.starts), &|index, x| {
            if let Some((cluster, place)) = self.cluster_of(index) {
                self.clusters[cluster].join(&rows[cluster], place, &self.parts[index], &reactions[cluster], x);
            }
        });
    }
}
