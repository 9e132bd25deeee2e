//! Displacements that rows of B take from the subdomains of other processes.
//!
//! ```text
//! torn vector of a process:   dofs of its subdomains │ ghosts: dofs of others in its rows, by ascending number
//! ```
//! Two processes whose subdomains meet in a row send each other their dofs of it, once per product with B.

use crate::communication::Parcel;
use crate::linear::entry::Entry;
use crate::tfeti::torn::distribution::Distribution;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// The ghosts of a process, and what it sends for the ghosts of others. Dofs are numbered subdomain by subdomain.
#[derive(Debug)]
pub struct Interface {
    /// Dofs of the subdomains of this process.
    owned: Range<usize>,
    /// Dofs of other processes, ascending.
    ghosts: Vec<usize>,
    neighbours: Vec<Neighbour>,
}

/// What this process exchanges with another one.
#[derive(Debug)]
struct Neighbour {
    rank: usize,
    /// Dofs of this process that the other one needs, counted from its first one.
    outgoing: Vec<usize>,
    /// Ghosts that the other one sends.
    incoming: Range<usize>,
}

/// Collects the dofs of rows before they are numbered.
#[derive(Debug, Default)]
pub struct InterfaceBuilder {
    ghosts: BTreeSet<usize>,
    outgoing: BTreeMap<usize, BTreeSet<usize>>,
}

impl InterfaceBuilder {
    /// Registers that this process needs all dofs of a row.
    pub fn needs(&mut self, owned: &Range<usize>, dofs: impl Iterator<Item = usize>) {
        self.ghosts.extend(dofs.filter(|dof| !owned.contains(dof)));
    }

    /// Another process needs all dofs of a row.
    pub fn needed_by(&mut self, rank: usize, owned: &Range<usize>, dofs: impl Iterator<Item = usize>) {
        let mut own = dofs.filter(|dof| owned.contains(dof)).peekable();
        if own.peek().is_some() {
            self.outgoing.entry(rank).or_default().extend(own);
        }
    }

    /// The interface of all rows; `rank`: the process of a dof.
    pub fn build(self, owned: Range<usize>, rank: impl Fn(usize) -> usize) -> Interface {
        let ghosts: Vec<usize> = self.ghosts.into_iter().collect();
        let mut incoming: BTreeMap<usize, Range<usize>> = BTreeMap::new();
        for (index, &dof) in ghosts.iter().enumerate() {
            incoming.entry(rank(dof)).or_insert(index..index).end = index + 1;
        }
        let mut outgoing = self.outgoing;
        let ranks: BTreeSet<usize> = outgoing.keys().chain(incoming.keys()).copied().collect();
        let neighbour = |rank| Neighbour {
            rank,
            outgoing: outgoing.remove(&rank).unwrap_or_default().into_iter().map(|dof| dof - owned.start).collect(),
            incoming: incoming.remove(&rank).unwrap_or(0..0),
        };
        let neighbours = ranks.into_iter().map(neighbour).collect();
        Interface { owned, ghosts, neighbours }
    }
}

impl Interface {
    /// Number of dofs of this process.
    pub fn owned_count(&self) -> usize {
        self.owned.len()
    }

    /// Length of a torn vector.
    pub fn torn_count(&self) -> usize {
        self.owned.len() + self.ghosts.len()
    }

    /// The dof at a place of a torn vector.
    pub fn dof(&self, place: usize) -> usize {
        if place < self.owned.len() { self.owned.start + place } else { self.ghosts[place - self.owned.len()] }
    }

    /// The place of a dof in a torn vector; none if no row of this process needs it.
    pub fn place(&self, dof: usize) -> Option<usize> {
        if self.owned.contains(&dof) {
            return Some(dof - self.owned.start);
        }
        self.ghosts.binary_search(&dof).ok().map(|index| self.owned.len() + index)
    }

    /// Numbers that belong to the ghosts, `width` per dof, from those of the own dofs.
    pub fn of_ghosts(&self, distribution: &Distribution, width: usize, own: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let columns = |dof: usize| (0..width).map(move |column| (dof, column));
        let parcel = |neighbour: &Neighbour| Parcel {
            rank: neighbour.rank,
            outgoing: neighbour
                .outgoing
                .iter()
                .flat_map(|&dof| columns(dof))
                .map(|(dof, column)| own(dof, column))
                .collect(),
            incoming: vec![0.0; width * neighbour.incoming.len()],
        };
        let mut parcels: Vec<Parcel> = self.neighbours.iter().map(parcel).collect();
        distribution.communication().exchange(&mut parcels);
        // Numbers of dofs ascend with the processes, and so do the neighbours.
        parcels.into_iter().flat_map(|parcel| parcel.incoming).collect()
    }

    /// Fills in the ghosts of a torn vector or of a block of columns.
    pub fn complete<V: Entry>(&self, distribution: &Distribution, torn: &mut [V]) {
        if distribution.is_alone() {
            return;
        }
        let (own, ghosts) = torn.split_at_mut(self.owned.len());
        let numbers = self.of_ghosts(distribution, V::WIDTH, |dof, column| own[dof].get(column));
        for (ghost, numbers) in ghosts.iter_mut().zip(numbers.chunks_exact(V::WIDTH)) {
            numbers.iter().enumerate().for_each(|(column, &number)| ghost.set(column, number));
        }
    }
}
