//! A scene made discrete: bodies, contact boundary, the map from controls to node positions. What all solvers share.

use crate::body::Body;
use crate::body::elasticity::{Formulation, Material};
use crate::body::loads::nodal_forces;
use crate::body::mesh::{BlockFace, Mesh, block, smallest_extent};
use crate::equilibrium::cell_shapes::CellShapes;
use crate::equilibrium::modes::{Frame, RigidScene};
use crate::equilibrium::{ContactBoundary, ContactFacets, ContactGeometry, ContactPoint, ContactRows};
use crate::error::{ContactError, SceneError};
use crate::names::find_face;
use crate::scene::{Blocks, Geometry, Scene, UpperBody};
use crate::shape::{AdmissibleSet, HeightShape, ShapeMap, ShapeScene, Velocities, height_map};
use std::sync::Arc;

/// Poisson's ratio from which standard cells are nearly incompressible: total FETI takes hundreds of products.
const LOCKING: f64 = 0.499;
/// Area of a contact face, over the square of the smallest extent of the body, that is rounding.
const SMALLEST_AREA: f64 = 1e-9;

/// Positions of the nodes of all bodies, lower first, mm.
pub type Positions = Vec<Arc<Vec<[f64; 3]>>>;

/// The discrete problem behind a scene.
#[derive(Debug)]
pub struct ContactProblem {
    /// The scene that was discretised.
    pub scene: Scene,
    /// The bodies, lower first.
    pub bodies: Arc<[Body]>,
    /// The nodes that can come into contact.
    pub boundary: ContactBoundary,
    /// What the contact rows of a shape are computed from.
    pub geometry: ContactGeometry,
    /// From controls to positions of the nodes of the lower body.
    pub map: Arc<ShapeMap>,
    /// The set of controls that the scene admits.
    pub admissible: AdmissibleSet,
    shapes: CellShapes,
    /// The contact rows at the start.
    start_rows: ContactRows,
    /// Positions of the upper body, where there is one.
    fixed: Option<Arc<Vec<[f64; 3]>>>,
}

impl ContactProblem {
    /// Checks a scene and makes it discrete.
    ///
    /// # Errors
    /// [`SceneError`] naming the field.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        scene.validate()?;
        let (bodies, partners) = bodies(&scene)?;
        let faces = find_face("contact.face", &scene.contact.face, &bodies[0].mesh)?.to_vec();
        SceneError::require(!faces.is_empty(), "contact.face", &scene.contact.face, "a face with at least one facet")?;
        let partner = |node: u32| partners.as_ref().map(|shift| node - shift);
        let (map, admissible) = shape(&scene, &bodies[0])?;
        let boundary = ContactBoundary::new(&scene.contact, &bodies, &faces, partner)?;
        let start = map.positions(&scene.shape.start());
        let shapes = CellShapes::new(&bodies[0].mesh, &start, &faces);
        let geometry = ContactGeometry::new(faces, scene.counter_surface.clone(), &scene.contact);
        let fixed = bodies.get(1).map(|upper| Arc::new(upper.mesh.nodes().to_vec()));
        let start_rows = ContactRows { nodes: Vec::new() };
        let (bodies, map) = (Arc::from(bodies), Arc::new(map));
        let mut problem = Self { scene, bodies, boundary, geometry, map, admissible, shapes, start_rows, fixed };
        problem.leave_out_held_nodes()?;
        Ok(problem)
    }

    /// Leaves out contact nodes whose normals supports hold at the start.
    fn leave_out_held_nodes(&mut self) -> Result<(), SceneError> {
        let refused = |error: ContactError| {
            SceneError::out_of_range(
                "counter_surface",
                error,
                "a surface with a normal at every contact node; contact.normal = \"x3\" asks for none",
            )
        };
        let rows = self.rows(&self.start_positions()).map_err(refused)?;
        self.boundary.retain(|index| !rows.nodes[index].is_held());
        self.start_rows = ContactRows { nodes: rows.nodes.into_iter().filter(|node| !node.is_held()).collect() };
        self.refuse_imposed_slip()?;
        let area: f64 = self.start_rows.areas().iter().sum();
        let extent = smallest_extent(&self.start_positions()[0]);
        let valid = self.start_rows.nodes.is_empty() || area > SMALLEST_AREA * extent * extent;
        let allowed = "\"surface\" for a face that x3 runs along, whose projection has no area";
        SceneError::require(valid, "contact.area", "projected", allowed)?;
        let allowed = "a face with nodes that supports do not hold along their normals";
        SceneError::require(!self.boundary.points.is_empty(), "contact.face", &self.scene.contact.face, allowed)
    }

    /// Refuses supports that move a contact node with friction along the counter surface: its friction force along
    /// held directions would be no unknown, but take its share of the friction cone.
    fn refuse_imposed_slip(&self) -> Result<(), SceneError> {
        let slides = |point: &&ContactPoint| point.friction > 0.0 && point.imposed != [0.0; 3];
        let Some(point) = self.boundary.points.iter().find(slides) else { return Ok(()) };
        let place = self.bodies[0].mesh.nodes()[point.node as usize];
        let value = format!("{} at the contact node at {place:?}, which a support moves", point.friction);
        let allowed = "0 there, or supports with prescribed displacements that do not reach the contact face";
        Err(SceneError::out_of_range("contact friction", value, allowed))
    }

    fn all_positions(&self, lower: Vec<[f64; 3]>) -> Positions {
        std::iter::once(Arc::new(lower)).chain(self.fixed.clone()).collect()
    }

    /// Number of entries of the displacements of all bodies: three per node, lower body first.
    pub fn displacement_count(&self) -> usize {
        3 * self.bodies.iter().map(|body| body.mesh.node_count()).sum::<usize>()
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
        let aspect = self.shapes.extreme_aspect()?;
        Some(format!("cells have edges 1 : {aspect:.0}"))
    }

    /// The proportions of cells that are plates on the contact face or rods across it, where they are extreme.
    pub(crate) fn flat_or_tall(&self) -> Option<f64> {
        self.shapes.flat_or_tall()
    }

    /// Positions of all nodes of a shape.
    ///
    /// # Errors
    /// [`ContactError::InvertedElement`].
    pub fn positions(&self, controls: &[f64]) -> Result<Positions, ContactError> {
        let positions = self.all_positions(self.map.positions(controls));
        check_cells(&self.bodies[0], &positions[0])?;
        Ok(positions)
    }

    /// Positions of all nodes at the start of the scene.
    pub fn start_positions(&self) -> Positions {
        self.all_positions(self.map.positions(&self.scene.shape.start()))
    }

    /// The contact rows of a shape.
    ///
    /// # Errors
    /// [`ContactError::NoFoot`].
    pub fn rows(&self, positions: &Positions) -> Result<ContactRows, ContactError> {
        let positions: Vec<&[[f64; 3]]> = positions.iter().map(|positions| positions.as_slice()).collect();
        self.geometry.rows(&self.boundary, &self.bodies, &positions)
    }

    /// The facets of the contact surface.
    pub fn contact_facets(&self) -> ContactFacets {
        ContactFacets::new(&self.bodies[0], &self.geometry.faces, &self.boundary)
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
        !self.geometry.areas_are_projected() || self.map.moves_along(0) || self.map.moves_along(1)
    }

    /// The changes of the areas of all contact nodes along one field of velocities.
    pub(crate) fn area_changes(&self, lower: &[[f64; 3]], velocities: &Velocities<'_>, column: usize) -> Vec<f64> {
        self.geometry.area_changes(&self.boundary, &self.bodies[0], lower, velocities, column)
    }

    /// The sensitivities of the positions of the nodes of the lower body from those of the areas of all contact nodes.
    pub(crate) fn pull_back_areas(&self, lower: &[[f64; 3]], areas: &[f64]) -> Vec<[f64; 3]> {
        let mut positions = vec![[0.0; 3]; lower.len()];
        if self.areas_change() {
            let moves = |node| self.map.moves(node);
            self.geometry.pull_back_areas(&self.boundary, &self.bodies[0], lower, areas, moves, &mut positions);
        }
        positions
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
        let row = |point: &ContactPoint, direction: &[f64; 3]| {
            let side = |side: &crate::equilibrium::Side| {
                (side.body, positions[side.body][side.node as usize], direction.map(|d| side.weight * d))
            };
            point.sides.iter().map(side).collect()
        };
        let contact = self.boundary.points.iter().zip(&rows.nodes);
        let contact = contact.map(|(point, node)| node.directions.iter().map(|d| row(point, d)).collect());
        let contact = contact.collect();
        let frame = |(number, positions): (usize, &Arc<Vec<[f64; 3]>>)| {
            let own = held.iter().filter(|(holder, ..)| *holder == number).map(|(_, point, _)| *point);
            Frame::new(&own.collect::<Vec<_>>(), positions)
        };
        let frames = positions.iter().enumerate().map(frame).collect();
        let names = self.bodies.iter().map(|body| body.name.clone()).collect();
        let arms = self.bodies.iter().zip(positions).enumerate();
        let arms =
            arms.flat_map(|(number, (body, positions))| body.solid.arms(positions).map(move |arm| (number, arm)));
        RigidScene { names, held, arms: arms.collect(), loads, contact, frames }
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
        let moved = self.largest_prescribed() + self.scene.contact.interference.max(0.0);
        loads + modulus * moved * self.contact_area().sqrt()
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

/// The bodies of a scene, and by how much numbers of contact nodes of the lower body exceed those of their partners.
fn bodies(scene: &Scene) -> Result<(Vec<Body>, Option<u32>), SceneError> {
    match &scene.geometry {
        Geometry::Blocks(blocks) => block_bodies(scene, blocks),
        Geometry::Mesh(geometry) => {
            let mesh = Arc::clone(&geometry.mesh);
            let contact = find_face("contact.face", &scene.contact.face, &mesh)?.to_vec();
            let body = Body::new("body", &scene.lower, mesh, &contact, geometry.piece_count())?;
            let inverted =
                |error: ContactError| SceneError::out_of_range("body.mesh", error, "cells of positive volume");
            check_cells(&body, body.mesh.nodes()).map_err(inverted)?;
            Ok((vec![body], None))
        }
    }
}

fn block_bodies(scene: &Scene, blocks: &Blocks) -> Result<(Vec<Body>, Option<u32>), SceneError> {
    let grid = blocks.grid();
    let body = |name: &str, body, mesh: Mesh, contact: &str| {
        let contact = find_face("contact.face", contact, &mesh)?.to_vec();
        Body::new(name, body, Arc::new(mesh), &contact, 1)
    };
    let height = scene.heights().map_or(1.0, |heights| heights.start_height);
    let (floor, top) = (vec![0.0; grid.column_count()], vec![height; grid.column_count()]);
    let mesh = block(&grid, blocks.subdomains, &floor, &top)?;
    let mut bodies = vec![body("lower", &scene.lower, mesh, &scene.contact.face)?];
    let Some(UpperBody { body: upper, top }) = &scene.upper else { return Ok((bodies, None)) };
    let counter: Vec<f64> = grid.places().map(|[x1, x2]| scene.counter_surface.height(x1, x2)).collect();
    let mesh = block(&grid, blocks.subdomains, &counter, &vec![*top; grid.column_count()])?;
    bodies.push(body("upper", upper, mesh, BlockFace::Bottom.name())?);
    // Node (i, j, n₃) of the lower block meets node (i, j, 0) of the upper one.
    Ok((bodies, Some(grid.cells[2] as u32)))
}

/// The map and the set of the controls.
fn shape(scene: &Scene, lower: &Body) -> Result<(ShapeMap, AdmissibleSet), SceneError> {
    match &scene.shape {
        ShapeScene::Heights(heights) => {
            let blocks = scene.blocks().ok_or_else(|| {
                SceneError::out_of_range("surface", "a height surface of a mesh", "a lattice for meshes")
            })?;
            heights_of(scene, heights, blocks)
        }
        ShapeScene::Lattice(lattice) => {
            let map = lattice.map(lower)?;
            let admissible = AdmissibleSet::of_lattice(lattice, &map, &lower.mesh)?;
            Ok((map, admissible))
        }
    }
}

fn heights_of(scene: &Scene, heights: &HeightShape, blocks: &Blocks) -> Result<(ShapeMap, AdmissibleSet), SceneError> {
    let (grid, surface) = (blocks.grid(), heights.surface()?);
    let counter = &scene.counter_surface;
    let height = |[x1, x2]: [f64; 2]| if counter.has_heights() { counter.height(x1, x2) } else { f64::INFINITY };
    let ceiling: Vec<f64> = surface.places(blocks.size).map(height).collect();
    let admissible = AdmissibleSet::new(&surface, &grid, &heights.bounds, ceiling)?;
    Ok((height_map(&surface, &grid), admissible))
}
