//! The rows of B: gluing and supports (B_E), then contact. They are orthonormal; geometry does not enter.
//!
//! ```text
//! gluing of m copies:  (m − 1) Helmert rows;   supports: one row per copy (no gluing of that dof)
//! contact:             (mean over copies of the lower body − mean over copies of the upper body)/ν,  ν = |normal row|
//! λ_physical = λ/ν,  jump_physical = ν·jump:   all rows of a node share ν, so the friction cone keeps its form
//! ```
//! B_D Bᵀ = I with stiffness weights between bodies: B_D gives the softer body the larger share.
//!
//! A process has the rows of B_E that touch its subdomains, by ascending owner: the owner of a row is the first
//! subdomain that it touches. Rows of owners in other processes come first. Contact rows are known to all processes;
//! each computes the jumps of those that it owns, and all are told.

use crate::equilibrium::ContactBoundary;
use crate::error::ContactError;
use crate::linear::csr::Csr;
use crate::linear::entry::Entry;
use crate::scene::Scene;
use crate::tfeti::torn::cluster_rows::ClusterRows;
use crate::tfeti::torn::distribution::Distribution;
use crate::tfeti::torn::interface::{Interface, InterfaceBuilder};
use crate::tfeti::torn::scene_rows::{BodyRows, EqualityRow, SceneRows, SparseRow, first_subdomain};
use crate::tfeti::torn::vectors::RowVector;
use std::collections::BTreeSet;
use std::ops::Range;

/// B, B_D and their transposes on the torn vectors of a process; the same for all shapes.
#[derive(Debug)]
pub struct Constraints {
    /// B: rows × torn vector; contact rows of other owners are empty.
    pub rows: Csr,
    /// Bᵀ: dofs of this process × rows.
    pub transposed: Csr,
    /// B_D: rows × torn vector, empty where B is; B_D Bᵀ = I.
    pub weighted: Csr,
    /// B_Dᵀ: dofs of this process × rows.
    pub weighted_transposed: Csr,
    /// Number of rows of B_E of this process; contact rows follow in packed order.
    pub equality_count: usize,
    /// Number of rows of B_E of all processes.
    pub total_equality_count: usize,
    /// Number of gluing rows of all processes.
    pub gluing_count: usize,
    /// ν of every contact node.
    pub normalisation: Vec<f64>,
    /// Rows of B_E by owner: the first of every subdomain of this process, then their number.
    pub owned_rows: Vec<usize>,
    /// Subdomains with contact rows.
    pub contact_subdomains: BTreeSet<usize>,
    /// Rows of B_c of the clusters of this process; empty rows for clusters of one subdomain.
    pub joined: Vec<ClusterRows>,
    /// Places of the rows of B_E of this process among those of all, and the number of rows that every process owns.
    places: Vec<usize>,
    own_counts: Vec<usize>,
    /// Contact rows by the process that owns them, ascending, and their number per process.
    contact_order: Vec<usize>,
    contact_counts: Vec<usize>,
}

impl Constraints {
    /// All rows of a scene whose subdomains have `size` dofs, and what processes exchange for them.
    pub fn new(
        scene: &Scene,
        bodies: &[BodyRows<'_>],
        boundary: &ContactBoundary,
        size: usize,
        distribution: &Distribution,
    ) -> (Self, Interface) {
        let subdomains = distribution.owned();
        let all = SceneRows::new(scene, bodies, boundary, &subdomains, [distribution.count(), size]);
        let owners: Vec<usize> = all.contact.iter().map(|[row, _]| first_subdomain(row, size)).collect();
        let interface = interface(&all, &owners, distribution, size);
        let owned = |owner: usize| subdomains.contains(&owner);
        let (equality_count, own) = (all.equality.len(), interface.owned_count());
        let place = |(dof, value): &(usize, f64)| interface.place(*dof).map(|place| (place, *value));
        let whole = |row: &SparseRow| row.iter().filter_map(place).collect::<SparseRow>();
        let within =
            |row: &SparseRow| row.iter().filter_map(place).filter(|(place, _)| *place < own).collect::<SparseRow>();
        let matrices = |kind: usize| {
            let equality = || all.equality.iter().map(|row| &row.entries);
            let contact = all.contact.iter().zip(&owners);
            let contact = contact.map(|(rows, &owner)| if owned(owner) { whole(&rows[kind]) } else { vec![] });
            let rows = Csr::from_rows(interface.torn_count(), equality().map(whole).chain(contact));
            let contact = all.contact.iter().map(|rows| &rows[kind]);
            (rows, Csr::from_rows(own, equality().chain(contact).map(within)).transpose())
        };
        let ((rows, transposed), (weighted, weighted_transposed)) = (matrices(0), matrices(1));
        let (ranks, owners) = (0..distribution.communication().size(), &owners);
        let of_rank = |rank: usize| (0..owners.len()).filter(move |&row| distribution.owner(owners[row]) == rank);
        let constraints = Self {
            transposed,
            weighted_transposed,
            rows,
            weighted,
            equality_count,
            total_equality_count: all.counts.iter().sum(),
            places: places(&all),
            own_counts: ranks.clone().map(|rank| all.counts[distribution.of(rank)].iter().sum()).collect(),
            gluing_count: all.gluing_count,
            owned_rows: (subdomains.start..=subdomains.end)
                .map(|subdomain| all.equality.partition_point(|row| row.owner < subdomain))
                .collect(),
            contact_subdomains: all.contact.iter().flat_map(|[row, _]| row.iter().map(|(dof, _)| dof / size)).collect(),
            contact_order: ranks.clone().flat_map(of_rank).collect(),
            contact_counts: ranks.map(|rank| of_rank(rank).count()).collect(),
            joined: cluster_rows(&all, &bodies[0], &subdomains, size),
            normalisation: all.normalisation,
        };
        (constraints, interface)
    }

    /// Number of rows of this process.
    pub fn row_count(&self) -> usize {
        self.rows.row_count()
    }

    /// The zero vector over the rows of this process.
    pub fn zeros(&self) -> RowVector {
        RowVector::new(vec![0.0; self.row_count()], self.equality_count)
    }

    /// A product with rows of B or B_D, as a vector over the rows of this process.
    pub(crate) fn multiply<V: Entry>(&self, rows: &Csr, torn: &[V], distribution: &Distribution) -> RowVector<V> {
        let mut result = vec![V::ZERO; self.row_count()];
        rows.multiply(torn, &mut result);
        let mut result = RowVector::new(result, self.equality_count);
        if !distribution.is_alone() {
            let contact = result.contact_mut();
            let own: Vec<V> = self.own_contact_rows(distribution).iter().map(|&row| contact[row]).collect();
            let all = distribution.gather_entries(&own, &self.contact_counts);
            self.contact_order.iter().zip(all).for_each(|(&row, entry)| contact[row] = entry);
        }
        result
    }

    /// Packed contact rows that this process owns, ascending.
    pub(crate) fn own_contact_rows(&self, distribution: &Distribution) -> &[usize] {
        let rank = distribution.communication().rank();
        let first: usize = self.contact_counts[..rank].iter().sum();
        &self.contact_order[first..first + self.contact_counts[rank]]
    }

    /// Pieces of all packed contact rows from those of the own ones.
    pub(crate) fn complete_contact(&self, own: &[Vec<f64>], distribution: &Distribution) -> Vec<Vec<f64>> {
        let lengths: Vec<f64> = own.iter().map(|piece| piece.len() as f64).collect();
        let lengths = distribution.gather_entries(&lengths, &self.contact_counts);
        let values = distribution.communication().gather_any(&own.concat());
        let mut values = values.into_iter().flatten();
        let mut pieces = vec![Vec::new(); lengths.len()];
        for (&row, length) in self.contact_order.iter().zip(lengths) {
            pieces[row] = values.by_ref().take(length as usize).collect();
        }
        pieces
    }

    /// A vector over all rows, from those of this process.
    pub(crate) fn whole(&self, own: &RowVector, distribution: &Distribution) -> Vec<f64> {
        let (equality, contact) = own.split();
        let mut whole = distribution.gather_entries(&equality[self.owned_rows[0]..], &self.own_counts);
        whole.extend(contact);
        whole
    }

    /// The rows of this process of a vector over all rows.
    pub(crate) fn own_rows(&self, whole: &[f64]) -> RowVector {
        let (equality, contact) = whole.split_at(self.total_equality_count);
        let own = self.places.iter().map(|&place| equality[place]).chain(contact.iter().copied());
        RowVector::new(own.collect(), self.equality_count)
    }

    /// The rows of this process of given values, one per row of all processes.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] when their number is not that of the rows.
    pub fn row_vector(&self, values: &[f64]) -> Result<RowVector, ContactError> {
        let contact = self.row_count() - self.equality_count;
        let (expected, found) = (self.total_equality_count + contact, values.len());
        if expected != found {
            return Err(ContactError::ForeignState { what: "multipliers", expected, found });
        }
        Ok(self.own_rows(values))
    }

    /// ν of the node of every packed contact row.
    pub fn contact_scales<'a>(&'a self, boundary: &'a ContactBoundary) -> impl Iterator<Item = f64> + 'a {
        let nodes = boundary.points.iter().zip(&self.normalisation);
        nodes.flat_map(|(point, &nu)| std::iter::repeat_n(nu, point.row_count()))
    }
}

/// Places of the rows of B_E of this process among those of all.
fn places(all: &SceneRows) -> Vec<usize> {
    let mut before = vec![0; all.counts.len() + 1];
    for (subdomain, count) in all.counts.iter().enumerate() {
        before[subdomain + 1] = before[subdomain] + count;
    }
    all.equality.iter().map(|EqualityRow { owner, index, .. }| before[*owner] + index).collect()
}

/// B_c of the clusters of this process, whose subdomains have `size` dofs each.
fn cluster_rows(all: &SceneRows, body: &BodyRows<'_>, subdomains: &Range<usize>, size: usize) -> Vec<ClusterRows> {
    let dofs = |index: usize| size * subdomains.start + index * body.cluster_size;
    let rows = all.joined.iter().enumerate();
    rows.map(|(index, rows)| ClusterRows::new(rows, dofs(index)..dofs(index + 1), size)).collect()
}

/// What this process exchanges: all processes that a row of B_E touches need its dofs; of a contact row, the owner.
fn interface(all: &SceneRows, owners: &[usize], distribution: &Distribution, size: usize) -> Interface {
    let (rank, subdomains) = (distribution.communication().rank(), distribution.owned());
    let owned: Range<usize> = size * subdomains.start..size * subdomains.end;
    let mut builder = InterfaceBuilder::default();
    if !distribution.is_alone() {
        let dofs = |row: &'_ SparseRow| row.iter().map(|(dof, _)| *dof).collect::<Vec<usize>>();
        for dofs in all.equality.iter().map(|row| dofs(&row.entries)) {
            builder.needs(&owned, dofs.iter().copied());
            let touched: BTreeSet<usize> = dofs.iter().map(|dof| distribution.owner(dof / size)).collect();
            for other in touched.into_iter().filter(|other| *other != rank) {
                builder.needed_by(other, &owned, dofs.iter().copied());
            }
        }
        for ([row, _], &owner) in all.contact.iter().zip(owners) {
            match distribution.owner(owner) {
                owner if owner == rank => builder.needs(&owned, dofs(row).into_iter()),
                owner => builder.needed_by(owner, &owned, dofs(row).into_iter()),
            }
        }
    }
    builder.build(owned, distribution, size)
}
