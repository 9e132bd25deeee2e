//! One contact of a scene: its slave facets with an obstacle or the master facets of another body.

use crate::body::Body;
use crate::body::elasticity::facet::tributary_areas;
use crate::body::mesh::{CellFace, bounding_box};
use crate::equilibrium::pair_sides::possible_masters;
use crate::error::SceneError;
use crate::mortar::vector::dot;
use crate::mortar::{Along, Face, Facet, Mortar, MortarNode, QuadraticFacet};
use crate::names::find_face;
use crate::patches::CurvedFace;
use crate::scalar::Scalar;
use crate::scene::{AreaKind, BodyFace, ContactScene, CounterSurface, Master, NormalKind, Scene};
use crate::shape::ShapeMap;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Part of the area of a slave node from which the master counts as lying opposite to it: with less, weights are large
/// and say nothing.
pub(crate) const COVERED: f64 = 1e-3;

/// Weights up to this size are rounding of zero, as between equal grids.
pub(crate) const NO_WEIGHT: f64 = 1e-12;

/// What the rows of a contact are computed from.
#[derive(Debug, Clone)]
pub struct ContactPart {
    /// The slave body.
    pub(crate) slave: usize,
    /// The slave facets.
    pub(crate) faces: Vec<CellFace>,
    pub(crate) counter: Counter,
    pub(crate) normal: NormalKind,
    area: AreaKind,
    pub(crate) interference: f64,
    pub(crate) is_tied: bool,
    /// The contact nodes, ascending, each with the master nodes that may have weights in its rows, ascending.
    nodes: Vec<(u32, Vec<u32>)>,
    /// Slave nodes that too little of the master lies opposite to at the start: they carry no force.
    pub(crate) uncovered: usize,
    /// Whether directions and weights of the rows are the same for all shapes.
    pub(crate) is_fixed: bool,
    /// Whether areas of contact nodes change with the shape.
    pub(crate) areas_change: bool,
}

/// What lies opposite to a slave face.
#[derive(Debug, Clone)]
pub(crate) enum Counter {
    Obstacle(CounterSurface),
    Pair(Pair),
}

/// The facets of two bodies that lie opposite to each other.
#[derive(Debug, Clone)]
pub(crate) struct Pair {
    /// The master body.
    pub body: usize,
    /// Slave facets, then master facets.
    facets: [Vec<Facet>; 2],
    /// Middles of the edges of both; none for flat facets.
    quadratic_facets: [Vec<QuadraticFacet>; 2],
    along: Along,
    /// Whether normals along x₃ point downwards.
    is_downward: bool,
    /// The gap of nodes that the master does not lie opposite to, mm: the diagonal of the slave face.
    pub away: f64,
    /// What makes the gaps of the start the stated clearance, per slave node, mm; none where the faces tell the gaps.
    pub offsets: Vec<f64>,
    /// The mortar integrals of the start.
    start: Arc<Mortar>,
}

impl ContactPart {
    /// A contact of a scene, with the positions of all nodes at the start.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for names that the meshes do not have, and for faces that do not lie opposite to each
    /// other.
    pub(crate) fn new(
        (scene, index): (&Scene, usize),
        bodies: &[Body],
        (map, curved): (&ShapeMap, Option<&[CurvedFace; 2]>),
        start: &[Arc<Vec<[f64; 3]>>],
    ) -> Result<Self, SceneError> {
        let (contact, field) = (&scene.contacts[index], scene.contact_field(index));
        let slave = contact.slave.body;
        let name = if contact.master_face().is_some() { format!("{field}.slave") } else { format!("{field}.face") };
        let faces = faces_of(&name, &contact.slave, bodies)?;
        let moves_across = |body: usize| map.moves_along(body, 0) || map.moves_along(body, 1);
        let mut this = Self {
            slave,
            counter: Counter::Obstacle(CounterSurface::Plane { height: 0.0 }),
            normal: contact.normal,
            area: contact.area,
            interference: contact.interference,
            is_tied: contact.is_tied(),
            nodes: Vec::new(),
            uncovered: 0,
            is_fixed: true,
            areas_change: false,
            faces,
        };
        match &contact.master {
            Master::Obstacle(surface) => {
                let plane = matches!(surface, CounterSurface::Plane { .. } | CounterSurface::TiltedPlane { .. });
                this.is_fixed = this.normal == NormalKind::X3 || plane;
                let projected = this.area == AreaKind::Projected;
                this.areas_change = map.shapes(slave) && (!projected || moves_across(slave));
                this.counter = Counter::Obstacle(surface.clone());
                let mut nodes: Vec<u32> = this.slave_facets(&bodies[slave]).into_iter().flatten().collect();
                nodes.sort_unstable();
                nodes.dedup();
                this.nodes = nodes.into_iter().map(|node| (node, Vec::new())).collect();
            }
            Master::Body(master) => {
                let both = [slave, master.body];
                this.is_fixed = match contact.normal {
                    NormalKind::X3 => !both.iter().any(|&body| moves_across(body)),
                    NormalKind::Surface => !both.iter().any(|&body| map.shapes(body)),
                };
                this.areas_change = !this.is_fixed;
                let faces = faces_of(&format!("{field}.master"), master, bodies)?;
                this.pair_with((scene, contact, master), (&faces, curved), bodies, start);
                let (names, allowed) = (
                    format!("\"{}\" and \"{}\"", contact.slave.face, master.face),
                    "two faces that lie opposite to each other",
                );
                SceneError::require(!this.nodes.is_empty(), format!("{field}.master"), names, allowed)?;
            }
        }
        Ok(this)
    }

    /// Computes the mortar integrals of the start, and with them the contact nodes.
    fn pair_with(
        &mut self,
        (scene, contact, master): (&Scene, &ContactScene, &BodyFace),
        (faces, curved): (&[CellFace], Option<&[CurvedFace; 2]>),
        bodies: &[Body],
        start: &[Arc<Vec<[f64; 3]>>],
    ) {
        let facets = [mortar_facets(&bodies[self.slave], &self.faces), mortar_facets(&bodies[master.body], faces)];
        let along = if contact.normal == NormalKind::X3 { Along::X3 } else { Along::Normals };
        let quadratic_facets =
            curved.map_or_else(Default::default, |faces| [0, 1].map(|side| faces[side].quadratic_facets.clone()));
        let positions: [&[[f64; 3]]; 2] = [&start[self.slave], &start[master.body]];
        let mortar = mortar(&facets, &quadratic_facets, positions, along);
        let is_covered = |node: &&MortarNode| node.covered >= COVERED;
        let covered = || mortar.nodes.iter().filter(is_covered);
        self.uncovered = mortar.nodes.len() - covered().count();
        self.nodes = match self.is_fixed {
            true => covered()
                .map(|node| {
                    (
                        node.node,
                        node.weights.iter().filter(|(_, w)| w.abs() > NO_WEIGHT).map(|(node, _)| *node).collect(),
                    )
                })
                .collect(),
            false => {
                let reach = [self.slave, master.body].map(|body| scene.bodies[body].reach()).into_iter().sum::<f64>();
                // A node that the master leaves carries no force, and one that it reaches may: glued ones cannot.
                let taken = mortar.nodes.iter().filter(|node| !self.is_tied || is_covered(node));
                possible_masters(taken, &facets, [&start[self.slave], &start[master.body]], reach)
            }
        };
        if covered().next().is_none() {
            self.nodes.clear();
        }
        let nodes = facets[0].iter().flat_map(|facet| facet.corners()).map(|&node| start[self.slave][node as usize]);
        let [least, most] = bounding_box(&nodes.collect::<Vec<_>>());
        let away = (0..3).map(|axis| (most[axis] - least[axis]).powi(2)).sum::<f64>().sqrt();
        let is_downward = along == Along::X3 && faces_down(&facets[0], &start[self.slave]);
        let start = Arc::new(mortar);
        let mut pair =
            Pair { body: master.body, facets, quadratic_facets, along, is_downward, away, offsets: Vec::new(), start };
        if let Some(clearance) = contact.clearance {
            pair.offsets = pair.offsets_for(clearance, positions);
        }
        self.counter = Counter::Pair(pair);
    }

    /// The contact nodes with the master nodes in their rows.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (u32, &[u32])> {
        self.nodes.iter().map(|(node, masters)| (*node, masters.as_slice()))
    }

    /// The master body; the slave body itself where an obstacle takes its place.
    pub(crate) fn master_body(&self) -> usize {
        match &self.counter {
            Counter::Obstacle(_) => self.slave,
            Counter::Pair(pair) => pair.body,
        }
    }

    /// Whether a master node has a weight in the rows of a slave node at the start.
    pub(crate) fn has_weight(&self, node: u32, master: u32) -> bool {
        let Counter::Pair(pair) = &self.counter else { return false };
        let Ok(place) = pair.start.nodes.binary_search_by_key(&node, |node| node.node) else { return false };
        pair.start.nodes[place].weights.iter().any(|(other, weight)| *other == master && weight.abs() > NO_WEIGHT)
    }

    /// The corners of the slave facets.
    pub(crate) fn slave_facets(&self, body: &Body) -> Vec<Vec<u32>> {
        let corners = |face: &CellFace| {
            let (mut nodes, corners) = body.mesh.face_with_corners(*face);
            nodes.truncate(corners);
            nodes
        };
        self.faces.iter().map(corners).collect()
    }

    /// Tributary areas of the corners of the slave facets, where an obstacle lies opposite to them.
    pub(crate) fn tributary_areas<T: Scalar>(
        &self,
        body: &Body,
        position: impl Fn(u32) -> [T; 3],
        mut add: impl FnMut(&[u32], Vec<T>),
    ) {
        for &face in &self.faces {
            let nodes: Vec<u32> = body.mesh.face_nodes(face).collect();
            let x: Vec<[T; 3]> = nodes.iter().map(|&node| position(node)).collect();
            add(&nodes, tributary_areas(&x, self.area));
        }
    }

    /// Tributary areas by node.
    pub(crate) fn areas(&self, body: &Body, positions: &[[f64; 3]]) -> BTreeMap<u32, f64> {
        let mut areas = BTreeMap::new();
        self.tributary_areas(
            body,
            |node| positions[node as usize],
            |nodes, own| {
                nodes.iter().zip(own).for_each(|(node, area)| *areas.entry(*node).or_insert(0.0) += area);
            },
        );
        areas
    }

    /// How areas are measured on an obstacle.
    pub(crate) fn area_kind(&self) -> AreaKind {
        self.area
    }
}

impl Pair {
    /// The outward normal of a slave node.
    pub(crate) fn outward(&self, normal: [f64; 3]) -> [f64; 3] {
        if self.is_downward { normal.map(|n| -n) } else { normal }
    }

    /// The mortar integrals of a shape; those of the start where they are the same for all shapes.
    pub(crate) fn mortar(&self, positions: [&[[f64; 3]]; 2], is_fixed: bool) -> Arc<Mortar> {
        match is_fixed {
            true => Arc::clone(&self.start),
            false => Arc::new(mortar(&self.facets, &self.quadratic_facets, positions, self.along)),
        }
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
}

fn mortar(
    facets: &[Vec<Facet>; 2],
    quadratic_facets: &[Vec<QuadraticFacet>; 2],
    [slave, master]: [&[[f64; 3]]; 2],
    along: Along,
) -> Mortar {
    let face =
        |side: usize, positions| Face { facets: &facets[side], positions, quadratic_facets: &quadratic_facets[side] };
    Mortar::new(face(0, slave), face(1, master), along)
}

/// The facets of a face that a scene names, at least one.
fn faces_of(field: &str, face: &BodyFace, bodies: &[Body]) -> Result<Vec<CellFace>, SceneError> {
    let faces = find_face(field, &face.face, &bodies[face.body].mesh)?.to_vec();
    SceneError::require(!faces.is_empty(), field, &face.face, "a face with at least one facet")?;
    Ok(faces)
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

fn mortar_facets(body: &Body, faces: &[CellFace]) -> Vec<Facet> {
    let facet = |face: &CellFace| {
        let (nodes, corners) = body.mesh.face_with_corners(*face);
        Facet::new(&nodes[..corners])
    };
    faces.iter().filter_map(facet).collect()
}
