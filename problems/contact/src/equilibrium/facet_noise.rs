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
use crate::equilibrium::pair::{COVERED, NO_WEIGHT};
use crate::mortar::vector::{dot, length, plus};
use crate::mortar::{Along, Face, Mortar, MortarNode, QuadraticFacet};
use crate::patches::CurvedFace;
use std::collections::{BTreeMap, BTreeSet, HashMap};

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
    /// Compares the facets of two faces, whose points are numbered after the nodes of their meshes, with the surfaces
    /// behind them.
    pub(crate) fn new(is_curved: bool, meshes: [&Mesh; 2], faces: &[CurvedFace; 2]) -> Self {
        let positions = [0, 1].map(|side| {
            let points = faces[side].points.iter().map(|point| point.place);
            meshes[side].nodes().iter().copied().chain(points).collect::<Vec<[f64; 3]>>()
        });
        let mortar = |quadratic_facets: [&[QuadraticFacet]; 2]| {
            let [slave, master] = [0, 1].map(|side| Face {
                facets: &faces[side].facets,
                positions: &positions[side],
                quadratic_facets: quadratic_facets[side],
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
            let curved = mortar([&faces[0].quadratic_facets, &faces[1].quadratic_facets]);
            by_node.extend(covered().map(|(index, node)| {
                let gap = dot(node.normal, node.distance([&positions[0], &positions[1]]));
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
fn residuals(face: &CurvedFace) -> HashMap<u32, f64> {
    let mut largest = HashMap::new();
    for (facet, &residual) in face.facets.iter().zip(&face.residuals) {
        for &corner in facet.corners() {
            let own: &mut f64 = largest.entry(corner).or_default();
            *own = own.max(residual);
        }
    }
    largest
}

/// The mean length of the edges of all facets of a face, mm.
fn mean_edge(mesh: &Mesh, face: &CurvedFace) -> f64 {
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
