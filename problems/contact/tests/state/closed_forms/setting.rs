//! A block under a rigid obstacle, or under a second block, as a starting point for all cases.

use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, ContactState, SolverKind};
use contact::scene::{
    Block, BodyFace, BodyScene, ContactScene, CounterSurface, Geometry, Load, Master, Scene, Support,
};
use contact::shape::{LatticeShape, ShapedFace};
use nonsmooth::{Accuracy, StateSolver};

pub const FIRST: [bool; 3] = [true, false, false];
pub const SECOND: [bool; 3] = [false, true, false];
pub const THIRD: [bool; 3] = [false, false, true];
pub const ALL: [bool; 3] = [true; 3];

pub fn support(face: BlockFace, components: [bool; 3]) -> Support {
    Support::new(face, components)
}

pub fn load(face: BlockFace, traction: [f64; 3]) -> Load {
    Load::traction(face, traction)
}

pub fn block(size: [f64; 2], height: f64, bricks: [usize; 3], material: Material, obstacle: CounterSurface) -> Scene {
    let heights = LatticeShape::heights(ShapedFace::Top, [2, 2], [1, 1], height);
    Scene {
        name: "closed form".into(),
        bodies: vec![BodyScene {
            shape: Some(heights),
            ..BodyScene::new("lower", Geometry::Block(Block::new(size, height, bricks, [1; 3])), material)
        }],
        contacts: vec![ContactScene::along_x3(BodyFace::new(0, BlockFace::Top), Master::Obstacle(obstacle), 0.0)],
    }
}

/// The scene in other subdomains.
pub fn torn(scene: Scene, subdomains: [usize; 3]) -> Scene {
    scene.with_blocks(|blocks| blocks.subdomains = subdomains)
}

pub fn solve(scene: &Scene, kind: SolverKind) -> (ContactShape, ContactState) {
    let shape = ContactShape::new(scene.clone(), kind).unwrap();
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    (shape, state)
}

/// Positions of all contact nodes at the start.
pub fn places(shape: &ContactShape) -> Vec<[f64; 3]> {
    let problem = shape.problem();
    let positions = problem.start_positions();
    problem.boundary.points.iter().map(|point| positions[0][point.node as usize]).collect()
}

/// (x₁, x₂, area, λ_N) of all contact nodes.
pub fn pressures(shape: &ContactShape, state: &ContactState) -> Vec<([f64; 2], f64, f64)> {
    let nodes = places(shape).into_iter().zip(state.rows.areas()).zip(&state.forces.normal);
    nodes.map(|(([x1, x2, _], area), force)| ([x1, x2], area, *force)).collect()
}
