//! Two bodies of meshes on top of each other.

use contact::body::elasticity::Material;
use contact::body::mesh::{CellKind, Mesh};
use contact::scene::{BodyFace, BodyScene, ContactScene, Geometry, Load, Master, MeshGeometry, Scene, Support};
use contact::shape::{Coordinates, Directions, LatticeShape};
use std::sync::Arc;

pub use crate::grid::{Point, mesh};

/// A body of a mesh in a few pieces, without supports, loads and controls.
pub fn body(name: &str, mesh: Mesh, [modulus, ratio]: [f64; 2]) -> BodyScene {
    let geometry = Geometry::Mesh(MeshGeometry { mesh: Arc::new(mesh), pieces: Some(3) });
    BodyScene::new(name, geometry, Material::new(modulus, ratio).unwrap())
}

/// A mesh of hexahedra of a box between two corners; `distortion`: how far vertices are moved within its sides.
pub fn boxed(boxes: [usize; 3], distortion: f64, from: Point, to: Point) -> Mesh {
    let map = |x: Point| std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * x[axis]);
    mesh(CellKind::Hex8, boxes, distortion, map)
}

/// A lattice of 2 × 2 × 2 control points around a box.
pub fn lattice(corner: Point, size: Point, axes: [bool; 3]) -> Option<LatticeShape> {
    let edges = std::array::from_fn(|axis| std::array::from_fn(|k| if k == axis { size[axis] } else { 0.0 }));
    let range = [-0.2 * size[0], 0.2 * size[0]];
    let lattice = LatticeShape::new(Coordinates::Cartesian { corner, edges }, [2; 3], range);
    Some(LatticeShape { directions: Directions::Axes(axes), ..lattice })
}

/// Symmetry planes x₁ = 0 and x₂ = 0.
pub fn symmetric() -> Vec<Support> {
    vec![Support::new("x1-min", [true, false, false]), Support::new("x2-min", [false, true, false])]
}

/// A lower body, whose top touches the bottom of an upper one, pushed down by a traction on its top.
pub fn stacked(mut lower: BodyScene, mut upper: BodyScene, push: f64) -> Vec<BodyScene> {
    (lower.supports, upper.supports) = (symmetric(), symmetric());
    lower.supports.push(Support::new("bottom", [false, false, true]));
    upper.loads = vec![Load::traction("top", [0.0, 0.0, -push])];
    vec![lower, upper]
}

/// The scene of two bodies on top of each other; `slave`: the body with the contact nodes.
pub fn pair(bodies: Vec<BodyScene>, slave: usize, friction: f64) -> Scene {
    let face = |body: usize| BodyFace::new(body, if body == 0 { "top" } else { "bottom" });
    let contact = ContactScene::new(face(slave), Master::Body(face(1 - slave)), friction);
    Scene { name: "pair".into(), bodies, contacts: vec![contact] }
}
