//! The factored subdomains of one shape, and the clusters that they are joined to.

use crate::equilibrium::modes::MOTIONS;
use crate::linear::entry::Entry;
use crate::linear::right_side::RightSide;
use crate::tfeti::torn::cluster_factors::ClusterFactors;
use crate::tfeti::torn::cluster_rows::ClusterRows;
use crate::tfeti::torn::factors::SubdomainFactors;
use rayon::prelude::*;
use std::sync::Arc;

/// The factored subdomains of one shape.
#[derive(Debug)]
pub struct TornSystem {
    /// The subdomains of this process, in their order.
    pub parts: Vec<Arc<SubdomainFactors>>,
    /// What joins the clusters of this process; none where every subdomain is a cluster.
    pub(super) clusters: Vec<Arc<ClusterFactors>>,
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

    /// The cluster of a subdomain of this process, and its place in it; none where it is a cluster of its own.
    fn cluster_of(&self, index: usize) -> Option<(&ClusterFactors, usize)> {
        let members = self.parts.len().checked_div(self.clusters.len())?;
        Some((&self.clusters[index / members], index % members))
    }

    /// One of the six orthonormal motions of the cluster of a dof, at a dof of this process.
    pub(crate) fn motion(&self, dof: usize, motion: usize) -> f64 {
        let (index, local) = (dof / self.size(), dof % self.size());
        let modes = &self.parts[index].modes;
        match self.cluster_of(index) {
            None => modes[motion][local],
            Some((cluster, place)) => {
                let amplitudes = cluster.motion_of(place, motion);
                modes.iter().zip(amplitudes).map(|(mode, amplitude)| mode[local] * amplitude).sum()
            }
        }
    }

    /// Amplitudes along the modes of a subdomain of this process, from those of the clusters of this process.
    pub(crate) fn amplitudes_of(&self, index: usize, clusters: &[f64]) -> [f64; MOTIONS] {
        let of = |number: usize| &clusters[MOTIONS * number..MOTIONS * (number + 1)];
        match self.cluster_of(index) {
            None => std::array::from_fn(|mode| of(index)[mode]),
            Some((cluster, place)) => cluster.amplitudes_of(place, of(index * self.clusters.len() / self.parts.len())),
        }
    }

    /// Resultants along the motions of the clusters of this process, from those along the modes of its subdomains.
    pub(crate) fn cluster_resultants<V: Entry>(&self, own: Vec<V>) -> Vec<V> {
        if !self.is_joined() {
            return own;
        }
        let mut resultants = vec![V::ZERO; MOTIONS * self.clusters.len()];
        let members = self.parts.len() / self.clusters.len();
        let clusters = self.clusters.iter().zip(own.chunks_exact(MOTIONS * members));
        for ((cluster, own), sums) in clusters.zip(resultants.chunks_exact_mut(MOTIONS)) {
            for (place, own) in own.chunks_exact(MOTIONS).enumerate() {
                cluster.add_resultants(place, own, sums);
            }
        }
        resultants
    }

    /// K̂⁺ f over the subdomains of this process from K⁺ f and Rᵀ f; `rows`: B_c of its clusters.
    pub(crate) fn join<V: RightSide>(&self, rows: &[ClusterRows], resultants: &[[V; MOTIONS]], torn: &mut [V]) {
        if !self.is_joined() {
            return;
        }
        let (size, members) = (self.size(), self.parts.len() / self.clusters.len());
        let free = torn.par_chunks(size * members).zip(resultants.par_chunks(members));
        let reactions: Vec<Vec<V>> = self
            .clusters
            .par_iter()
            .zip(rows)
            .zip(free)
            .map(|((cluster, rows), (free, resultants))| cluster.reactions(rows, free, resultants))
            .collect();
        torn.par_chunks_mut(size).zip(&self.parts).enumerate().for_each(|(index, (x, part))| {
            let (number, place) = (index / members, index % members);
            self.clusters[number].join(&rows[number], place, part, &reactions[number], x);
        });
    }

    /// Dofs of a subdomain.
    fn size(&self) -> usize {
        self.parts[0].modes[0].len()
    }
}
