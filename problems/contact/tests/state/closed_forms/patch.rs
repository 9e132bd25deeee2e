//! Contact patch test: a block pressed flat onto a plane has the pressure of its load at every node, when each node
//! stands for its tributary area: whole inside, half on edges, a quarter in corners.

use super::setting::{THIRD, block, load, pressures, solve, support, torn};
use crate::common::set_upper_block;
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::SolverKind;
use contact::scene::{CounterSurface, Scene};

const PRESSURE: f64 = 250.0;

/// A block of unequal edges on bricks of unequal edges.
fn one_body() -> Scene {
    let material = Material::new(1.1e5, 0.33).unwrap();
    let scene = block([60.0, 20.0], 30.0, [6, 4, 4], material, CounterSurface::Plane { height: 30.0 });
    let mut scene = torn(scene, [3, 2, 2]);
    scene.bodies[0].loads = vec![load(BlockFace::Bottom, [0.0, 0.0, PRESSURE])];
    scene
}

fn two_bodies() -> Scene {
    let mut scene = one_body();
    scene.bodies[0].loads.clear();
    scene.bodies[0].supports = vec![support(BlockFace::Bottom, THIRD)];
    let material = Material::new(7.0e4, 0.2).unwrap();
    let loads = vec![load(BlockFace::Top, [0.0, 0.0, -PRESSURE])];
    set_upper_block(&mut scene, 45.0, material, vec![], loads);
    scene
}

#[test]
fn uniform_pressure() {
    for (name, scene) in [("one body", one_body()), ("two bodies", two_bodies())] {
        for kind in [SolverKind::Newton, SolverKind::Direct] {
            let (shape, state) = solve(&scene, kind);
            let errors =
                pressures(&shape, &state).into_iter().map(|(_, area, force)| (force / (area * PRESSURE) - 1.0).abs());
            let worst = errors.fold(0.0, f64::max);
            println!("patch test, {name}, {kind:?}: largest relative error of a pressure {worst:.1e}");
            assert!(worst < 1e-12, "{name} {kind:?} {worst:.1e}");
        }
    }
}

/// Every brick of every body carries −p along e₃ and nothing else.
#[test]
fn uniform_stress() {
    for (name, scene) in [("one body", one_body()), ("two bodies", two_bodies())] {
        for kind in [SolverKind::Newton, SolverKind::Direct] {
            let (shape, state) = solve(&scene, kind);
            let fields = shape.fields(&state).unwrap();
            let mut worst: f64 = 0.0;
            for body in &fields.bodies {
                for (stress, von_mises) in body.stress.iter().zip(&body.von_mises) {
                    let exact = [0.0, 0.0, -PRESSURE, 0.0, 0.0, 0.0];
                    let errors = stress.iter().zip(exact).map(|(found, exact)| (found - exact).abs() / PRESSURE);
                    worst = errors.fold(worst, f64::max).max((von_mises / PRESSURE - 1.0).abs());
                }
                let nodal = body.nodal_von_mises.iter().map(|found| (found / PRESSURE - 1.0).abs());
                worst = nodal.fold(worst, f64::max);
            }
            println!("patch test, {name}, {kind:?}: largest relative error of a stress {worst:.1e}");
            assert!(worst < 1e-11, "{name} {kind:?} {worst:.1e}");
        }
    }
}
