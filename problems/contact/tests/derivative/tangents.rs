//! Forward derivatives of the contact state against the adjoint, to rounding, and against states of moved surfaces.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::equilibrium::ContactSolver;
use contact::scene::{Scene, hertz, signorini};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{Accuracy, StateSolver, Vector};

fn shape(mut scene: Scene, friction: f64, kind: SolverKind) -> ContactShape {
    (scene.mesh, scene.friction) = ([6; 3], friction);
    ContactShape::new(scene, kind).unwrap()
}

/// Controls near the start of a scene.
fn controls(shape: &ContactShape, seed: u64) -> Vector {
    shape.start() + seeded_direction(36, seed) * 2.0
}

/// Heights of the contact nodes for some unit controls.
fn changes(shape: &ContactShape, columns: &[usize]) -> Vec<Vec<f64>> {
    let unit = |k: usize| (0..36).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
    columns.iter().map(|&k| shape.problem().height_map.heights(&unit(k))).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// jᵀ(∂λ δF) = (∂J/∂F)ᵀ δF for random duals j.
fn forward_and_adjoint_agree(shape: &ContactShape, tolerance: f64) {
    let solver = shape.contact_solver();
    for seed in 0..3 {
        let state = shape.solve(&controls(shape, seed), None, Accuracy::TIGHTEST).unwrap();
        let changes = changes(shape, &[0, 7, 20, 35]);
        let tangents = solver.tangents(&state.solution, &changes, 0.0).unwrap();
        assert!(tangents.residual < 1e-10, "{:e}", tangents.residual);
        let dual = seeded_direction(shape.problem().boundary.row_count, 100 + seed);
        let heights = solver.sensitivities(&state.solution, dual.as_slice(), 1e-12).unwrap().heights;
        for (forces, change) in tangents.forces.iter().zip(&changes) {
            let (forward, adjoint) = (dot(forces, dual.as_slice()), dot(&heights, change));
            let size: f64 = forces.iter().zip(dual.iter()).map(|(a, b)| (a * b).abs()).sum();
            assert!((forward - adjoint).abs() <= tolerance * size, "{forward} {adjoint} {size}");
        }
    }
}

#[test]
fn tangents_of_direct_condensation_agree_with_its_adjoint() {
    for friction in [0.0, 0.3] {
        forward_and_adjoint_agree(&shape(signorini().unwrap(), friction, SolverKind::Direct), 1e-10);
        forward_and_adjoint_agree(&shape(hertz().unwrap(), friction, SolverKind::Direct), 1e-10);
    }
}

#[test]
fn forces_and_openings_of_moved_surfaces_differ_by_the_tangents() {
    const STEP: f64 = 1e-4;
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        let shape = shape(scene, 0.3, SolverKind::Direct);
        let at = controls(&shape, 5);
        let solve = |controls: &Vector| shape.solve(controls, None, Accuracy::TIGHTEST).unwrap();
        let state = solve(&at);
        let column = 14;
        let tangents = shape.contact_solver().tangents(&state.solution, &changes(&shape, &[column]), 0.0).unwrap();
        let mut moved = [at.clone(), at];
        moved[0][column] += STEP;
        moved[1][column] -= STEP;
        let [ahead, behind] = moved.map(|controls| solve(&controls));
        assert_eq!(ahead.forces.status, behind.forces.status, "a kink lies between");
        let points = &shape.problem().boundary.points;
        let quotient = |pair: fn(&contact::equilibrium::ContactForces) -> &[f64]| -> Vec<f64> {
            let (a, b) = (pair(&ahead.forces), pair(&behind.forces));
            a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * STEP)).collect()
        };
        let forces: Vec<f64> = points.iter().map(|point| tangents.forces[0][point.start]).collect();
        for (found, expected) in
            [(forces, quotient(|f| &f.normal)), (tangents.openings[0].clone(), quotient(|f| &f.opening))]
        {
            let size = expected.iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() <= 1e-5 * size, "{found} {expected} of {size}");
            }
        }
    }
}
