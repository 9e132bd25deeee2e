//! The face of another body opposite to a slave face: mortar integrals of both.
//!
//! ```text
//! facets of second degree:  g = ∫ ψ_i ν·(Y_m − Y_s)/D_i,       flat facets:  g = n·v,  v = Σ_j m_ij x_j − x_i
//! ```

use crate::body::Body;
use crate::body::mesh::{CellFace, bounding_box};
use crate::equilibrium::contact_point::ContactPoint;
use crate::equilibrium::numbers::{Numbers, Placed};
use crate::equilibrium::opposite::{Facing, Opposite};
use crate::equilibrium::pair_at::{PairAt, distance};
use crate::equilibrium::pair_sides::possible_masters;
use crate::error::ContactError;
use crate::mortar::vector::dot;
use crate::mortar::{Along, Face, Facet, Mortar, MortarNode, QuadraticFacet};
use crate::patches::CurvedFace;
use crate::scene::{ContactScene, NormalKind};
use crate::shape::{Positions, ShapeMap};
use std::sync::Arc;

/// Part of the area of a slave node from which the master counts as lying opposite to it: with less, weights are large
/// and say nothing.
pub(crate) const COVERED: f64 = 1e-3;

/// Weights up to this size are rounding of zero, as between equal grids.
pub(crate) const NO_WEIGHT: f64 = 1e-12;

/// The facets of two bodies that lie opposite to each other: those of the slave, then those of the master.
#[derive(Debug, Clone)]
pub(crate) struct Sides {
    pub bodies: [usize; 2],
    facets: [Vec<Facet>; 2],
    /// Middles of the edges of both; none for flat facets.
    quadratic_facets: [Vec<QuadraticFacet>; 2],
}

/// Two faces in contact.
#[derive(Debug, Clone)]
pub(crate) struct Pair {
    sides: Sides,
    along: Along,
    /// Whether normals along x₃ point downwards.
    is_downward: bool,
    /// The gap of nodes that the master does not lie opposite to, mm: the diagonal of the slave face.
    away: f64,
    /// What makes the gaps of the start the stated clearance, per slave node, mm; none where the faces tell the gaps.
    offsets: Vec<f64>,
    /// The mortar integrals of the start.
    start: Arc<Mortar>,
    is_fixed: bool,
    is_tied: bool,
}

impl Sides {
    /// Facets of two bodies, by number.
    pub(crate) fn new(of: [(usize, &Body, &[CellFace]); 2], curved: Option<&[CurvedFace; 2]>) -> Self {
        let facets = of.map(|(_, body, faces)| {
            let facet = |face: &CellFace| {
                let (nodes, corners) = body.mesh.face_with_corners(*face);
                Facet::new(&nodes[..corners])
            };
            faces.iter().filter_map(facet).collect()
        });
        let quadratic_facets =
            curved.map_or_else(Default::default, |faces| [0, 1].map(|side| faces[side].quadratic_facets.clone()));
        Self { bodies: of.map(|(number, ..)| number), facets, quadratic_facets }
    }

    /// The mortar integrals at the positions of all nodes.
    fn mortar(&self, positions: &Positions, along: Along) -> Mortar {
        let [slave, master] = [0, 1].map(|side| Face {
            facets: &self.facets[side],
            positions: &positions[self.bodies[side]],
            quadratic_facets: &self.quadratic_facets[side],
        });
        Mortar::new(slave, master, along)
    }
}

impl Pair {
    /// The two faces of a contact with the contact nodes and the number of slave nodes that nothing lies opposite to.
    /// `reach`: the largest move of both bodies along their faces, mm.
    pub(crate) fn new(
        contact: &ContactScene,
        sides: Sides,
        (map, reach): (&ShapeMap, f64),
        start: &Positions,
    ) -> (Self, Vec<(u32, Vec<u32>)>, usize) {
        let along = if contact.normal == NormalKind::X3 { Along::X3 } else { Along::Normals };
        let is_fixed = !sides.bodies.iter().any(|&body| match along {
            Along::X3 => map.moves_along(body, 0) || map.moves_along(body, 1),
            Along::Normals => map.shapes(body),
        });
        let mortar = sides.mortar(start, along);
        let is_covered = |node: &&MortarNode| node.covered >= COVERED;
        let covered = || mortar.nodes.iter().filter(is_covered);
        let uncovered = mortar.nodes.len() - covered().count();
        let [slave, master] = sides.bodies.map(|body| start[body].as_slice());
        let nodes = match is_fixed {
            _ if uncovered == mortar.nodes.len() => Vec::new(),
            true => {
                let masters = |node: &MortarNode| {
                    let weights = node.weights.iter().filter(|(_, w)| w.abs() > NO_WEIGHT);
                    (node.node, weights.map(|(node, _)| *node).collect())
                };
                covered().map(masters).collect()
            }
            false => {
                // A node that the master leaves carries no force, and one that it reaches may: glued ones cannot.
                let taken = mortar.nodes.iter().filter(|node| !contact.is_tied() || is_covered(node));
                possible_masters(taken, &sides.facets, [slave, master], reach)
            }
        };
        let corners = sides.facets[0].iter().flat_map(|facet| facet.corners()).map(|&node| slave[node as usize]);
        let [least, most] = bounding_box(&corners.collect::<Vec<_>>());
        let away = (0..3).map(|axis| (most[axis] - least[axis]).powi(2)).sum::<f64>().sqrt();
        let is_downward = along == Along::X3 && faces_down(&sides.facets[0], slave);
        let (start_mortar, is_tied) = (Arc::new(mortar), contact.is_tied());
        let offsets = Vec::new();
        let mut pair = Self { sides, along, is_downward, away, offsets, start: start_mortar, is_fixed, is_tied };
        if let Some(clearance) = contact.clearance {
            pair.offsets = pair.offsets_for(clearance, [slave, master]);
        }
        (pair, nodes, uncovered)
    }

    /// The outward normal of a slave node.
    fn outward(&self, normal: [f64; 3]) -> [f64; 3] {
        if self.is_downward { normal.map(|n| -n) } else { normal }
    }

    /// What added to the gaps of the start gives a clearance. Nodes that nothing lies opposite to at the start have the
    /// mean of the others.
    fn offsets_for(&self, clearance: f64, positions: [&[[f64; 3]]; 2]) -> Vec<f64> {
        let offset = |node: &MortarNode| {
            let gap = match self.start.is_quadratic() {
                true => node.gap,
                false => dot(self.outward(node.normal), node.distance(positions)),
            };
            (node.covered >= COVERED).then_some(clearance - gap)
        };
        let offsets: Vec<Option<f64>> = self.start.nodes.iter().map(offset).collect();
        let known = || offsets.iter().flatten();
        let mean = known().sum::<f64>() / known().count().max(1) as f64;
        offsets.into_iter().map(|offset| offset.unwrap_or(mean)).collect()
    }

    /// The weights of the sides of a contact node, and the sides that the weights of its mortar integrals belong to;
    /// none if one of them belongs to no side.
    fn weights(point: &ContactPoint, node: &MortarNode) -> Option<(Vec<f64>, Vec<usize>)> {
        let (mut weights, mut sides) = (own_weight(point), Vec::with_capacity(node.weights.len()));
        for &(master, weight) in &node.weights {
            let side = point.sides[1..].binary_search_by_key(&master, |side| side.node).ok();
            match side {
                _ if weight.abs() <= NO_WEIGHT => {}
                Some(side) => weights[1 + side] = -weight,
                None => return None,
            }
            sides.push(side.map_or(0, |side| 1 + side));
        }
        Some((weights, sides))
    }
}

impl Opposite for Pair {
    /// [`ContactError::LeftMaster`] for a glued node that no longer lies opposite to the master, and for one that slid
    /// past the master nodes in its rows.
    fn at(
        &self,
        points: &[ContactPoint],
        positions: &Positions,
    ) -> Result<(Vec<Placed>, Arc<dyn Facing>), ContactError> {
        let mortar = match self.is_fixed {
            true => Arc::clone(&self.start),
            false => Arc::new(self.sides.mortar(positions, self.along)),
        };
        let positions = self.sides.bodies.map(|body| Arc::clone(&positions[body]));
        let (mut nodes, mut placed) = (Vec::with_capacity(points.len()), Vec::with_capacity(points.len()));
        for point in points {
            let left = || ContactError::LeftMaster { node: point.node, place: positions[0][point.node as usize] };
            let index = mortar.nodes.binary_search_by_key(&point.node, |node| node.node).map_err(|_| left())?;
            let node = &mortar.nodes[index];
            let normal = self.outward(node.normal);
            let is_covered = node.covered >= COVERED;
            if !is_covered {
                if self.is_tied {
                    return Err(left());
                }
                let (area, weights) = (COVERED * node.whole, own_weight(point));
                placed.push(Placed { numbers: Numbers { normal, gap: self.away, area, weights }, is_covered });
                nodes.push((index, Vec::new()));
                continue;
            }
            let (weights, sides) = Self::weights(point, node).ok_or_else(left)?;
            let gap = match mortar.is_quadratic() {
                true => node.gap,
                false => dot(normal, distance(point, &weights, &positions)),
            };
            let gap = gap + self.offsets.get(index).copied().unwrap_or(0.0);
            placed.push(Placed { numbers: Numbers { normal, gap, area: node.area, weights }, is_covered });
            nodes.push((index, sides));
        }
        let bodies = self.sides.bodies;
        Ok((placed, Arc::new(PairAt { mortar, bodies, positions, nodes, is_fixed: self.is_fixed })))
    }

    fn is_fixed(&self) -> bool {
        self.is_fixed
    }

    fn areas_change(&self) -> bool {
        !self.is_fixed
    }

    fn master(&self) -> Option<usize> {
        Some(self.sides.bodies[1])
    }

    fn has_weight(&self, node: u32, master: u32) -> bool {
        let Ok(place) = self.start.nodes.binary_search_by_key(&node, |node| node.node) else { return false };
        self.start.nodes[place].weights.iter().any(|(other, weight)| *other == master && weight.abs() > NO_WEIGHT)
    }
}

/// Weights of 1 for the node itself and 0 for all others.
fn own_weight(point: &ContactPoint) -> Vec<f64> {
    let mut weights = vec![0.0; point.sides.len()];
    weights[0] = 1.0;
    weights
}

/// Whether the sum of the vector areas of some facets points downwards.
fn faces_down(facets: &[Facet], positions: &[[f64; 3]]) -> bool {
    let of_facet = |facet: &Facet| {
        let corners: Vec<[f64; 3]> = facet.corners().iter().map(|&node| positions[node as usize]).collect();
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
    };
    facets.iter().map(of_facet).sum::<f64>() < 0.0
}
