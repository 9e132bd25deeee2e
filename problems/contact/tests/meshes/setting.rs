//! Scenes of meshes: bodies under obstacles along true normals, with a lattice around them.

use crate::grid::Point;
use contact::body::elasticity::Material;
use contact::body::mesh::Mesh;
use contact::contact_shape::{ContactShape, ContactState, SolverKind};
use contact::scene::{
    BodyFace, BodyScene, ContactScene, CounterSurface, Geometry, Load, Master, MeshGeometry, Scene, Support,
};
use contact::shape::{Coordinates, LatticeShape};
use nonsmooth::{Accuracy, StateSolver, Vector};
use std::sync::Arc;

/// Both paths to a state.
pub const PATHS: [SolverKind; 2] = [SolverKind::Newton, SolverKind::Direct];

/// Young's modulus (MPa) and Poisson's ratio where nothing else is said.
pub const ELASTIC: [f64; 2] = [1000.0, 0.3];

/// A body that touches an obstacle with its top, in pieces, without supports and loads, in a lattice of 2³ points.
pub fn scene(mesh: Mesh, obstacle: CounterSurface, friction: f64) -> Scene {
    let (corner, size) = extent(mesh.nodes());
    let geometry = Geometry::Mesh(MeshGeometry { mesh: Arc::new(mesh), pieces: Some(3) });
    Scene {
        name: "mesh".into(),
        bodies: vec![BodyScene {
            shape: Some(lattice(corner, size, [2; 3])),
            ..BodyScene::new("body", geometry, material(ELASTIC))
        }],
        contacts: vec![ContactScene::new(BodyFace::new(0, "top"), Master::Obstacle(obstacle), friction)],
    }
}

pub fn material([young_modulus, poisson_ratio]: [f64; 2]) -> Material {
    Material::new(young_modulus, poisson_ratio).unwrap()
}

/// A lattice of Bernstein polynomials over a box along the axes, all of whose points move every way.
pub fn lattice(corner: Point, size: Point, control_points: [usize; 3]) -> LatticeShape {
    let edge = |axis: usize| std::array::from_fn(|other| if other == axis { size[axis] } else { 0.0 });
    let coordinates = Coordinates::Cartesian { corner, edges: std::array::from_fn(edge) };
    LatticeShape {
        degrees: control_points.map(|count| count - 1),
        hold_supports: false,
        ..LatticeShape::new(coordinates, control_points, [-10.0, 10.0])
    }
}

/// First corner and edges of the box around some points.
pub fn extent(points: &[Point]) -> (Point, Point) {
    let least = |axis: usize| points.iter().map(|x| x[axis]).fold(f64::INFINITY, f64::min);
    let most = |axis: usize| points.iter().map(|x| x[axis]).fold(f64::NEG_INFINITY, f64::max);
    (std::array::from_fn(least), std::array::from_fn(|axis| most(axis) - least(axis)))
}

pub fn held(face: &str, components: [bool; 3]) -> Support {
    Support::new(face, components)
}

pub fn pushed(face: &str, traction: Point) -> Load {
    Load::traction(face, traction)
}

/// The mesh of a scene.
pub fn mesh_of(scene: &Scene) -> &Mesh {
    match &scene.bodies[0].geometry {
        Geometry::Mesh(geometry) => &geometry.mesh,
        Geometry::Block(_) => unreachable!("scenes here are of meshes"),
    }
}

/// The lattice of a scene.
pub fn lattice_of(scene: &mut Scene) -> &mut LatticeShape {
    scene.bodies[0].shape.as_mut().expect("scenes here have lattices")
}

/// The state of a scene at some controls, or at the start.
pub fn solve(scene: &Scene, kind: SolverKind, controls: Option<&Vector>) -> (ContactShape, ContactState) {
    let shape = ContactShape::new(scene.clone(), kind).unwrap();
    let state = shape.solve(controls.unwrap_or(&shape.start()), None, Accuracy::TIGHTEST).unwrap();
    (shape, state)
}

/// Largest difference of two lists of vectors over the largest length of the second.
pub fn difference(first: &[Point], second: &[Point]) -> f64 {
    use crate::elements::{norm, plus};
    assert_eq!(first.len(), second.len());
    let largest = second.iter().map(|x| norm(*x)).fold(0.0, f64::max);
    first.iter().zip(second).map(|(a, b)| norm(plus(*a, -1.0, *b))).fold(0.0, f64::max) / largest
}

/// A rotation about an axis of no particular direction.
#[derive(Debug, Clone, Copy)]
pub struct Rotation([Point; 3]);

impl Rotation {
    /// About the direction (2, −1, 2) by an angle.
    pub fn about(angle: f64) -> Self {
        let axis = [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0];
        let (sine, cosine) = angle.sin_cos();
        let entry = |i: usize, j: usize| {
            let skew = [[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]];
            let identity = f64::from(u8::from(i == j));
            cosine * identity + sine * skew[i][j] + (1.0 - cosine) * axis[i] * axis[j]
        };
        Self(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))))
    }

    pub fn of(&self, x: Point) -> Point {
        self.0.map(|row| crate::elements::dot(row, x))
    }
}
