//! The rows of Gᵀ = B R of a process: rows of B on the rigid modes of the subdomains they touch.
//!
//! The modes at the ghosts come from the processes that own them. A contact row is formed by its owner, and all processes are told.

use crate::equilibrium::modes::MOTIONS;
use crate::tfeti::torn::{TornModel, TornSystem};

/// The rigid modes at all dofs of a torn vector.
pub struct TornModes<'a> {
    model: &'a TornModel,
    system: &'a TornSystem,
    /// Six numbers per ghost.
    ghosts: Vec<f64>,
}

impl<'a> TornModes<'a> {
    /// The modes of a factored system.
    pub fn new(model: &'a TornModel, system: &'a TornSystem) -> Self {
        let size = model.pattern.pattern.dimension();
        let own = |dof: usize, mode: usize| system.parts[dof / size].modes[mode][dof % size];
        Self { model, system, ghosts: model.interface.of_ghosts(&model.distribution, MOTIONS, own) }
    }

    /// One row of Gᵀ: amplitudes and values, the six of a subdomain side by side.
    pub fn coarse_row(&self, row: usize) -> Vec<(usize, f64)> {
        let (size, interface) = (self.model.pattern.pattern.dimension(), &self.model.interface);
        let mut entries: Vec<(usize, f64)> = Vec::with_capacity(2 * MOTIONS);
        for (place, value) in self.model.constraints.rows.row(row) {
            let first = MOTIONS * (interface.dof(place) / size);
            // Dofs of one row that belong to one subdomain are rare; they are simply added up.
            let position = entries.iter().position(|(index, _)| *index == first).unwrap_or_else(|| {
                entries.extend((first..first + MOTIONS).map(|index| (index, 0.0)));
                entries.len() - MOTIONS
            });
            for (mode, entry) in entries[position..].iter_mut().take(MOTIONS).enumerate() {
                entry.1 += value * self.at(place, mode);
            }
        }
        entries
    }

    /// A mode at a place of a torn vector.
    fn at(&self, place: usize, mode: usize) -> f64 {
        let (size, owned) = (self.model.pattern.pattern.dimension(), self.model.interface.owned_count());
        match place.checked_sub(owned) {
            None => self.system.parts[place / size].modes[mode][place % size],
            Some(ghost) => self.ghosts[MOTIONS * ghost + mode],
        }
    }

    /// The contact rows of Gᵀ of all processes.
    pub fn contact_rows(&self) -> Vec<Vec<(usize, f64)>> {
        let (constraints, distribution) = (&self.model.constraints, &self.model.distribution);
        let own = constraints.own_contact_rows(distribution).iter();
        let own = own.map(|row| self.coarse_row(constraints.equality_count + row));
        let numbers = own.map(|row| row.into_iter().flat_map(|(index, value)| [index as f64, value]).collect());
        let rows = constraints.complete_contact(&numbers.collect::<Vec<_>>(), distribution);
        let entries = |row: Vec<f64>| row.chunks_exact(2).map(|pair| (pair[0] as usize, pair[1])).collect();
        rows.into_iter().map(entries).collect()
    }
}
