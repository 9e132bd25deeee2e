//! Patch tests across an interface of meshes that do not match: bodies in uniform stress have it everywhere.

use crate::setting::{body, boxed, lattice, pair, stacked};
use contact::contact_shape::{ContactShape, SolverKind};
use contact::scene::{ContactKind, NormalKind, Scene};
use nonsmooth::{Accuracy, StateSolver, Vector};

const MATERIAL: [f64; 2] = [1000.0, 0.3];
const PRESSURE: f64 = 10.0;

/// Two cubes of 10 mm with so many boxes along the edges of their contact faces.
fn cubes([lower, upper]: [usize; 2], distortion: f64, slave: usize) -> Scene {
    let own =
        |count: usize, from: f64| boxed([count, count, 2], distortion, [0.0, 0.0, from], [10.0, 10.0, from + 10.0]);
    let mut lower = body("lower", own(lower, 0.0), MATERIAL);
    lower.shape = lattice([0.0; 3], [10.0; 3], [true; 3]);
    let upper = body("upper", own(upper, 10.0), MATERIAL);
    pair(stacked(lower, upper, PRESSURE), slave, 0.0)
}

/// Largest errors of the pressures, over the pressure, and of the displacements, over the largest one.
fn errors(scene: &Scene, kind: SolverKind) -> [f64; 2] {
    let shape = ContactShape::new(scene.clone(), kind).unwrap();
    let controls = Vector::zeros(scene.control_count());
    let state = shape.solve(&controls, None, Accuracy::TIGHTEST).unwrap();
    let pressures = state.rows.pressures(&state.forces.normal);
    let pressure = pressures.iter().map(|found| (found / PRESSURE - 1.0).abs()).fold(0.0, f64::max);
    let strain = PRESSURE / MATERIAL[0];
    let mut displacement: f64 = 0.0;
    for body in shape.bodies(&state).unwrap() {
        for (x, u) in body.positions.iter().zip(&body.displacement) {
            let exact = [MATERIAL[1] * strain * x[0], MATERIAL[1] * strain * x[1], -strain * x[2]];
            (0..3).for_each(|axis| displacement = displacement.max((u[axis] - exact[axis]).abs()));
        }
    }
    [pressure, displacement / (strain * 20.0)]
}

const GRIDS: [[usize; 2]; 6] = [[3, 4], [4, 3], [6, 8], [8, 6], [7, 5], [5, 7]];

fn check(distortion: f64, allowed: f64) {
    for grids in GRIDS {
        for slave in [0, 1] {
            for normal in [NormalKind::Surface, NormalKind::X3] {
                let mut scene = cubes(grids, distortion, slave);
                scene.contacts[0].normal = normal;
                for kind in [SolverKind::Direct, SolverKind::Newton] {
                    let found = errors(&scene, kind);
                    println!("{grids:?} slave {slave} {normal:?} {kind:?}: {:.1e} {:.1e}", found[0], found[1]);
                    assert!(
                        found.iter().all(|error| *error < allowed),
                        "{grids:?} {slave} {normal:?} {kind:?}: {found:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn flat_interfaces_of_regular_grids_pass() {
    check(0.0, 1e-9);
}

#[test]
fn flat_interfaces_of_distorted_grids_pass() {
    check(0.2, 1e-5);
}

#[test]
fn glued_interfaces_pass_under_pull() {
    for kind in [SolverKind::Direct, SolverKind::Newton] {
        let mut scene = cubes([3, 4], 0.0, 1);
        scene.contacts[0].kind = ContactKind::Tied;
        // A further contact gives the scene nodes that may open.
        let floor = contact::scene::Master::Obstacle(contact::scene::CounterSurface::Plane { height: 21.0 });
        scene.contacts.push(contact::scene::ContactScene::along_x3(
            contact::scene::BodyFace::new(1, "top"),
            floor,
            0.0,
        ));
        scene.bodies[1].loads.clear();
        scene.bodies[1].loads =
            vec![contact::scene::Load { place: None, kind: contact::scene::LoadKind::BodyForce([0.0, 0.0, 0.5]) }];
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let state = shape.solve(&Vector::zeros(scene.control_count()), None, Accuracy::TIGHTEST).unwrap();
        let total: f64 = state.forces.ties.iter().map(|force| force[2]).sum();
        println!("{kind:?}: {total} {:?}", state.forces.counts());
        assert!((total / 500.0 - 1.0).abs() < 1e-9, "{total}");
    }
}
