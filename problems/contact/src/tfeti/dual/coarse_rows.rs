//! The rows of Gᵀ = B R of a process: rows of B on the rigid motions of the clusters they touch.
//!
//! A cluster is a single subdomain unless the tearing joins several. The motions at the ghosts come from the processes
//! that own them. A contact row is formed by its owner, and all processes are told.

use crate::body::MOTIONS;
use crate::tfeti::dual::rigid_rows::Six;
use crate::tfeti::torn::{TornModel, TornSystem};

/// The rigid motions at all dofs of a torn vector.
pub struct TornModes<'a> {
    model: &'a TornModel,
    system: &'a TornSystem,
    /// Six numbers per ghost.
    ghosts: Vec<f64>,
}

impl<'a> TornModes<'a> {
    /// The motions of a factored system.
    pub fn new(model: &'a TornModel, system: &'a TornSystem) -> Self {
        let own = |dof: usize, mode: usize| system.motion(dof, mode);
        Self { model, system, ghosts: model.interface.of_ghosts(&model.distribution, MOTIONS, own) }
    }

    /// One row of Gᵀ.
    pub fn coarse_row(&self, row: usize) -> Vec<(usize, Six)> {
        let (numbering, interface) = (&self.model.numbering, &self.model.interface);
        let mut blocks: Vec<(usize, Six)> = Vec::with_capacity(2);
        for (place, value) in self.system.rows.rows.row(row) {
            let cluster = numbering.cluster_of(numbering.owner(interface.dof(place)));
            // Dofs of one row that belong to one cluster are simply added up.
            let position = blocks.iter().position(|(other, _)| *other == cluster).unwrap_or_else(|| {
                blocks.push((cluster, [0.0; MOTIONS]));
                blocks.len() - 1
            });
            for (mode, entry) in blocks[position].1.iter_mut().enumerate() {
                *entry += value * self.at(place, mode);
            }
        }
        blocks
    }

    /// A motion at a place of a torn vector.
    fn at(&self, place: usize, mode: usize) -> f64 {
        match place.checked_sub(self.model.interface.owned_count()) {
            None => self.system.motion(place, mode),
            Some(ghost) => self.ghosts[MOTIONS * ghost + mode],
        }
    }

    /// The contact rows of Gᵀ of all processes.
    pub fn contact_rows(&self) -> Vec<Vec<(usize, Six)>> {
        let (constraints, distribution) = (&self.model.constraints, &self.model.distribution);
        let own = constraints.own_contact_rows(distribution).iter();
        let own = own.map(|row| self.coarse_row(constraints.equality_count + row));
        let numbers =
            own.map(|row| row.into_iter().flat_map(|(cluster, six)| [cluster as f64].into_iter().chain(six)).collect());
        let rows = constraints.complete_contact(&numbers.collect::<Vec<_>>(), distribution);
        let block = |numbers: &[f64]| (numbers[0] as usize, std::array::from_fn(|mode| numbers[mode + 1]));
        rows.iter().map(|row| row.chunks_exact(MOTIONS + 1).map(block).collect()).collect()
    }
}
