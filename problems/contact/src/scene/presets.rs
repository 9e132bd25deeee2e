//! The paper's examples; data and readings in method.md sections 7 and 8.

use crate::body::elasticity::Material;
use crate::body::mesh::BlockFace;
use crate::error::SceneError;
use crate::scene::{Block, BodyFace, BodyScene, ContactScene, CounterSurface, Geometry, Load, Master, Scene, Support};
use crate::shape::{LatticeShape, ShapedFace};

const ALONG_X1: [bool; 3] = [true, false, false];
const ALONG_X2: [bool; 3] = [false, true, false];
const ALONG_X3: [bool; 3] = [false, false, true];

/// The shape of both examples: heights of the top, a cubic B-spline on 6 × 6 control points.
fn heights(thickness: f64, volume: [f64; 2], start: f64) -> Option<LatticeShape> {
    let heights = LatticeShape::heights(ShapedFace::Top, [6, 6], [3, 3], start);
    Some(LatticeShape { thickness: Some(thickness), slope: Some(5.0), volume: Some(volume), ..heights })
}

/// Example 5.1: an elastic block pressed from below against a rigid wavy obstacle.
///
/// # Errors
/// Never for the constants used here; the material's check is passed on.
pub fn signorini() -> Result<Scene, SceneError> {
    let block = Geometry::Block(Block::new([100.0, 100.0], 100.0, [12; 3], [2; 3]));
    let lower = BodyScene {
        supports: vec![Support::new(BlockFace::X1Min, [true, true, false])],
        loads: vec![Load::traction(BlockFace::Bottom, [0.0, 0.0, 3000.0])],
        shape: heights(50.0, [0.8e6, 1.2e6], 100.0),
        ..BodyScene::new("lower", block, Material::new(1.1e5, 0.33)?)
    };
    let obstacle = Master::Obstacle(CounterSurface::Waves {
        base: 103.0,
        first: 1.0,
        second: 2.0,
        period: 100.0,
        origin: [0.0; 2],
    });
    let contact = ContactScene::along_x3(BodyFace::new(0, BlockFace::Top), obstacle, 0.3);
    Ok(Scene { name: "signorini".into(), bodies: vec![lower], contacts: vec![contact] })
}

/// Example 5.2: a quarter of a symmetric contact of an elastic body with a spherical indenter.
///
/// # Errors
/// Never for the constants used here; the material's check is passed on.
pub fn hertz() -> Result<Scene, SceneError> {
    let symmetry = || vec![Support::new(BlockFace::X1Min, ALONG_X1), Support::new(BlockFace::X2Min, ALONG_X2)];
    let block = Block::new([10.0, 10.0], 10.0, [12; 3], [2; 3]);
    let sphere = CounterSurface::Sphere { apex: 10.0, radius: 20.0, centre: [0.0; 2] };
    let indenter = Block { bottom: sphere, top: CounterSurface::Plane { height: 20.0 }, ..block.clone() };
    let mut lower = BodyScene {
        supports: symmetry(),
        shape: heights(5.0, [800.0, 1200.0], 10.0),
        ..BodyScene::new("lower", Geometry::Block(block), Material::new(7.0e4, 0.35)?)
    };
    lower.supports.push(Support::new(BlockFace::Bottom, ALONG_X3));
    let upper = BodyScene {
        supports: symmetry(),
        loads: vec![
            Load::traction(BlockFace::Top, [0.0, 0.0, -2000.0]),
            Load::traction(BlockFace::X1Max, [500.0, 0.0, -2000.0]),
        ],
        ..BodyScene::new("upper", Geometry::Block(indenter), Material::new(2.1e5, 0.29)?)
    };
    let [slave, master] = [BodyFace::new(0, BlockFace::Top), BodyFace::new(1, BlockFace::Bottom)];
    let contact = ContactScene::along_x3(slave, Master::Body(master), 0.3);
    Ok(Scene { name: "hertz".into(), bodies: vec![lower, upper], contacts: vec![contact] })
}
