//! How much of the pressures between two curved faces may be a work of their facets.
//!
//! ```text
//! p_f = π E* s/(2 h)
//! flat facets:  s = max |Δ − mean Δ| over the closed nodes and those beside them, which facets may keep open;
//!               Δ: gap of surfaces less gap of facets
//! surfaces:     s = the largest distance of a patch from the true surface, as the fit shows it
//! h: larger mean edge of the facets of both faces,   1/E* = Σ (1 − ν²)/E
//! ```

use crate::body::mesh::Mesh;
use crate::equilibrium::contact_part::{COVERED, NO_WEIGHT};
use crate::mortar::vector::{length, plus};
use crate::mortar::{Along, Bend, Face, Mortar, MortarNode};
use crate::patches::BentFace;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Of a surface of third degree, z = c x³, a quadric over two rings of width h leaves 2/5 c (2h)³ = 3.2 c h³, and a patch
/// over one facet max |t (t − 1/2) (t − 1)| c h³ = 0.048 c h³. The share is taken twice, for the error of the middles.
const ONE_RING: f64 = 2.0 * 0.048 / 3.2;

/// What is known about the faces of a contact at the shape of the meshes.
#[derive(Debug, Clone)]
pub(crate) struct FacetNoise {
    /// Whether gaps are those of surfaces.
    pub(crate) is_curved: bool,
    /// By slave node, mm: Δ of flat facets, or the distance of patches on both sides from the true surface.
    by_node: BTreeMap<u32, f64>,
    /// The nodes of all facets about every slave node.
    beside: BTreeMap<u32, BTreeSet<u32>>,
    /// h, mm.
    pub(crate) width: f64,
}

impl FacetNoise {
    /// Compares the facets of two faces with the surfaces behind them.
    pub(crate) fn new(is_curved: bool, meshes: [&Mesh; 2], faces: &[BentFace; 2]) -> Self {
        let positions = [0, 1].map(|side| {
            let points = faces[side].own_points();
            meshes[side].nodes().iter().chain(points).copied().collect::<Vec<[f64; 3]>>()
        });
        let bends = [0, 1].map(|side| faces[side].own_bends(meshes[side].node_count()));
        let mortar = |bends: [&[Bend]; 2]| {
            let [slave, master] = [0, 1].map(|side| Face {
                facets: &faces[side].facets,
                positions: &positions[side],
                bends: bends[side],
            });
            Mortar::new(slave, master, Along::Normals)
        };
        let flat = mortar([&[], &[]]);
        let weights = |node: &MortarNode| node.weights.iter().filter(|(_, weight)| weight.abs() > NO_WEIGHT).count();
        let covered = || flat.nodes.iter().enumerate().filter(|(_, node)| node.covered >= COVERED);
        // Between equal facets, what one face lacks the other lacks as well.
        let is_equal = covered().all(|(_, node)| weights(node) == 1);
        let mut by_node = BTreeMap::new();
        if !is_equal && is_curved {
            let [slave, master] = [0, 1].map(|side| residuals(&faces[side]));
            let at = |residuals: &HashMap<u32, f64>, node: u32| residuals.get(&node).copied().unwrap_or(0.0);
            by_node.extend(covered().map(|(_, node)| {
                let masters = node.weights.iter().filter(|(_, weight)| weight.abs() > NO_WEIGHT);
                let other = masters.map(|(node, _)| at(&master, *node));
                (node.node, at(&slave, node.node) + other.fold(0.0, f64::max))
            }));
        } else if !is_equal {
            let curved = mortar([&bends[0], &bends[1]]);
            by_node.extend(covered().map(|(index, node)| {
                let x = positions[0][node.node as usize];
                let other =
                    |axis: usize| node.weights.iter().map(|(m, w)| w * positions[1][*m as usize][axis]).sum::<f64>();
                let gap: f64 = (0..3).map(|axis| node.normal[axis] * (other(axis) - x[axis])).sum();
                (node.node, curved.nodes[index].gap - gap)
            }));
        }
        let width = [0, 1].map(|side| mean_edge(meshes[side], &faces[side])).into_iter().fold(0.0, f64::max);
        let mut beside: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for corners in faces[0].facets.iter().map(|facet| facet.corners()) {
            corners.iter().for_each(|&corner| beside.entry(corner).or_default().extend(corners));
        }
        Self { is_curved, by_node, beside, width }
    }

    /// s over some closed nodes, mm.
    pub(crate) fn size(&self, closed: &[u32]) -> f64 {
        if self.is_curved {
            return closed.iter().filter_map(|node| self.by_node.get(node)).fold(0.0, |largest, own| largest.max(*own));
        }
        let about: BTreeSet<u32> = closed.iter().filter_map(|node| self.beside.get(node)).flatten().copied().collect();
        let values = || about.iter().filter_map(|node| self.by_node.get(node));
        let mean = values().sum::<f64>() / values().count().max(1) as f64;
        values().map(|value| (value - mean).abs()).fold(0.0, f64::max)
    }
}

/// The largest residual of the facets about every corner, mm.
fn residuals(face: &BentFace) -> HashMap<u32, f64> {
    let mut largest = HashMap::new();
    for (facet, &residual) in face.facets.iter().zip(&face.residuals) {
        for &corner in facet.corners() {
            let own: &mut f64 = largest.entry(corner).or_default();
            *own = own.max(ONE_RING * residual);
        }
    }
    largest
}

/// The mean length of the edges of all facets of a face, mm.
fn mean_edge(mesh: &Mesh, face: &BentFace) -> f64 {
    let x = |node: u32| mesh.nodes()[node as usize];
    let (mut sum, mut count) = (0.0, 0);
    for corners in face.facets.iter().map(|facet| facet.corners()) {
        for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            sum += length(plus(x(b), -1.0, x(a)));
            count += 1;
        }
    }
    sum / f64::from(count.max(1))
}
