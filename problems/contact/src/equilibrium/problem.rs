//! A scene made discrete: contact boundary, blocks of a shape, gaps, rigid motions. What both contact solvers share.

use crate::body::elasticity::Formulation;
use crate::body::elasticity::traction::face_weights;
use crate::body::mesh::{Block, Grid};
use crate::body::shape_load::loaded_faces;
use crate::equilibrium::ContactBoundary;
use crate::equilibrium::modes::{Frame, RigidScene};
use crate::error::{ContactError, SceneError};
use crate::lattice;
use crate::scene::{BodyScene, Scene};
use crate::shape::{AdmissibleSet, HeightMap};

/// Ratio of the edges of a brick from which it is extreme: total FETI may take hundreds of products and more, above all
/// for plates and for bricks that are long in the plan.
const EXTREME_BRICK: f64 = 30.0;

/// Poisson's ratio from which standard bricks are nearly incompressible: total FETI takes hundreds of products.
const LOCKING: f64 = 0.499;

/// The discrete problem behind a scene.
#[derive(Debug)]
pub struct ContactProblem {
    /// The scene that was discretised.
    pub scene: Scene,
    /// Grid of both bodies.
    pub grid: Grid,
    /// The nodes that can come into contact.
    pub boundary: ContactBoundary,
    /// From controls to heights of the contact nodes.
    pub height_map: HeightMap,
    /// The set of controls that the scene admits.
    pub admissible: AdmissibleSet,
    counter_heights: Vec<f64>,
}

impl ContactProblem {
    /// Checks a scene and makes it discrete.
    ///
    /// # Errors
    /// [`SceneError`] naming the field.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        scene.validate()?;
        let grid = scene.grid();
        let surface = scene.spline_surface()?;
        let boundary = ContactBoundary::new(&scene, &grid);
        let counter = &scene.counter_surface;
        let ceiling: Vec<f64> = surface.places(scene.size).map(|[x1, x2]| counter.height(x1, x2)).collect();
        let admissible = AdmissibleSet::new(&surface, &grid, &scene.bounds, ceiling)?;
        let places = grid.columns().map(|(i, j)| grid.position(i, j));
        let counter_heights: Vec<f64> = places.map(|[x1, x2]| counter.height(x1, x2)).collect();
        Ok(Self { grid, boundary, height_map: surface.height_map(&grid), admissible, counter_heights, scene })
    }

    /// Scenes of the bodies, lower first.
    pub fn bodies(&self) -> impl Iterator<Item = &BodyScene> {
        std::iter::once(&self.scene.lower).chain(self.scene.upper.as_ref().map(|upper| &upper.body))
    }

    /// Number of entries of the displacements of all bodies: three per node, lower body first.
    pub fn displacement_count(&self) -> usize {
        3 * self.grid.node_count() * self.bodies().count()
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

    /// Checks that changes of the surface have one entry per contact node.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] for changes of another surface.
    pub(crate) fn check_changes(&self, changes: &[Vec<f64>]) -> Result<(), ContactError> {
        let expected = self.grid.column_count();
        match changes.iter().map(Vec::len).find(|found| *found != expected) {
            Some(found) => Err(ContactError::ForeignState { what: "heights of contact nodes", expected, found }),
            None => Ok(()),
        }
    }

    /// Edges of the bricks of the lower body at the start, mm.
    fn brick_edges(&self) -> [f64; 3] {
        let lengths = [self.scene.size[0], self.scene.size[1], self.scene.start_height];
        std::array::from_fn(|axis| lengths[axis] / self.scene.mesh[axis] as f64)
    }

    /// Why linear systems of the problem are ill conditioned, by material or bricks: total FETI is slow then.
    pub(crate) fn ill_conditioned(&self) -> Option<String> {
        let locking = self.bodies().map(|body| body.material).filter(|m| m.formulation() == Formulation::Standard);
        let ratio = locking.map(|material| material.poisson_ratio()).fold(f64::NEG_INFINITY, f64::max);
        if ratio >= LOCKING {
            return Some(format!("Poisson's ratio {ratio} is nearly incompressible"));
        }
        let [a, b, height] = self.brick_edges();
        let aspect = a.max(b).max(height) / a.min(b).min(height);
        (aspect >= EXTREME_BRICK).then(|| format!("bricks have edges 1 : {aspect:.0}"))
    }

    /// The height of the bricks over both edges of their plan, or both edges over the height, where that is extreme:
    /// bricks are plates or rods along x₃ then.
    pub(crate) fn flat_or_tall(&self) -> Option<f64> {
        let [a, b, height] = self.brick_edges();
        let ratio = (height / a.max(b)).max(a.min(b) / height);
        (ratio >= EXTREME_BRICK).then_some(ratio)
    }

    /// The lower body of a shape.
    ///
    /// # Errors
    /// [`ContactError::InvertedElement`].
    pub fn lower_block(&self, controls: &[f64]) -> Result<Block, ContactError> {
        let (lower, upper) = (vec![0.0; self.grid.column_count()], self.height_map.heights(controls));
        Block { grid: self.grid, lower, upper }.checked(1)
    }

    /// The upper body, if there is one.
    ///
    /// # Errors
    /// [`ContactError::InvertedElement`].
    pub(crate) fn upper_block(&self) -> Result<Option<Block>, ContactError> {
        let Some(upper) = &self.scene.upper else { return Ok(None) };
        let (lower, upper) = (self.counter_heights.clone(), vec![upper.top; self.grid.column_count()]);
        Block { grid: self.grid, lower, upper }.checked(2).map(Some)
    }

    /// All blocks of a shape, lower first.
    ///
    /// # Errors
    /// [`ContactError::InvertedElement`].
    pub fn blocks(&self, controls: &[f64]) -> Result<Vec<Block>, ContactError> {
        Ok(std::iter::once(self.lower_block(controls)?).chain(self.upper_block()?).collect())
    }

    /// Initial gap c_N = F² − F_α per contact node, mm.
    pub fn gaps(&self, lower: &Block) -> Vec<f64> {
        self.counter_heights.iter().zip(&lower.upper).map(|(counter, height)| counter - height).collect()
    }

    /// The scene as a rigid body analysis takes it.
    pub fn rigid_scene(&self, blocks: &[Block]) -> RigidScene {
        let (mut held, mut loads) = (Vec::new(), Vec::new());
        for (body, (block, scene)) in blocks.iter().zip(self.bodies()).enumerate() {
            for node in lattice::points([0; 3], self.grid.nodes()) {
                for (component, fixed) in scene.held(&self.grid, node).into_iter().enumerate() {
                    if fixed {
                        held.push((body, block.coordinates(node), component));
                    }
                }
            }
            for load in &scene.loads {
                for face in loaded_faces(&self.grid, load.face, None) {
                    let nodes = face.map(|node| block.coordinates(node));
                    for (point, weight) in nodes.into_iter().zip(face_weights(&nodes)) {
                        loads.push((body, point, load.traction.map(|traction| weight * traction)));
                    }
                }
            }
        }
        let nodes = self.boundary.points.iter().map(|point| point.position);
        let contact = nodes.map(|[i, j]| {
            let lower = blocks[0].coordinates([i, j, self.grid.cells[2]]);
            [lower, blocks.get(1).map_or(lower, |block| block.coordinates([i, j, 0]))]
        });
        let contact: Vec<[[f64; 3]; 2]> = contact.collect();
        let frame = |(body, block): (usize, &Block)| {
            let own = held.iter().filter(|(holder, ..)| *holder == body).map(|(_, point, _)| *point);
            Frame::new(&own.collect::<Vec<_>>(), &block.points().collect::<Vec<_>>())
        };
        let frames = blocks.iter().enumerate().map(frame).collect();
        RigidScene { bodies: blocks.len(), held, loads, contact, frames }
    }
}
