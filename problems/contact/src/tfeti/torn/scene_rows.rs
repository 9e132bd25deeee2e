//! The rows of B, one after the other: what glues, what supports, and what meets the obstacle.

use crate::body::mesh::{Grid, Tearing};
use crate::equilibrium::ContactBoundary;
use crate::lattice;
use crate::scene::{BodyScene, Scene};
use std::ops::Range;

/// What the rows need to know of one body.
pub struct BodyRows<'a> {
    pub grid: &'a Grid,
    pub tearing: &'a Tearing,
    pub scene: &'a BodyScene,
    /// First torn dof of every subdomain of the tearing, of all processes.
    pub offsets: Vec<usize>,
    /// Dofs of a cluster.
    pub cluster_size: usize,
}

impl BodyRows<'_> {
    /// Torn dofs of the copies of a block node, first component.
    fn copies(&self, position: [usize; 3]) -> Vec<usize> {
        let copies = self.tearing.copies(position);
        copies.into_iter().map(|(subdomain, node)| self.offsets[subdomain] + 3 * node).collect()
    }

    /// The cluster that a node joins by rows of B_c, given its copies.
    fn joined(&self, position: [usize; 3], copies: &[usize]) -> Option<usize> {
        let cluster = copies[0] / self.cluster_size;
        let inside = copies.len() > 1 && copies.iter().all(|copy| copy / self.cluster_size == cluster);
        (inside && self.is_near_a_corner(position)).then_some(cluster)
    }

    /// Whether a node lies at a corner between subdomains, next to the end of an edge, or next to the corner of a face:
    /// few nodes, as far apart on a face as inner nodes can be, so that neighbours hardly turn against each other.
    fn is_near_a_corner(&self, position: [usize; 3]) -> bool {
        let cells = self.tearing.subdomains[0].cells;
        (0..3).all(|axis| {
            let along = position[axis] % cells[axis];
            along <= 1 || along + 1 == cells[axis]
        })
    }
}

/// Entries (torn dof, value) of one row.
pub type SparseRow = Vec<(usize, f64)>;

/// A row of B_E.
pub struct EqualityRow {
    /// The first subdomain that it touches.
    pub owner: usize,
    /// Its place among the rows of its owner.
    pub index: usize,
    pub entries: SparseRow,
}

/// The rows of a scene that concern a process, before their dofs are numbered.
pub struct SceneRows {
    /// Rows of B_E that touch its subdomains, by ascending owner.
    pub equality: Vec<EqualityRow>,
    /// Rows of B_c of its clusters.
    pub joined: Vec<Vec<SparseRow>>,
    /// Number of rows of B_E of every subdomain.
    pub counts: Vec<usize>,
    pub gluing_count: usize,
    /// All contact rows of B and B_D.
    pub contact: Vec<[SparseRow; 2]>,
    /// ν of every contact node.
    pub normalisation: Vec<f64>,
}

impl SceneRows {
    /// The rows of B_E that touch a subdomain of `own`, and all contact rows; `count` subdomains of `size` dofs each.
    pub fn new(
        scene: &Scene,
        bodies: &[BodyRows<'_>],
        boundary: &ContactBoundary,
        own: &Range<usize>,
        [count, size]: [usize; 2],
    ) -> Self {
        let (mut equality, mut counts, mut gluing_count) = (Vec::new(), vec![0; count], 0);
        let clusters = own.start * size / bodies[0].cluster_size..own.end * size / bodies[0].cluster_size;
        let mut joined = vec![Vec::new(); clusters.len()];
        for body in bodies {
            gluing_count += equality_rows(body, |cluster: Option<usize>, entries: SparseRow| {
                if let Some(cluster) = cluster {
                    if clusters.contains(&cluster) {
                        joined[cluster - clusters.start].push(entries);
                    }
                    return;
                }
                let owner = first_subdomain(&entries, size);
                if entries.iter().any(|(dof, _)| own.contains(&(dof / size))) {
                    equality.push(EqualityRow { owner, index: counts[owner], entries });
                }
                counts[owner] += 1;
            });
        }
        equality.sort_by_key(|row| row.owner);
        let (mut contact, mut normalisation) = (Vec::new(), Vec::with_capacity(boundary.points.len()));
        for point in &boundary.points {
            let mut scale = None;
            for component in std::iter::once(2).chain(point.tangents.iter().copied()) {
                let parts = contact_parts(scene, bodies, point.position, component);
                let squared: f64 = parts.iter().map(|part| 1.0 / part.copies.len() as f64).sum();
                let nu = *scale.get_or_insert(squared.sqrt());
                contact.push(contact_row(&parts, nu));
            }
            normalisation.push(scale.unwrap_or(1.0));
        }
        Self { equality, joined, counts, gluing_count, contact, normalisation }
    }
}

/// The first subdomain that a row touches.
pub fn first_subdomain(row: &SparseRow, size: usize) -> usize {
    row.iter().map(|(dof, _)| dof / size).min().unwrap_or(0)
}

/// Visits the rows of supports and gluing of one body, with the cluster whose row of B_c they are; returns the number
/// of gluing rows of B_E.
fn equality_rows(body: &BodyRows<'_>, mut visit: impl FnMut(Option<usize>, SparseRow)) -> usize {
    let mut gluing_count = 0;
    for node in lattice::points([0; 3], body.grid.nodes()) {
        let copies = body.copies(node);
        let joined = body.joined(node, &copies);
        for (component, held) in body.scene.held(body.grid, node).into_iter().enumerate() {
            if held {
                copies.iter().for_each(|first| visit(None, vec![(first + component, 1.0)]));
                continue;
            }
            for last in 1..copies.len() {
                let scale = 1.0 / ((last * (last + 1)) as f64).sqrt();
                let mut row: SparseRow = copies[..last].iter().map(|first| (first + component, scale)).collect();
                row.push((copies[last] + component, -(last as f64) * scale));
                visit(joined, row);
                gluing_count += usize::from(joined.is_none());
            }
        }
    }
    gluing_count
}

/// The copies of one body in a contact row.
struct ContactPart {
    sign: f64,
    copies: Vec<usize>,
    compliance: f64,
}

/// The bodies whose dof `component` is free at a contact node.
fn contact_parts(scene: &Scene, bodies: &[BodyRows<'_>], [i, j]: [usize; 2], component: usize) -> Vec<ContactPart> {
    let mut parts = Vec::with_capacity(2);
    for (index, body) in bodies.iter().enumerate() {
        let (layer, sign) = if index == 0 { (scene.mesh[2], 1.0) } else { (0, -1.0) };
        let position = [i, j, layer];
        if !body.scene.held(body.grid, position)[component] {
            let copies = body.copies(position).into_iter().map(|first| first + component).collect();
            parts.push(ContactPart { sign, copies, compliance: 1.0 / body.scene.material.young_modulus() });
        }
    }
    parts
}

/// A row of B and of B_D.
fn contact_row(parts: &[ContactPart], nu: f64) -> [SparseRow; 2] {
    // SparseRow entries s/(mν); weights ω s/(mν) with Σ ω/(mν²) = 1 and ω proportional to the body's compliance.
    let total: f64 = parts.iter().map(|part| part.compliance / (part.copies.len() as f64 * nu * nu)).sum();
    let (mut row, mut weights) = (Vec::new(), Vec::new());
    for part in parts {
        let entry = part.sign / (part.copies.len() as f64 * nu);
        for &dof in &part.copies {
            row.push((dof, entry));
            weights.push((dof, entry * part.compliance / total));
        }
    }
    [row, weights]
}
