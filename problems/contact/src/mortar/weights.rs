//! Mortar weights of the nodes of the slave surface.
//!
//! ```text
//! of facets of second degree:  gap_i = Σ_e ∫ ψ_i ν·(Y_m − Y_s) / D_i,   N_i = Σ_e ∫ ψ_i ν,   n_i = N_i/|N_i|
//! D_i = Σ_e D_e,i,   m_ij = Σ_e W_e,ij / D_i,   A_i = Σ_e ∫_whole N_i,   covered share = D_i / A_i
//! ```

use super::Along;
use super::cover::Cover;
use super::facet::{Face, Patch};
use super::frame::Bound;
use super::normals::{unit, vector_areas};
use super::opposite_facets::OppositeFacets;
use super::pair::{GAP, Jacobian, NORMAL};
use crate::linear::parallel;
use std::sync::OnceLock;

/// Nodes covered less than this have no weights.
const UNCOVERED: f64 = 1e-14;

/// A node of the slave surface.
#[derive(Debug, Clone, PartialEq)]
pub struct MortarNode {
    pub node: u32,
    /// Outward unit normal of the slave surface; zero if the vector areas of its facets cancel.
    pub normal: [f64; 3],
    /// D_i: the integral of the shape function over the covered part; 0 if nothing covers the facets of the node.
    pub area: f64,
    /// D_i / A_i.
    pub covered: f64,
    /// A_i: the integral of the shape function over all facets of the node.
    pub whole: f64,
    /// Nodes of the master surface, ascending, and weights that add up to 1; none if `area` is 0. Weights that vanish
    /// only by chance are listed, since their derivatives do not.
    pub weights: Vec<(u32, f64)>,
    /// Of facets of second degree, ∫ ψ_i ν·(Y_m − Y_s)/D_i, mm; 0 for flat facets and where `area` is 0.
    pub gap: f64,
}

impl MortarNode {
    /// Σ_j m_ij x_j − x_i, mm, for the positions of the nodes of both surfaces.
    pub fn distance(&self, [slave, master]: [&[[f64; 3]]; 2]) -> [f64; 3] {
        let x = slave[self.node as usize];
        let mean = |axis: usize| self.weights.iter().map(|(j, m)| m * master[*j as usize][axis]).sum::<f64>();
        std::array::from_fn(|axis| mean(axis) - x[axis])
    }
}

/// The coupling of two surfaces.
#[derive(Debug)]
pub struct Mortar {
    /// All nodes of the slave facets, ascending.
    pub nodes: Vec<MortarNode>,
    pub(super) along: Along,
    pub(super) slave: Patch,
    /// Its facets are reversed.
    pub(super) master: Patch,
    /// Per slave facet; None where it is seen edge-on.
    pub(super) covers: Vec<Option<Cover>>,
    /// First place of each node in the list of all weights, and the end.
    pub(super) starts: Vec<usize>,
    /// N_i.
    pub(super) vector_areas: Vec<[f64; 3]>,
    /// Per slave facet and pair.
    pub(super) jacobians: OnceLock<Vec<Vec<Jacobian>>>,
}

impl Mortar {
    /// Couple the nodes of the slave surface with the master surface.
    pub fn new(slave: Face<'_>, master: Face<'_>, along: Along) -> Self {
        let (slave, master) = (Patch::new(slave), Patch::new(master).reversed());
        let bound = |facet: usize| Bound::of_reversed(&master.corners(facet)[..master.count(facet)]);
        let opposite = OppositeFacets::new((0..master.facets.len()).map(bound));
        let cover = |facet: usize| Cover::new(facet, &slave, (&master, &opposite), along);
        let mut covers: Vec<Option<Cover>> = parallel::map(slave.facets.len(), &cover);
        let (starts, columns) = number(&mut covers, &slave, &master);
        let vector_areas = vector_areas(&slave);
        let mut mortar =
            Self { nodes: Vec::new(), along, slave, master, covers, starts, vector_areas, jacobians: OnceLock::new() };
        mortar.nodes = mortar.assembled(&columns);
        mortar
    }

    /// Whether facets are of second degree.
    pub fn is_quadratic(&self) -> bool {
        !self.slave.quadratic_facets.is_empty() && !self.master.quadratic_facets.is_empty()
    }

    /// Σ over the pairs of a slave facet of gap and normal of a corner.
    fn add_quadratic(&mut self, gaps: &mut [f64]) {
        let mut normals = vec![[0.0; 3]; gaps.len()];
        for (facet, cover) in self.covers() {
            for (corner, &node) in self.slave.facets[facet].corners().iter().enumerate() {
                for weights in cover.pairs.iter().map(|pair| &pair.weights[corner]) {
                    gaps[node] += weights[GAP];
                    (0..3).for_each(|axis| normals[node][axis] += weights[NORMAL + axis]);
                }
            }
        }
        // Nodes that nothing covers keep the vector areas of their facets.
        for (own, normal) in self.vector_areas.iter_mut().zip(normals) {
            if normal != [0.0; 3] {
                *own = normal;
            }
        }
    }

    /// Slave facets in a plane, with their numbers.
    pub(super) fn covers(&self) -> impl Iterator<Item = (usize, &Cover)> {
        self.covers.iter().enumerate().filter_map(|(facet, cover)| Some((facet, cover.as_ref()?)))
    }

    fn assembled(&mut self, columns: &[usize]) -> Vec<MortarNode> {
        let count = self.slave.nodes.len();
        let mut gaps = vec![0.0; count];
        if self.is_quadratic() {
            self.add_quadratic(&mut gaps);
        }
        let (mut areas, mut whole) = (vec![0.0; count], vec![0.0; count]);
        let mut values = vec![0.0; columns.len()];
        for (facet, cover) in self.covers() {
            let sums = cover.basis.as_ref().map_or([0.0; 4], |basis| basis.sums);
            for (corner, &node) in self.slave.facets[facet].corners().iter().enumerate() {
                areas[node] += sums[corner];
                whole[node] += cover.whole[corner];
            }
            self.scatter(facet, cover, |slot, pair, i, j| values[slot] += cover.pairs[pair].weights[i][j]);
        }
        let normal = |node: usize| match self.along {
            Along::X3 => [0.0, 0.0, 1.0],
            Along::Normals => unit(self.vector_areas[node]),
        };
        let node = |node: usize| {
            let covered = areas[node] > UNCOVERED * whole[node];
            let area = if covered { areas[node] } else { 0.0 };
            let places = if covered { self.starts[node]..self.starts[node + 1] } else { 0..0 };
            let weight = |place: usize| (self.master.nodes[columns[place]], values[place] / area);
            MortarNode {
                node: self.slave.nodes[node],
                normal: normal(node),
                area,
                covered: if covered { area / whole[node] } else { 0.0 },
                whole: whole[node],
                weights: places.map(weight).collect(),
                gap: if covered { gaps[node] / area } else { 0.0 },
            }
        };
        (0..count).map(node).collect()
    }

    /// Visit the entries of W of a slave facet: place in the list of all weights, pair, row, column.
    pub(super) fn scatter(&self, facet: usize, cover: &Cover, mut visit: impl FnMut(usize, usize, usize, usize)) {
        for (number, pair) in cover.pairs.iter().enumerate() {
            for i in 0..self.slave.count(facet) {
                (0..self.master.count(pair.master)).for_each(|j| visit(pair.slots[i][j], number, i, j));
            }
        }
    }
}

/// Number the weights by slave node and master node: first places of the nodes, master node of each place.
fn number(covers: &mut [Option<Cover>], slave: &Patch, master: &Patch) -> (Vec<usize>, Vec<usize>) {
    let mut keys: Vec<(usize, usize)> = Vec::new();
    for (facet, cover) in covers.iter().enumerate() {
        for pair in cover.iter().flat_map(|cover| &cover.pairs) {
            let columns = master.facets[pair.master].corners();
            let rows = slave.facets[facet].corners();
            keys.extend(rows.iter().flat_map(|&row| columns.iter().map(move |&column| (row, column))));
        }
    }
    keys.sort_unstable();
    keys.dedup();
    for (facet, cover) in covers.iter_mut().enumerate() {
        for pair in cover.iter_mut().flat_map(|cover| &mut cover.pairs) {
            let rows = slave.facets[facet].pick_numbers();
            let columns = master.facets[pair.master].pick_numbers();
            pair.slots = rows.map(|row| columns.map(|column| keys.partition_point(|&key| key < (row, column))));
        }
    }
    let starts = (0..=slave.nodes.len()).map(|node| keys.partition_point(|&(row, _)| row < node)).collect();
    (starts, keys.into_iter().map(|(_, column)| column).collect())
}
