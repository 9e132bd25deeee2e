//! The rows of B: gluing and supports (B_E), then contact. The rows of B_E are orthonormal, and geometry does not enter
//! them; the contact rows of a shape follow its normals.
//!
//! ```text
//! gluing of m copies:  (m − 1) Helmert rows per free direction;   supports: one row per copy and held direction
//! B_E u = c_E:         0 in rows of gluing, the prescribed displacement in rows of supports
//! contact:             Σ_sides weight · (mean over the copies along d)/ν,  ν = √(Σ weight²/m) at the start
//! λ_physical = λ/ν,  jump_physical = ν·jump:   all rows of a node share ν, so the friction cone keeps its form
//! ```
//! B_D Bᵀ = I with stiffness weights between bodies and between the copies of a glued node: B_D gives the softer one
//! the larger share. Copies of contact nodes share equally: with gluing and contact rows, B is orthogonal there.
//!
//! A process has the rows of B_E that touch its subdomains, by ascending owner: the owner of a row is the first
//! subdomain that it touches. Rows of owners in other processes come first. Contact rows are known to all processes;
//! each computes the jumps of those that it owns, and all are told.

use crate::body::Body;
use crate::equilibrium::{ContactBoundary, ContactRows};
use crate::error::ContactError;
use crate::linear::csr::Csr;
use crate::linear::entry::Entry;
use crate::tfeti::torn::cluster_rows::ClusterRows;
use crate::tfeti::torn::copies::Copies;
use crate::tfeti::torn::distribution::Distribution;
use crate::tfeti::torn::interface::{Interface, InterfaceBuilder};
use crate::tfeti::torn::joints::Joints;
use crate::tfeti::torn::numbering::Numbering;
use crate::tfeti::torn::scene_rows::{
    ContactNode, EqualityRow, SceneRows, SparseRow, contact_cells, contact_rows, possible_directions,
};
use crate::tfeti::torn::vectors::RowVector;
use std::collections::{BTreeSet, HashSet};
use std::ops::Range;

/// What of B is the same for all shapes, on the torn vectors of a process.
#[derive(Debug)]
pub struct Constraints {
    /// B_E, and its part of B_D: rows × torn vector.
    equality: [Csr; 2],
    /// c_E: what supports prescribe in the rows of B_E of this process, mm.
    pub prescribed: Vec<f64>,
    /// The contact nodes, from which the contact rows of a shape are made.
    contact: Vec<ContactNode>,
    /// Body, node and first dofs of the copies of every node in contact rows.
    pub(super) contact_copies: Vec<(usize, u32, Vec<usize>)>,
    /// The subdomain that owns every packed contact row.
    contact_owners: Vec<usize>,
    /// Whether rows of B or B_c may touch a dof of this process, at any shape.
    pub touched: Vec<bool>,
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

/// B, B_D and their transposes for one shape, on the torn vectors of a process.
#[derive(Debug)]
pub struct TornRows {
    /// B: rows × torn vector; contact rows of other owners are empty.
    pub rows: Csr,
    /// Bᵀ: dofs of this process × rows.
    pub transposed: Csr,
    /// B_D: rows × torn vector, empty where B is; B_D Bᵀ = I.
    pub weighted: Csr,
    /// B_Dᵀ: dofs of this process × rows.
    pub weighted_transposed: Csr,
}

impl Constraints {
    /// All rows of bodies, and what processes exchange for them. `start`: the contact rows at the start, `are_fixed`:
    /// whether they have the same directions at all shapes.
    pub fn new(
        bodies: &[Body],
        boundary: &ContactBoundary,
        numbering: &Numbering,
        distribution: &Distribution,
        (start, are_fixed): (&ContactRows, bool),
    ) -> (Self, Interface) {
        let subdomains = distribution.owned();
        let of_body = |(number, body)| Copies::new(number, body, numbering);
        let copies: Vec<Copies> = bodies.iter().enumerate().map(of_body).collect();
        let joints = Joints::new(bodies, &copies, numbering);
        let cells = contact_cells(boundary, bodies);
        let nodes: Vec<HashSet<u32>> = cells.iter().map(|cells| cells.keys().copied().collect()).collect();
        let all = SceneRows::new((bodies, &nodes), &copies, numbering, &subdomains, &joints);
        let points = boundary.points.iter().zip(&start.nodes);
        let of_node = |own| ContactNode::new(own, (bodies, &start.traces), &copies, &cells);
        let contact: Vec<ContactNode> = points.map(of_node).collect();
        let dofs: Vec<Vec<usize>> = contact
            .iter()
            .zip(boundary.points.iter().zip(&start.nodes))
            .map(|(node, (point, own))| node.dofs(bodies, &possible_directions(point, &own.directions, are_fixed)))
            .collect();
        let owner = |dofs: &Vec<usize>| dofs.iter().min().map_or(0, |dof| numbering.owner(*dof));
        let node_owners: Vec<usize> = dofs.iter().map(owner).collect();
        let interface = interface(&all, (&dofs, &node_owners), distribution, numbering);
        let own = interface.owned_count();
        let place = |(dof, value): &(usize, f64)| interface.place(*dof).map(|place| (place, *value));
        let whole = |row: &SparseRow| row.iter().filter_map(place).collect::<SparseRow>();
        let rows = |entries: fn(&EqualityRow) -> &SparseRow| {
            Csr::from_rows(interface.torn_count(), all.equality.iter().map(|row| whole(entries(row))))
        };
        let equality = [rows(|row| &row.entries), rows(|row| &row.weights)];
        let joined = cluster_rows(&all, numbering, &subdomains);
        let touched = touched(&all, &dofs, numbering.starts()[subdomains.start], own);
        let contact_owners = row_owners(boundary, &node_owners);
        let (ranks, owners) = (0..distribution.communication().size(), &contact_owners);
        let of_rank = |rank: usize| (0..owners.len()).filter(move |&row| distribution.owner(owners[row]) == rank);
        let constraints = Self {
            equality_count: all.equality.len(),
            total_equality_count: all.counts.iter().sum(),
            places: places(&all),
            own_counts: ranks.clone().map(|rank| all.counts[distribution.of(rank)].iter().sum()).collect(),
            gluing_count: all.gluing_count,
            owned_rows: (subdomains.start..=subdomains.end)
                .map(|subdomain| all.equality.partition_point(|row| row.owner < subdomain))
                .collect(),
            contact_subdomains: dofs.iter().flatten().map(|&dof| numbering.owner(dof)).collect(),
            contact_order: ranks.clone().flat_map(of_rank).collect(),
            contact_counts: ranks.map(|rank| of_rank(rank).count()).collect(),
            normalisation: contact.iter().map(|node| node.normalisation).collect(),
            joined,
            prescribed: all.equality.iter().map(|row| row.value).collect(),
            equality,
            contact,
            contact_copies: contact_copies(&nodes, &copies),
            contact_owners,
            touched,
        };
        (constraints, interface)
    }

    /// B and B_D with the contact rows of a shape.
    pub fn rows_of(
        &self,
        (bodies, rows): (&[Body], &ContactRows),
        interface: &Interface,
        distribution: &Distribution,
    ) -> TornRows {
        let (owned, own) = (distribution.owned(), interface.owned_count());
        let contact = contact_rows(&self.contact, bodies, rows);
        let place = |(dof, value): &(usize, f64)| interface.place(*dof).map(|place| (place, *value));
        let matrices = |kind: usize| {
            let within = |row: &[SparseRow; 2]| -> SparseRow { row[kind].iter().filter_map(place).collect() };
            let mut rows = self.equality[kind].clone();
            let own_rows = contact.iter().zip(&self.contact_owners);
            rows.extend(own_rows.map(|(row, owner)| if owned.contains(owner) { within(row) } else { vec![] }));
            let equality = (0..self.equality_count).map(|row| self.equality[kind].row(row).collect::<SparseRow>());
            let all = equality.chain(contact.iter().map(within)).map(|mut row| {
                row.retain(|(place, _)| *place < own);
                row
            });
            (rows, Csr::from_rows(own, all).transpose())
        };
        let ((rows, transposed), (weighted, weighted_transposed)) = (matrices(0), matrices(1));
        TornRows { rows, transposed, weighted, weighted_transposed }
    }

    /// B_E: rows × torn vector.
    pub fn equality(&self) -> &Csr {
        &self.equality[0]
    }

    /// Number of rows of this process.
    pub fn row_count(&self) -> usize {
        self.equality_count + self.contact_owners.len()
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
        let (expected, found) = (self.total_equality_count + self.contact_owners.len(), values.len());
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

/// The copies of the nodes in contact rows, by body and node.
fn contact_copies(nodes: &[HashSet<u32>], copies: &[Copies]) -> Vec<(usize, u32, Vec<usize>)> {
    let of_body = |(body, nodes): (usize, &HashSet<u32>)| {
        let mut nodes: Vec<u32> = nodes.iter().copied().collect();
        nodes.sort_unstable();
        let entry = |node: u32| (body, node, copies[body].of(node).to_vec());
        nodes.into_iter().map(entry).collect::<Vec<_>>()
    };
    nodes.iter().enumerate().flat_map(of_body).collect()
}

/// The subdomain that owns every packed contact row.
fn row_owners(boundary: &ContactBoundary, node_owners: &[usize]) -> Vec<usize> {
    let owners = boundary.points.iter().zip(node_owners);
    owners.flat_map(|(point, owner)| std::iter::repeat_n(*owner, point.row_count())).collect()
}

/// Which of the dofs of this process, from `first` on, have rows.
fn touched(all: &SceneRows, contact: &[Vec<usize>], first: usize, own: usize) -> Vec<bool> {
    let mut touched = vec![false; own];
    let mut touch = |dof: usize| touched.get_mut(dof.wrapping_sub(first)).into_iter().for_each(|t| *t = true);
    all.equality.iter().flat_map(|row| &row.entries).for_each(|(dof, _)| touch(*dof));
    all.joined.iter().flatten().flatten().for_each(|(dof, _)| touch(*dof));
    contact.iter().flatten().for_each(|&dof| touch(dof));
    touched
}

/// Places of the rows of B_E of this process among those of all.
fn places(all: &SceneRows) -> Vec<usize> {
    let mut before = vec![0; all.counts.len() + 1];
    for (subdomain, count) in all.counts.iter().enumerate() {
        before[subdomain + 1] = before[subdomain] + count;
    }
    all.equality.iter().map(|EqualityRow { owner, index, .. }| before[*owner] + index).collect()
}

/// B_c of the clusters of this process.
fn cluster_rows(all: &SceneRows, numbering: &Numbering, subdomains: &Range<usize>) -> Vec<ClusterRows> {
    let first = if subdomains.is_empty() { 0 } else { numbering.cluster_of(subdomains.start) };
    let rows = all.joined.iter().enumerate();
    let starts = |index: usize| {
        let members = numbering.members(first + index);
        &numbering.starts()[members.start..=members.end]
    };
    rows.map(|(index, rows)| ClusterRows::new(rows, starts(index))).collect()
}

/// What this process exchanges: all processes that a row of B_E touches need its dofs; those of a contact node, the
/// owner.
fn interface(
    all: &SceneRows,
    (nodes, owners): (&[Vec<usize>], &[usize]),
    distribution: &Distribution,
    numbering: &Numbering,
) -> Interface {
    let (rank, subdomains) = (distribution.communication().rank(), distribution.owned());
    let owned: Range<usize> = numbering.starts()[subdomains.start]..numbering.starts()[subdomains.end];
    let of_dof = |dof: usize| distribution.owner(numbering.owner(dof));
    let mut builder = InterfaceBuilder::default();
    if !distribution.is_alone() {
        for row in &all.equality {
            let dofs = || row.weights.iter().map(|(dof, _)| *dof);
            builder.needs(&owned, dofs());
            let touched: BTreeSet<usize> = dofs().map(of_dof).collect();
            for other in touched.into_iter().filter(|other| *other != rank) {
                builder.needed_by(other, &owned, dofs());
            }
        }
        for (dofs, &owner) in nodes.iter().zip(owners) {
            match distribution.owner(owner) {
                owner if owner == rank => builder.needs(&owned, dofs.iter().copied()),
                owner => builder.needed_by(owner, &owned, dofs.iter().copied()),
            }
        }
    }
    builder.build(owned, of_dof)
}
