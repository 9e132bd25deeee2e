//! A scene made discrete: bodies, contact boundary, the map from controls to node positions. What all solvers share.

use crate::body::Body;
use crate::body::elasticity::{Formulation, Material};
use crate::body::loads::nodal_forces;
use crate::body::mesh::{CellFace, Mesh, smallest_extent};
use crate::equilibrium::cell_shapes::CellShapes;
use crate::equilibrium::contact_moduli;
use crate::equilibrium::contact_part::ContactPart;
use crate::equilibrium::curved_faces::curved_faces;
use crate::equilibrium::modes::{Frame, RigidScene};
use crate::equilibrium::{
    ContactBoundary, ContactFacets, ContactGeometry, ContactPoint, ContactRows, FormErrors, NodeRows, RowSensitivities,
};
use crate::error::{ContactError, SceneError};
use crate::names::find_face;
use crate::patches::{CurvedFace, MiddlePoint};
use crate::scene::{Geometry, Scene};
use crate::shape::{AdmissibleSet, BodyMap, Positions, ShapeMap};
use std::sync::Arc;

/// c relative to the assembled diagonal of the contact nodes: the Schur complement's diagonal is about half of it.
const STIFFNESS_SHARE: f64 = 0.5;
/// Smallest share of c that flat or tall bricks leave: with less, displacements count too little against forces.
const SMALLEST_SHARE: f64 = 0.01;

/// Poisson's ratio from which standard cells are nearly incompressible: total FETI takes hundreds of products.
const LOCKING: f64 = 0.499;
/// Area of a contact face, over the square of the smallest extent of the body, that is rounding.
const SMALLEST_AREA: f64 = 1e-9;

/// The discrete problem behind a scene.
#[derive(Debug)]
pub struct ContactProblem {
    /// The scene that was discretised.
    pub scene: Scene,
    /// The bodies, in the order of the scene.
    pub bodies: Arc<[Body]>,
    /// The nodes that can come into contact.
    pub boundary: ContactBoundary,
    /// What the contact rows of a shape are computed from.
    pub geometry: ContactGeometry,
    /// From controls to positions of the nodes of all bodies.
    pub map: Arc<ShapeMap>,
    /// The set of controls that the scene admits; of its own controls, where form errors take their place.
    pub admissible: AdmissibleSet,
    /// E* per contact node, MPa.
    pub(super) contact_moduli: Vec<f64>,
    shapes: Vec<CellShapes>,
    /// Slave and master face by contact, where any of them is curved and gaps are along their normals.
    pub(super) curved_faces: Vec<Option<[CurvedFace; 2]>>,
    /// Positions of all points at the start of the scene.
    start: Positions,
    /// The contact rows at the start.
    start_rows: ContactRows,
}

impl ContactProblem {
    /// Checks a scene and makes it discrete.
    ///
    /// # Errors
    /// [`SceneError`] naming the field.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        Self::around(scene, None)
    }

    /// As [`new`](Self::new); with form errors around a shape, their waves take the place of the controls.
    ///
    /// # Errors
    /// As [`new`](Self::new), and as [`FormErrors`] says.
    pub fn around(scene: Scene, errors: Option<&FormErrors>) -> Result<Self, SceneError> {
        scene.validate()?;
        let bodies = bodies(&scene)?;
        let curved = curved_faces(&scene, &bodies)?;
        let maps = maps(&scene, &bodies, &curved.points)?;
        let meshes: Vec<&Mesh> = bodies.iter().map(|body| &*body.mesh).collect();
        let admissible = AdmissibleSet::new(&scene, &meshes, &maps)?;
        let lattice = ShapeMap::new(maps);
        let start = lattice.points(&scene.start());
        let flat: Vec<bool> = scene.bodies.iter().map(|body| body.heights().is_some()).collect();
        let map = errors.map(|errors| errors.map(&lattice, &bodies, (&curved.points, &flat))).transpose()?;
        let map = map.unwrap_or(lattice);
        check_start(&scene, &bodies, &start)?;
        let part =
            |index: usize| ContactPart::new((&scene, index), &bodies, (&map, curved.contacts[index].as_ref()), &start);
        let parts = (0..scene.contacts.len()).map(part).collect::<Result<Vec<_>, SceneError>>()?;
        let boundary = ContactBoundary::new(&scene, &bodies, &parts)?;
        let shapes = bodies.iter().zip(&start).enumerate().map(|(number, (body, positions))| {
            let own = parts.iter().filter(|part| part.slave == number).flat_map(|part| part.faces.iter().copied());
            CellShapes::new(&body.mesh, positions, &own.collect::<Vec<_>>())
        });
        let shapes = shapes.collect();
        let start_rows = ContactRows::default();
        let traces_change =
            bodies.iter().enumerate().any(|(number, body)| map.shapes(number) && !body.trace.is_empty());
        let geometry = ContactGeometry { parts, traces_change };
        let (bodies, map): (Arc<[Body]>, _) = (Arc::from(bodies), Arc::new(map));
        let (contact_moduli, curved_faces) = (Vec::new(), curved.alone);
        let mut problem = Self {
            scene,
            bodies,
            boundary,
            geometry,
            map,
            admissible,
            contact_moduli,
            shapes,
            curved_faces,
            start,
            start_rows,
        };
        problem.leave_out_held_nodes()?;
        problem.contact_moduli = contact_moduli::contact_moduli(&problem.bodies, &problem.boundary);
        Ok(problem)
    }

    /// Leaves out contact nodes whose normals supports hold at the start.
    fn leave_out_held_nodes(&mut self) -> Result<(), SceneError> {
        let refused = |error: ContactError| {
            SceneError::out_of_range(
                "obstacle",
                error,
                "a surface with a normal at every contact node; normal = \"x3\" of a contact asks for none",
            )
        };
        let start = self.start_positions();
        let rows = self.rows(&start).map_err(refused)?;
        self.boundary.retain(|index| !rows.nodes[index].is_held());
        self.start_rows = self.rows(&start).map_err(refused)?;
        self.refuse_imposed_slip()?;
        for (index, contact) in self.scene.contacts.iter().enumerate() {
            let nodes = &self.start_rows.nodes[self.boundary.of_contact(index)];
            let area: f64 = nodes.iter().map(|node| node.area).sum();
            let extent = smallest_extent(&start[contact.slave.body]);
            let field = self.scene.contact_field(index);
            let allowed = "\"surface\" for a face that x3 runs along, whose projection has no area";
            let valid = nodes.is_empty() || area > SMALLEST_AREA * extent * extent;
            SceneError::require(valid, format!("{field}.area"), "projected", allowed)?;
            let allowed = "a face with nodes that supports do not hold along their normals";
            SceneError::require(!nodes.is_empty(), format!("{field}.slave.face"), &contact.slave.face, allowed)?;
        }
        Ok(())
    }

    /// Refuses supports that move a contact node with friction along the counter surface: its friction force along
    /// held directions would be no unknown, but take its share of the friction cone.
    fn refuse_imposed_slip(&self) -> Result<(), SceneError> {
        let mut nodes = self.boundary.points.iter().zip(&self.start_rows.nodes);
        let slides = |(point, node): &(&ContactPoint, &NodeRows)| {
            point.friction > 0.0 && point.imposed(&node.weights) != [0.0; 3]
        };
        let Some((point, _)) = nodes.find(slides) else { return Ok(()) };
        let place = self.bodies[point.body].mesh.nodes()[point.node as usize];
        let value = format!("{} at the contact node at {place:?}, which a support moves", point.friction);
        let allowed = "0 there, or supports with prescribed displacements that do not reach the contact face";
        Err(SceneError::out_of_range(format!("contact[{}].friction", point.contact), value, allowed))
    }

    /// Number of entries of the displacements of all bodies: three per node, in the order of the scene.
    pub fn displacement_count(&self) -> usize {
        3 * self.map.node_count()
    }

    /// The parts of ∂J/∂(state): ∂J/∂λ in packed rows, and, where J depends on it, ∂J/∂u over all bodies.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for entries of another mesh.
    pub(crate) fn parts_of<'d>(&self, direction: &'d [f64]) -> Result<(&'d [f64], Option<&'d [f64]>), ContactError> {
        let (rows, displacements) = (self.boundary.row_count, self.displacement_count());
        match direction.len() {
            found if found == rows => Ok((direction, None)),
            found if found == rows + displacements => {
                let (forces, loads) = direction.split_at(rows);
                Ok((forces, Some(loads)))
            }
            found => Err(ContactError::ForeignState { what: "entries of a dual", expected: rows, found }),
        }
    }

    /// Checks that changes of the shape have one entry per control.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for changes of another shape.
    pub(crate) fn check_changes(&self, changes: &[Vec<f64>]) -> Result<(), ContactError> {
        let expected = self.map.control_count();
        match changes.iter().map(Vec::len).find(|found| *found != expected) {
            Some(found) => Err(ContactError::ForeignState { what: "controls", expected, found }),
            None => Ok(()),
        }
    }

    /// The materials of all bodies.
    pub fn materials(&self) -> impl Iterator<Item = &Material> {
        self.bodies.iter().flat_map(|body| body.solid.materials())
    }

    /// Why linear systems of the problem are ill conditioned, by material or bricks: total FETI is slow then.
    pub(crate) fn ill_conditioned(&self) -> Option<String> {
        let locking = self.materials().filter(|material| material.formulation() == Formulation::Standard);
        let ratio = locking.map(Material::poisson_ratio).fold(f64::NEG_INFINITY, f64::max);
        if ratio >= LOCKING {
            return Some(format!("Poisson's ratio {ratio} is nearly incompressible"));
        }
        let aspect = self.shapes.iter().filter_map(CellShapes::extreme_aspect).reduce(f64::max)?;
        Some(format!("cells have edges 1 : {aspect:.0}"))
    }

    /// The proportions of the cells of a body, the worst one.
    pub(crate) fn aspect(&self) -> f64 {
        self.shapes.iter().map(CellShapes::aspect).fold(1.0, f64::max)
    }

    /// The proportions of cells that are plates on the contact face or rods across it, where they are extreme.
    pub(crate) fn flat_or_tall(&self) -> Option<f64> {
        self.shapes.iter().filter_map(CellShapes::flat_or_tall).reduce(f64::max)
    }

    /// c, the mean stiffness of a contact node whose surroundings rest, relative to the mean diagonal of K there. The
    /// diagonal is the largest stiffness of flat or tall bricks; most displacements of the boundary meet a smaller one.
    pub(crate) fn diagonal_share(&self) -> f64 {
        STIFFNESS_SHARE * self.flat_or_tall().map_or(1.0, |ratio| ratio.recip().max(SMALLEST_SHARE))
    }

    /// Positions of all points of a shape: per body its nodes, then the middles of edges of its curved faces.
    ///
    /// # Errors
    /// [`ContactError::InvertedElement`].
    pub fn positions(&self, controls: &[f64]) -> Result<Positions, ContactError> {
        let positions = self.map.points(controls);
        self.map.shaped_bodies().try_for_each(|body| check_cells(&self.bodies[body], &positions[body]))?;
        Ok(positions)
    }

    /// Positions of all points at the start of the scene.
    pub fn start_positions(&self) -> Positions {
        self.start.clone()
    }

    /// The contact rows of a shape.
    ///
    /// # Errors
    /// [`ContactError::NoFoot`], [`ContactError::LeftMaster`].
    pub fn rows(&self, positions: &Positions) -> Result<ContactRows, ContactError> {
        self.geometry.rows(&self.boundary, &self.bodies, positions)
    }

    /// The slave facets of all contacts whose sides may part.
    pub fn contact_facets(&self) -> ContactFacets {
        let parts = self.boundary.contacts().map(|contact| (contact, &self.geometry.parts[contact]));
        let parts = parts.filter(|(_, part)| !part.is_tied);
        let facets = parts.map(|(contact, part)| (contact, part.slave, part.slave_facets(&self.bodies[part.slave])));
        ContactFacets::new(facets, &self.boundary)
    }

    /// Per contact between bodies, the number of nodes of the slave face that carry no force at the start, since too
    /// little of the master lies opposite to them.
    pub fn uncovered_nodes(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.geometry.parts.iter().map(|part| part.uncovered).enumerate().filter(|(_, count)| *count > 0)
    }

    /// The contact rows at the start of the scene.
    pub fn start_rows(&self) -> &ContactRows {
        &self.start_rows
    }

    /// Area of the contact surface at the start, mm².
    pub fn contact_area(&self) -> f64 {
        self.start_rows.area()
    }

    /// Whether areas of contact nodes change with the shape.
    pub fn areas_change(&self) -> bool {
        self.geometry.areas_change()
    }

    /// The sensitivities of the positions of all nodes from those of the areas of all contact nodes.
    pub(crate) fn pull_back_areas(&self, rows: &ContactRows, areas: &[f64]) -> Vec<[f64; 3]> {
        let mut result = self.no_sensitivities();
        if self.areas_change() {
            let by_area = |node: usize| areas.get(node).copied().unwrap_or(0.0);
            let own = |node| RowSensitivities { area: by_area(node), ..RowSensitivities::default() };
            let sensitivities: Vec<_> = (0..self.boundary.points.len()).map(own).collect();
            let moves = |body: usize, node: u32| self.map.moves(body, node);
            rows.pull_back(&self.boundary, &sensitivities, moves, |body, node, sensitivity| {
                add_at(&mut result, self.node_number(body, node), sensitivity);
            });
        }
        result
    }

    /// The number of a node of a body among the points that shapes move: nodes and middles of edges of all bodies.
    pub fn node_number(&self, body: usize, node: u32) -> usize {
        self.map.number(body, node)
    }

    /// Sensitivities of zero of the positions of all points.
    pub(crate) fn no_sensitivities(&self) -> Vec<[f64; 3]> {
        vec![[0.0; 3]; self.map.point_count()]
    }

    /// The loads of a body at the positions of its points: nodes with forces, N, several per node.
    pub fn nodal_loads(&self, body: usize, positions: &[[f64; 3]]) -> Vec<(u32, [f64; 3])> {
        nodal_forces(&self.bodies[body], positions)
    }

    /// The bodies as a rigid body analysis takes them.
    pub fn rigid_scene(&self, positions: &Positions, rows: &ContactRows) -> RigidScene {
        let (mut held, mut loads) = (Vec::new(), Vec::new());
        for (number, (body, positions)) in self.bodies.iter().zip(positions).enumerate() {
            for node in body.held_nodes() {
                let directions = body.held(node).iter();
                held.extend(directions.map(|direction| (number, positions[node as usize], *direction)));
            }
            let forces = nodal_forces(body, positions).into_iter();
            loads.extend(forces.map(|(node, force)| (number, positions[node as usize], force)));
        }
        let row = |(point, node): (&ContactPoint, &NodeRows), direction: &[f64; 3]| {
            let sides = point.sides.iter().zip(&node.weights).filter(|(_, weight)| **weight != 0.0);
            let part = |(side, weight): (&crate::equilibrium::Side, &f64)| {
                let (trace, positions) = (&self.bodies[side.body].trace, &positions[side.body]);
                let place = trace.place(&rows.traces[side.body], side.node, positions);
                (side.body, place, trace.projected(side.node, *direction).map(|d| weight * d))
            };
            sides.map(part).collect()
        };
        let contact = self.boundary.points.iter().zip(&rows.nodes);
        let of_node = |pair: (&ContactPoint, &NodeRows)| -> Vec<Vec<crate::equilibrium::modes::RowPart>> {
            let directions = pair.1.directions.iter().filter(|_| pair.1.is_covered);
            directions.map(|d| row(pair, d)).collect()
        };
        let contact = contact.map(of_node);
        let contact = contact.collect();
        let frame = |(number, positions): (usize, &Arc<Vec<[f64; 3]>>)| {
            let own = held.iter().filter(|(holder, ..)| *holder == number).map(|(_, point, _)| *point);
            Frame::new(&own.collect::<Vec<_>>(), positions)
        };
        let frames = positions.iter().enumerate().map(frame).collect();
        let names = self.bodies.iter().map(|body| body.name.clone()).collect();
        RigidScene { names, held, loads, contact, frames }
    }

    /// The largest component of a displacement that supports prescribe, mm; 0 where they hold bodies at rest.
    pub fn largest_prescribed(&self) -> f64 {
        self.bodies.iter().map(Body::largest_prescribed).fold(0.0, f64::max)
    }

    /// What presses the bodies, N: Σ|f|, magnitudes of all nodal loads at the start, and E|u|√A, roughly what it takes
    /// to press the largest prescribed displacement and the interference into the contact area A. Zero where nothing
    /// moves the bodies.
    pub fn load(&self) -> f64 {
        let bodies = self.bodies.iter().zip(self.start_positions());
        let forces = bodies.flat_map(|(body, positions)| nodal_forces(body, &positions));
        let loads: f64 = forces.map(|(_, [x, y, z])| (x * x + y * y + z * z).sqrt()).sum();
        let modulus = self.materials().map(Material::young_modulus).fold(0.0, f64::max);
        let interference = self.scene.contacts.iter().map(|contact| contact.interference).fold(0.0, f64::max);
        let moved = self.largest_prescribed() + interference;
        loads + modulus * moved * self.contact_area().sqrt()
    }

    /// Roughly by how much the load presses the bodies together, mm: load/(E√A) with the smallest E of their materials.
    pub(crate) fn typical_displacement(&self) -> f64 {
        let modulus = self.materials().map(Material::young_modulus).fold(f64::INFINITY, f64::min);
        self.load() / (modulus * self.contact_area().sqrt())
    }
}

/// Refuses a body with an inverted or flat cell.
fn check_cells(body: &Body, positions: &[[f64; 3]]) -> Result<(), ContactError> {
    for cell in 0..body.mesh.cell_count() {
        let determinant = body.mesh.cell_nodes(cell, positions).smallest_determinant();
        if !(determinant > 0.0 && determinant.is_finite()) {
            return Err(ContactError::InvertedElement { body: body.name.clone(), cell, determinant });
        }
    }
    Ok(())
}

/// The bodies of a scene.
fn bodies(scene: &Scene) -> Result<Vec<Body>, SceneError> {
    let body = |(number, body): (usize, &crate::scene::BodyScene)| {
        let (mesh, pieces) = body.mesh()?;
        let mut contact: Vec<CellFace> = Vec::new();
        for (index, own) in scene.contacts.iter().enumerate() {
            let faces = std::iter::once(("slave", &own.slave)).chain(own.master_face().map(|face| ("master", face)));
            for (side, face) in faces.filter(|(_, face)| face.body == number) {
                let field = format!("{}.{side}.face", scene.contact_field(index));
                contact.extend(find_face(&field, &face.face, &mesh)?);
            }
        }
        Body::new(body, mesh, &contact, pieces)
    };
    scene.bodies.iter().enumerate().map(body).collect()
}

/// The maps of the bodies.
fn maps(scene: &Scene, bodies: &[Body], points: &[Vec<MiddlePoint>]) -> Result<Vec<BodyMap>, SceneError> {
    let map = |((scene, body), points): ((&crate::scene::BodyScene, &Body), &Vec<MiddlePoint>)| match &scene.shape {
        None => {
            let base = body.mesh.nodes().iter().copied().chain(points.iter().map(|point| point.place)).collect();
            Ok(BodyMap { base, middles: points.len(), controls: 0, rows: Vec::new() })
        }
        Some(shape) => shape.map((&body.mesh, scene.block()), points, |node| body.held(node)),
    };
    scene.bodies.iter().zip(bodies).zip(points).map(map).collect()
}

/// Refuses meshes with inverted cells.
fn check_start(scene: &Scene, bodies: &[Body], start: &Positions) -> Result<(), SceneError> {
    for ((scene, body), positions) in scene.bodies.iter().zip(bodies).zip(start) {
        if let Geometry::Mesh(_) = scene.geometry {
            let field = format!("{}.mesh", scene.name);
            check_cells(body, positions)
                .map_err(|error| SceneError::out_of_range(field, error, "cells of positive volume"))?;
        }
    }
    Ok(())
}

/// Adds a vector to an entry.
pub(crate) fn add_at(vectors: &mut [[f64; 3]], index: usize, vector: [f64; 3]) {
    (0..3).for_each(|axis| vectors[index][axis] += vector[axis]);
}
