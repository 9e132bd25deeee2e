//! Patch tests: a body in uniform stress has it in every cell and at every contact node, however its cells are
//! distorted, and however it lies in space.

use crate::elements::{dot, norm, plus};
use crate::grid::{KINDS, Point, boxed, mesh};
use crate::setting::{PATHS, Rotation, difference, held, material, pushed, scene, solve};
use contact::body::mesh::CellKind;
use contact::contact_shape::{ContactShape, ContactState, SolverKind};
use contact::equilibrium::ContactStatus;
use contact::scene::{CounterSurface, Load, LoadKind, Master, Scene};

const SIZE: Point = [30.0, 20.0, 12.0];
const PRESSURE: f64 = 25.0;
const SHEAR: f64 = 5.0;
/// Rounding of a solve: the condition number of these small bodies is at most 1e5.
const ROUNDING: f64 = 1e-10;

/// Turned about an axis that is oblique to all sides; not turned where the angle is 0.
fn block(kind: CellKind, angle: f64, friction: f64) -> Scene {
    let turn = Rotation::about(angle);
    let map = boxed(SIZE);
    let mesh = mesh(kind, [4, 3, 3], 0.25, |place| turn.of(map(place)));
    let (point, normal) = (turn.of([3.0, 5.0, SIZE[2]]), turn.of([0.0, 0.0, 1.0]));
    scene(mesh, CounterSurface::TiltedPlane { point, normal }, friction)
}

/// Pressed by a pressure on its bottom, which turns with the body.
fn pressed(kind: CellKind, angle: f64) -> Scene {
    let mut scene = block(kind, angle, 0.0);
    scene.bodies[0].loads = vec![Load { place: Some("bottom".into()), kind: LoadKind::Pressure(PRESSURE) }];
    scene
}

/// Sheared along its first edge as well, by tractions on both ends and the bottom; friction holds it. Without Poisson's
/// effect, no point of the top moves.
fn sheared(kind: CellKind, angle: f64) -> Scene {
    let turn = Rotation::about(angle);
    let mut scene = block(kind, angle, 0.3);
    scene.bodies[0].material = material([1000.0, 0.0]);
    scene.bodies[0].loads = vec![
        pushed("bottom", turn.of([-SHEAR, 0.0, PRESSURE])),
        pushed("x1-max", turn.of([0.0, 0.0, SHEAR])),
        pushed("x1-min", turn.of([0.0, 0.0, -SHEAR])),
    ];
    scene
}

/// Pressures and tangential tractions of all contact nodes, MPa.
fn tractions(state: &ContactState) -> (Vec<f64>, Vec<Point>) {
    let areas = state.rows.areas();
    let tangential = state.forces.tangential.iter().zip(&areas);
    let tangential = tangential.map(|(force, area)| force.map(|force| force / area)).collect();
    (state.rows.pressures(&state.forces.normal), tangential)
}

/// Largest difference of a stress to the uniform one, turned, over the pressure. Stresses are in the order 11, 22, 33,
/// 12, 23, 13.
fn stress_error(shape: &ContactShape, state: &ContactState, turn: &Rotation, shear: f64) -> f64 {
    let axes: [Point; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| turn.of(axis));
    let exact = |i: usize, j: usize| {
        -PRESSURE * axes[2][i] * axes[2][j] + shear * (axes[0][i] * axes[2][j] + axes[2][i] * axes[0][j])
    };
    let exact = [exact(0, 0), exact(1, 1), exact(2, 2), exact(0, 1), exact(1, 2), exact(0, 2)];
    let fields = shape.fields(state).unwrap();
    let errors = fields.bodies[0].stress.iter().flat_map(|stress| {
        let pairs = stress.iter().zip(&exact);
        pairs.map(|(found, exact)| (found - exact).abs()).collect::<Vec<f64>>()
    });
    errors.fold(0.0, f64::max) / PRESSURE
}

#[test]
fn a_pressed_block_has_the_pressure_of_its_load_at_every_node() {
    for kind in KINDS {
        for angle in [0.0, 0.7, 2.5] {
            for path in PATHS {
                let (shape, state) = solve(&pressed(kind, angle), path, None);
                let (pressures, _) = tractions(&state);
                let worst = pressures.iter().map(|p| (p / PRESSURE - 1.0).abs()).fold(0.0, f64::max);
                let total = state.forces.total_normal_force() / (PRESSURE * SIZE[0] * SIZE[1]) - 1.0;
                let stress = stress_error(&shape, &state, &Rotation::about(angle), 0.0);
                println!("pressed, {kind:?}, {path:?}, {angle}: {worst:.1e}, total {total:.1e}, stress {stress:.1e}");
                assert_eq!(pressures.len(), 20);
                assert!(worst < ROUNDING && total.abs() < ROUNDING && stress < ROUNDING, "{kind:?} {path:?} {angle}");
            }
        }
    }
}

#[test]
fn a_sheared_block_that_friction_holds_has_the_traction_of_its_load_at_every_node() {
    for kind in KINDS {
        for angle in [0.0, 0.7] {
            for path in PATHS {
                let (shape, state) = solve(&sheared(kind, angle), path, None);
                let turn = Rotation::about(angle);
                let (pressures, tangential) = tractions(&state);
                let worst = pressures.iter().map(|p| (p / PRESSURE - 1.0).abs()).fold(0.0, f64::max);
                let exact = turn.of([-SHEAR, 0.0, 0.0]);
                let along = tangential.iter().map(|t| norm(plus(*t, -1.0, exact)) / SHEAR).fold(0.0, f64::max);
                let stress = stress_error(&shape, &state, &turn, SHEAR);
                println!("sheared, {kind:?}, {path:?}, {angle}: {worst:.1e}, along {along:.1e}, stress {stress:.1e}");
                assert!(worst < ROUNDING && along < ROUNDING && stress < ROUNDING, "{kind:?} {path:?} {angle}");
                assert!(state.forces.status.iter().all(|status| *status == ContactStatus::Stick));
            }
        }
    }
}

/// A block that is pressed and bent over an obstacle of another slope, so that part of it opens: no closed form, but
/// the same state from whatever side it is seen.
#[test]
fn a_turned_block_has_the_turned_forces() {
    let bent = |kind: CellKind, angle: f64, friction: f64, path: SolverKind| {
        let turn = Rotation::about(angle);
        let mut scene = block(kind, angle, friction);
        let (point, normal) = (turn.of([3.0, 5.0, SIZE[2]]), turn.of([0.03, -0.02, 1.0]));
        scene.contacts[0].master = Master::Obstacle(CounterSurface::TiltedPlane { point, normal });
        scene.bodies[0].supports = vec![held("x1-min", [true; 3])];
        scene.bodies[0].loads = vec![pushed("bottom", turn.of([1.0, 0.5, 6.0]))];
        let (_, state) = solve(&scene, path, None);
        let rows = state.rows.nodes.iter().zip(&state.forces.normal);
        let mut forces: Vec<Point> = rows.map(|(row, force)| row.normal.map(|n| force * n)).collect();
        for (force, tangential) in forces.iter_mut().zip(&state.forces.tangential) {
            *force = plus(*force, 1.0, *tangential);
        }
        (forces, state.forces.status.clone(), turn)
    };
    for kind in KINDS {
        for friction in [0.0, 0.3] {
            for path in PATHS {
                let (straight, status, _) = bent(kind, 0.0, friction, path);
                let (found, turned_status, turn) = bent(kind, 1.1, friction, path);
                let turned: Vec<Point> = straight.iter().map(|force| turn.of(*force)).collect();
                let error = difference(&found, &turned);
                let open = status.iter().filter(|status| **status == ContactStatus::Open).count();
                println!("bent, {kind:?}, {path:?}, friction {friction}: {error:.1e}, {open} open of {}", status.len());
                assert!(error < ROUNDING, "{kind:?} {path:?} {friction}: {error:.1e}");
                assert_eq!(status, turned_status);
                assert!(open > 0 && open < status.len(), "some nodes touch, some do not");
                assert!(straight.iter().any(|force| dot(*force, *force) > 0.0));
            }
        }
    }
}
