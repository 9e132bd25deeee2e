//! The rows of B, one after the other: what glues, what supports, and what meets the counter surface.

use crate::body::{Body, TraceWeights, onto};
use crate::equilibrium::{ContactBoundary, ContactPoint, ContactRows, NodeRows};
use crate::tfeti::torn::copies::Copies;
use crate::tfeti::torn::joints::Joints;
use crate::tfeti::torn::numbering::Numbering;
use nalgebra::DMatrix;
use std::cmp::Ordering;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Entries (torn dof, value) of one row.
pub type SparseRow = Vec<(usize, f64)>;

/// A row of B_E.
pub struct EqualityRow {
    /// The first subdomain that it touches.
    pub owner: usize,
    /// Its place among the rows of its owner.
    pub index: usize,
    pub entries: SparseRow,
    /// The row of B_D.
    pub weights: SparseRow,
    /// The entry of c_E: the displacement that a support prescribes, mm; 0 for gluing.
    pub value: f64,
}

/// The rows of B_E that concern a process, before their dofs are numbered.
pub struct SceneRows {
    /// Rows of B_E that touch its subdomains, by ascending owner.
    pub equality: Vec<EqualityRow>,
    /// Rows of B_c of its clusters.
    pub joined: Vec<Vec<SparseRow>>,
    /// Number of rows of B_E of every subdomain.
    pub counts: Vec<usize>,
    pub gluing_count: usize,
}

impl SceneRows {
    /// The rows of B_E that touch a subdomain of `own`; `contact`: the contact nodes of every body.
    pub fn new(
        (bodies, contact): (&[Body], &[HashSet<u32>]),
        copies: &[Copies],
        numbering: &Numbering,
        own: &Range<usize>,
        joints: &Joints,
    ) -> Self {
        let (mut equality, mut counts, mut gluing_count) = (Vec::new(), vec![0; numbering.count()], 0);
        let own_clusters = match own.is_empty() {
            true => 0..0,
            false => numbering.cluster_of(own.start)..numbering.cluster_of(own.end - 1) + 1,
        };
        let mut joined = vec![Vec::new(); own_clusters.len()];
        for (number, (body, copies)) in bodies.iter().zip(copies).enumerate() {
            let mut visit = |cluster: Option<usize>, [entries, weights]: [SparseRow; 2], value: f64| {
                if let Some(cluster) = cluster {
                    if own_clusters.contains(&cluster) {
                        joined[cluster - own_clusters.start].push(entries);
                    }
                    return;
                }
                let owner = first_subdomain(&entries, numbering);
                // Its weights may reach copies that the row itself does not.
                if weights.iter().any(|(dof, _)| own.contains(&numbering.owner(*dof))) {
                    equality.push(EqualityRow { owner, index: counts[owner], entries, weights, value });
                }
                counts[owner] += 1;
            };
            for node in 0..body.mesh.node_count() as u32 {
                let joint = joints.cluster_of(number, node);
                let scaled = !contact[number].contains(&node);
                gluing_count += node_rows(body, node, (copies, scaled), joint, &mut visit);
            }
        }
        equality.sort_by_key(|row| row.owner);
        Self { equality, joined, counts, gluing_count }
    }
}

/// The first subdomain that a row touches.
pub fn first_subdomain(row: &SparseRow, numbering: &Numbering) -> usize {
    row.iter().map(|(dof, _)| *dof).min().map_or(0, |dof| numbering.owner(dof))
}

/// A row along a direction at one copy, times a factor.
fn along(first: usize, direction: &[f64; 3], factor: f64) -> impl Iterator<Item = (usize, f64)> {
    let entries = direction.map(|d| factor * d);
    (0..3).map(move |axis| (first + axis, entries[axis])).filter(|(_, entry)| *entry != 0.0)
}

/// Visits the rows of supports and gluing of one node, with the cluster whose row of B_c they are and the prescribed
/// jump; returns the number of gluing rows of B_E.
fn node_rows(
    body: &Body,
    node: u32,
    (all, scaled): (&Copies, bool),
    joined: Option<usize>,
    visit: &mut impl FnMut(Option<usize>, [SparseRow; 2], f64),
) -> usize {
    let copies = all.of(node);
    let prescribed = body.prescribed(node);
    for direction in body.held(node) {
        let value = (0..3).map(|axis| direction[axis] * prescribed[axis]).sum();
        let row = |first: usize| along(first, direction, 1.0).collect::<SparseRow>();
        copies.iter().for_each(|&first| visit(None, [row(first), row(first)], value));
    }
    if copies.len() < 2 {
        return 0;
    }
    let free = body.free(node);
    let rows = helmert(copies.len());
    let weights = if scaled { weighted(&rows, all.stiffness_of(node)) } else { rows.clone() };
    for direction in &free {
        for (row, weights) in rows.iter().zip(&weights) {
            let of = |factors: &[f64]| -> SparseRow {
                copies.iter().zip(factors).flat_map(|(&first, &factor)| along(first, direction, factor)).collect()
            };
            visit(joined, [of(row), of(weights)], 0.0);
        }
    }
    if joined.is_none() { free.len() * (copies.len() - 1) } else { 0 }
}

/// The m − 1 Helmert rows of m copies: orthonormal, and each of sum zero.
fn helmert(count: usize) -> Vec<Vec<f64>> {
    let row = |last: usize| {
        let scale = 1.0 / ((last * (last + 1)) as f64).sqrt();
        let entry = |copy: usize| match copy.cmp(&last) {
            Ordering::Less => scale,
            Ordering::Equal => -(last as f64) * scale,
            Ordering::Greater => 0.0,
        };
        (0..count).map(entry).collect()
    };
    (1..count).map(row).collect()
}

/// (H W Hᵀ)⁻¹ H W with the compliances W of the copies: the share of a jump that each of them takes is larger the
/// softer its subdomain is there.
fn weighted(rows: &[Vec<f64>], stiffness: &[f64]) -> Vec<Vec<f64>> {
    let soft = DMatrix::from_fn(rows.len(), stiffness.len(), |i, copy| rows[i][copy] / stiffness[copy]);
    let product = DMatrix::from_fn(rows.len(), rows.len(), |i, j| {
        soft.row(i).iter().zip(&rows[j]).map(|(soft, entry)| soft * entry).sum::<f64>()
    });
    match product.cholesky() {
        Some(factor) => factor.solve(&soft).row_iter().map(|row| row.iter().copied().collect()).collect(),
        None => rows.to_vec(),
    }
}

/// The nodes in the rows of a contact node with their copies and free directions: what its rows are made of at any
/// shape.
#[derive(Debug)]
pub struct ContactNode {
    /// ν at the start: all rows of the node are divided by it.
    pub normalisation: f64,
    /// Body and node of every side.
    sides: Vec<(usize, u32)>,
    parts: Vec<ContactPart>,
    /// The parts by body and node.
    places: HashMap<(usize, u32), usize>,
}

#[derive(Debug)]
struct ContactPart {
    copies: Vec<usize>,
    compliance: f64,
    free: Vec<[f64; 3]>,
}

impl ContactNode {
    /// A contact node with its rows at the start.
    pub fn new(
        (point, rows): (&ContactPoint, &NodeRows),
        (bodies, traces): (&[Body], &[TraceWeights]),
        copies: &[Copies],
        cell_of: &[HashMap<u32, u32>],
    ) -> Self {
        let (mut parts, mut places) = (Vec::new(), HashMap::new());
        for side in &point.sides {
            let body = &bodies[side.body];
            let nodes = std::iter::once(side.node).chain(body.trace.support(side.node));
            for node in nodes {
                let free = body.free(node);
                if free.is_empty() || places.contains_key(&(side.body, node)) {
                    continue;
                }
                let cell = cell_of[side.body].get(&node).copied().unwrap_or(0);
                let compliance = 1.0 / body.solid.material(cell as usize).young_modulus();
                places.insert((side.body, node), parts.len());
                parts.push(ContactPart { copies: copies[side.body].of(node).to_vec(), compliance, free });
            }
        }
        let mut sums = vec![0.0; parts.len()];
        for (side, weight) in point.sides.iter().zip(&rows.weights) {
            bodies[side.body].trace.spread_scalar(&traces[side.body], side.node, *weight, &mut |node, share| {
                places.get(&(side.body, node)).into_iter().for_each(|&part: &usize| sums[part] += share);
            });
        }
        let squared: f64 = sums.iter().zip(&parts).map(|(sum, part)| sum.powi(2) / part.copies.len() as f64).sum();
        let sides = point.sides.iter().map(|side| (side.body, side.node)).collect();
        Self { normalisation: squared.sqrt(), sides, parts, places }
    }

    /// A row of B and of B_D for a direction and the weights of the sides.
    fn row(&self, direction: [f64; 3], weights: &[f64], (bodies, rows): (&[Body], &ContactRows)) -> [SparseRow; 2] {
        let nu = self.normalisation;
        // Sums over the sides: of the row, a vector with its factor, and of displacements that no row of others sees.
        let mut vectors = vec![([0.0; 3], 1.0); self.parts.len()];
        let mut hats = vec![0.0; self.parts.len()];
        let mut total = 0.0;
        for (&(body, side), weight) in self.sides.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let trace = &bodies[body].trace;
            let place = |node: u32| self.places.get(&(body, node)).copied();
            if trace.is_nodal(side) {
                place(side).into_iter().for_each(|part| vectors[part] = (direction, *weight));
            } else {
                trace.spread(&rows.traces[body], side, direction.map(|d| weight * d), &mut |node, share| {
                    let Some(part) = place(node) else { return };
                    (0..3).for_each(|axis| vectors[part].0[axis] += share[axis]);
                });
            }
            let Some(own) = place(side).map(|part| &self.parts[part]) else { continue };
            // Entries w d/(mν); weights ω w d/(mν) with Σ ω w²|d|²/(mν²) = 1 and ω proportional to the compliance.
            let (copies, square) = (own.copies.len() as f64, square(onto(&own.free, direction)));
            total += own.compliance * weight.powi(2) * square / (copies * nu * nu);
            let factor = weight / (copies * nu) * own.compliance;
            trace.hat(side, |node, share| place(node).into_iter().for_each(|part| hats[part] += share * factor));
        }
        let (mut row, mut weighted) = (Vec::new(), Vec::new());
        for (part, ((vector, weight), hat)) in self.parts.iter().zip(vectors.iter().zip(&hats)) {
            let factor = weight / (part.copies.len() as f64 * nu);
            for &first in &part.copies {
                row.extend(along(first, &onto(&part.free, *vector), factor));
                weighted.extend(along(first, &onto(&part.free, direction), hat / total));
            }
        }
        [row, weighted]
    }

    /// All torn dofs that rows along some directions may have entries at: of a row along an axis, that axis alone.
    pub fn dofs(&self, bodies: &[Body], directions: &[[f64; 3]]) -> Vec<usize> {
        let mut axes = vec![[false; 3]; self.parts.len()];
        for &(body, side) in &self.sides {
            let trace = &bodies[body].trace;
            for node in trace.support(side) {
                let Some(&part) = self.places.get(&(body, node)) else { continue };
                for direction in directions {
                    let own = if node == side { *direction } else { trace.projected(side, *direction) };
                    let found = onto(&self.parts[part].free, own);
                    (0..3).for_each(|axis| axes[part][axis] |= found[axis] != 0.0);
                }
            }
        }
        let of_part = |(part, axes): (&ContactPart, &[bool; 3])| {
            let axes: Vec<usize> = (0..3).filter(|&axis| axes[axis]).collect();
            part.copies.iter().flat_map(|&first| axes.iter().map(move |axis| first + axis)).collect::<Vec<_>>()
        };
        self.parts.iter().zip(&axes).flat_map(of_part).collect()
    }
}

/// Directions that the rows of a node may take at any shape: those of given rows where they are fixed, else all free
/// ones.
pub fn possible_directions(point: &ContactPoint, rows: &[[f64; 3]], are_fixed: bool) -> Vec<[f64; 3]> {
    if are_fixed { rows.to_vec() } else { point.free.clone() }
}

fn square(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum()
}

/// A cell of every node in contact rows of every body: its material weighs the rows of the node.
pub fn contact_cells(boundary: &ContactBoundary, bodies: &[Body]) -> Vec<HashMap<u32, u32>> {
    let mut cells = vec![HashMap::new(); bodies.len()];
    for side in boundary.points.iter().flat_map(|point| &point.sides) {
        cells[side.body].extend(bodies[side.body].trace.support(side.node).into_iter().map(|node| (node, u32::MAX)));
    }
    for (body, cells) in bodies.iter().zip(&mut cells) {
        for (number, cell) in body.mesh.cells().enumerate() {
            for node in cell.nodes {
                if let Some(found) = cells.get_mut(node).filter(|found| **found == u32::MAX) {
                    *found = number as u32;
                }
            }
        }
    }
    cells
}

/// The contact rows of B and B_D of a shape.
pub fn contact_rows(nodes: &[ContactNode], bodies: &[Body], rows: &ContactRows) -> Vec<[SparseRow; 2]> {
    let of_node = |(node, own): (&ContactNode, &NodeRows)| {
        let directions = own.directions.iter();
        directions.map(|direction| node.row(*direction, &own.weights, (bodies, rows))).collect::<Vec<_>>()
    };
    nodes.iter().zip(&rows.nodes).flat_map(of_node).collect()
}
