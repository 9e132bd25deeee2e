//! A block under a rigid obstacle, or under a second block, as a starting point for all cases.

use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, ContactState, SolverKind};
use contact::scene::{BodyScene, CounterSurface, Load, Scene, Support};
use contact::shape::{ShapeBounds, SplineKind};
use nonsmooth::{Accuracy, StateSolver};

pub const FIRST: [bool; 3] = [true, false, false];
pub const SECOND: [bool; 3] = [false, true, false];
pub const THIRD: [bool; 3] = [false, false, true];
pub const ALL: [bool; 3] = [true; 3];

pub fn support(face: Face, components: [bool; 3]) -> Support {
    Support { face, components }
}

pub fn load(face: Face, traction: [f64; 3]) -> Load {
    Load { face, traction }
}

pub fn block(size: [f64; 2], height: f64, mesh: [usize; 3], material: Material, obstacle: CounterSurface) -> Scene {
    Scene {
        name: "closed form".into(),
        size,
        mesh,
        subdomains: [1; 3],
        lower: BodyScene { material, supports: vec![], loads: vec![] },
        upper: None,
        counter_surface: obstacle,
        friction: 0.0,
        surface: SplineKind::BSpline(1),
        control_points: [2, 2],
        bounds: ShapeBounds { minimum_height: 0.0, slope: 1e3, volume: [0.0, 1e30] },
        start_height: height,
    }
}

pub fn solve(scene: &Scene, kind: SolverKind) -> (ContactShape, ContactState) {
    let shape = ContactShape::new(scene.clone(), kind).unwrap();
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    (shape, state)
}

/// (x₁, x₂, area, λ_N) of all contact nodes.
pub fn pressures(shape: &ContactShape, state: &ContactState) -> Vec<([f64; 2], f64, f64)> {
    let problem = shape.problem();
    let points = problem.boundary.points.iter().zip(&state.forces.normal);
    points
        .map(|(point, force)| (problem.grid.position(point.position[0], point.position[1]), point.area, *force))
        .collect()
}
