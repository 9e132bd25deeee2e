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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::ContactProblem;
    use crate::linear::vector::{add_scaled, norm};
    use crate::scene::{Scene, signorini};
    use crate::tfeti::torn::{TornModel, TornOptions};

    /// Bodies in clusters of 2 × 2 × 1 subdomains, and their system.
    fn joined() -> (TornModel, TornSystem) {
        let scene = Scene { mesh: [12, 6, 6], subdomains: [4, 2, 2], ..signorini().expect("a preset") };
        let problem = Arc::new(ContactProblem::new(scene).expect("a scene"));
        let options = TornOptions { clusters: [2, 2, 1], ..TornOptions::default() };
        let model = TornModel::new(Arc::clone(&problem), options).expect("a torn scene");
        let heights: Vec<f64> = (0..36).map(|index| 95.0 + (0.7 * f64::from(index)).sin()).collect();
        let system = model.factorize(&problem.blocks(&heights).expect("blocks")).expect("factors");
        (model, system)
    }

    /// x ← (I − B_cᵀ B_c) x and |B_c x| before.
    fn hold_together(model: &TornModel, x: &mut [f64]) -> f64 {
        let size = model.pattern.pattern.dimension() * model.numbering.members();
        let jumps = x.chunks_exact_mut(size).zip(&model.constraints.joined).map(|(x, rows)| {
            let mut jumps = vec![0.0; rows.count];
            let first = |member: usize| member * size / rows.members.len();
            for (member, part) in rows.members.iter().enumerate() {
                part.entries.iter().for_each(|&(row, place, v)| jumps[row] += v * x[first(member) + part.dofs[place]]);
            }
            for (member, part) in rows.members.iter().enumerate() {
                part.entries.iter().for_each(|&(row, place, v)| x[first(member) + part.dofs[place]] -= v * jumps[row]);
            }
            norm(&jumps)
        });
        jumps.fold(0.0, f64::max)
    }

    /// The forces K x.
    fn forces(model: &TornModel, system: &TornSystem, x: &[f64]) -> Vec<f64> {
        let size = model.pattern.pattern.dimension();
        let mut forces = vec![0.0; x.len()];
        for ((part, x), forces) in system.parts.iter().zip(x.chunks_exact(size)).zip(forces.chunks_exact_mut(size)) {
            model.pattern.pattern.multiply(&part.stiffness, x, forces);
        }
        forces
    }

    /// The displacements K̂⁺ f.
    fn displacements(model: &TornModel, system: &TornSystem, forces: &[f64]) -> Vec<f64> {
        let mut x = forces.to_vec();
        let parts = x.chunks_exact_mut(model.pattern.pattern.dimension()).zip(&system.parts);
        let resultants: Vec<[f64; MOTIONS]> = parts
            .map(|(x, part)| {
                let resultants = part.resultants_of(x);
                part.solve(x);
                resultants
            })
            .collect();
        system.join(&model.constraints.joined, &resultants, &mut x);
        x
    }

    #[test]
    fn the_inverse_of_a_cluster_is_a_generalised_one() {
        let (model, system) = joined();
        let mut probe: Vec<f64> = (0..model.total_dofs).map(|index| (0.37 * index as f64).sin()).collect();
        assert!(hold_together(&model, &mut probe) > 1.0);
        // Forces of a joined cluster, with any reactions between its subdomains.
        let expected = forces(&model, &system, &probe);
        let mut loads = expected.clone();
        hold_together(&model, &mut loads);
        let mut found = displacements(&model, &system, &loads);
        let mut rest = forces(&model, &system, &found);
        let jumps = hold_together(&model, &mut found);
        assert!(jumps < 1e-11 * norm(&probe), "{jumps:.1e}");
        add_scaled(&mut rest, -1.0, &expected);
        hold_together(&model, &mut rest);
        assert!(norm(&rest) < 1e-11 * norm(&expected), "{:.1e}", norm(&rest) / norm(&expected));
    }

    #[test]
    fn a_cluster_has_six_orthonormal_motions_without_strain_or_jumps() {
        let (model, system) = joined();
        let size = model.pattern.pattern.dimension() * model.numbering.members();
        let scale = system.parts[0].stiffness.iter().fold(0.0, |scale: f64, value| scale.max(value.abs()));
        for cluster in 0..model.numbering.cluster_count() {
            let motion = |number: usize| -> Vec<f64> {
                let mut all = vec![0.0; model.total_dofs];
                (cluster * size..(cluster + 1) * size).for_each(|dof| all[dof] = system.motion(dof, number));
                all
            };
            let motions: Vec<Vec<f64>> = (0..MOTIONS).map(motion).collect();
            for (number, motion) in motions.iter().enumerate() {
                for (other, second) in motions.iter().enumerate() {
                    let product: f64 = motion.iter().zip(second).map(|(a, b)| a * b).sum();
                    assert!((product - f64::from(u8::from(number == other))).abs() < 1e-12);
                }
                assert!(norm(&forces(&model, &system, motion)) < 1e-11 * scale);
                assert!(hold_together(&model, &mut motion.clone()) < 1e-12);
            }
        }
    }
}
