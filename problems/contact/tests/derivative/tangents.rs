//! Forward derivatives of the contact state against the adjoint, to rounding, and against states of moved surfaces.

use crate::common::unit;

use contact::body::elasticity::Material;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::equilibrium::{Tangents, TangentsOf};
use contact::scene::{Scene, hertz, signorini};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{Accuracy, StateSolver, Vector};

fn shape(scene: Scene, friction: f64, kind: SolverKind) -> ContactShape {
    ContactShape::new(scene.with_bricks([6; 3], [2, 3, 2]).with_friction(friction), kind).unwrap()
}

/// Both scenes without and with friction.
fn scenes() -> impl Iterator<Item = (Scene, f64)> {
    [0.0, 0.3].into_iter().flat_map(|friction| [signorini(), hertz()].map(|scene| (scene.unwrap(), friction)))
}

/// Controls near the start of a scene.
fn controls(shape: &ContactShape, seed: u64) -> Vector {
    shape.start() + seeded_direction(36, seed) * 2.0
}

/// Some unit changes of the controls.
fn changes(columns: &[usize]) -> Vec<Vec<f64>> {
    columns.iter().map(|&column| unit(36, column)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// jᵀ(∂λ δF) = (∂J/∂F)ᵀ δF for random duals j.
fn forward_and_adjoint_agree(shape: &ContactShape, tolerance: f64) {
    let solver = shape.contact_solver();
    for seed in 0..3 {
        let state = shape.solve(&controls(shape, seed), None, Accuracy::TIGHTEST).unwrap();
        let changes = changes(&[0, 7, 20, 35]);
        let tangents = solver.tangents(&state.solution, &changes, TangentsOf::Contact, 0.0).unwrap();
        assert!(tangents.residual < 1e-10, "{:e}", tangents.residual);
        let dual = seeded_direction(shape.problem().boundary.row_count, 100 + seed);
        let positions = solver.sensitivities(&state.solution, dual.as_slice(), 1e-12).unwrap().positions;
        let controls = shape.problem().map.pull_back(&positions);
        for (forces, change) in tangents.forces.iter().zip(&changes) {
            let (forward, adjoint) = (dot(forces, dual.as_slice()), dot(&controls, change));
            let size: f64 = forces.iter().zip(dual.iter()).map(|(a, b)| (a * b).abs()).sum();
            assert!((forward - adjoint).abs() <= tolerance * size, "{forward} {adjoint} {size}");
        }
    }
}

#[test]
fn tangents_of_direct_condensation_agree_with_its_adjoint() {
    for (scene, friction) in scenes() {
        forward_and_adjoint_agree(&shape(scene, friction, SolverKind::Direct), 1e-10);
    }
}

#[test]
fn tangents_of_total_feti_agree_with_its_adjoint() {
    for (scene, friction) in scenes() {
        forward_and_adjoint_agree(&shape(scene, friction, SolverKind::Newton), 1e-9);
    }
}

/// |a − b|/|b| over all columns.
fn difference(found: &[Vec<f64>], expected: &[Vec<f64>]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let norm = |entries: Vec<f64>| entries.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    let pairs = found.iter().flatten().zip(expected.iter().flatten());
    norm(pairs.map(|(a, b)| a - b).collect()) / norm(expected.concat())
}

#[test]
fn both_solvers_have_the_same_tangents() {
    for (scene, friction) in scenes() {
        let both = [SolverKind::Newton, SolverKind::Direct].map(|kind| {
            let shape = shape(scene.clone(), friction, kind);
            let state = shape.solve(&controls(&shape, 3), None, Accuracy::TIGHTEST).unwrap();
            let changes = changes(&[1, 8, 21]);
            shape.contact_solver().tangents(&state.solution, &changes, TangentsOf::Contact, 0.0).unwrap()
        });
        assert!(both[0].applications > 0 && both[1].applications == 0);
        let errors = [difference(&both[0].forces, &both[1].forces), difference(&both[0].openings, &both[1].openings)];
        assert!(errors.into_iter().all(|error| error < 1e-8), "{errors:?}");
    }
}

#[test]
fn tangents_of_total_feti_are_as_accurate_as_asked_for() {
    for (scene, friction) in scenes() {
        let shape = shape(scene, friction, SolverKind::Newton);
        let state = shape.solve(&controls(&shape, 4), None, Accuracy::TIGHTEST).unwrap();
        // More columns than advance in lockstep: two batches.
        let changes = changes(&(0..45).map(|k| k % 36).collect::<Vec<_>>());
        let solve = |tolerance| {
            shape.contact_solver().tangents(&state.solution, &changes, TangentsOf::Contact, tolerance).unwrap()
        };
        let exact = solve(0.0);
        let mut applications = exact.applications;
        for tolerance in [1e-4, 1e-2] {
            let rough = solve(tolerance);
            assert!(rough.residual <= tolerance, "{:e}", rough.residual);
            assert!(rough.applications < applications, "{} {applications}", rough.applications);
            applications = rough.applications;
            let errors = [difference(&rough.forces, &exact.forces), difference(&rough.openings, &exact.openings)];
            assert!(errors.into_iter().all(|error| error <= 3.0 * tolerance), "{errors:?} {tolerance:e}");
        }
    }
}

/// Ten tangents by total FETI to a tolerance.
fn ten_tangents(scene: Scene, tolerance: f64) -> Tangents {
    let shape = shape(scene, 0.3, SolverKind::Newton);
    let state = shape.solve(&controls(&shape, 6), None, Accuracy::TIGHTEST).unwrap();
    let changes = changes(&(5..15).collect::<Vec<_>>());
    shape.contact_solver().tangents(&state.solution, &changes, TangentsOf::Contact, tolerance).unwrap()
}

#[test]
fn tangents_do_not_depend_on_the_number_of_threads() {
    for tolerance in [1e-2, 0.0] {
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| ten_tangents(hertz().unwrap(), tolerance))
        });
        assert_eq!((one.forces, one.openings, one.residual), (three.forces, three.openings, three.residual));
    }
}

#[test]
fn tangents_in_single_precision_do_not_depend_on_the_unit_of_force() {
    let unit = ten_tangents(signorini().unwrap(), 1e-2);
    for factor in [1e-9, 1e9] {
        let mut scene = signorini().unwrap();
        let material = scene.bodies[0].material;
        scene.bodies[0].material = Material::new(factor * material.young_modulus(), material.poisson_ratio()).unwrap();
        for load in &mut scene.bodies[0].loads {
            *load = load.scaled(factor);
        }
        let mut other = ten_tangents(scene, 1e-2);
        assert_eq!(other.applications, unit.applications);
        other.forces.iter_mut().flatten().for_each(|force| *force /= factor);
        let errors = [difference(&other.forces, &unit.forces), difference(&other.openings, &unit.openings)];
        assert!(errors.into_iter().all(|error| error < 1e-4), "{errors:?}");
    }
}

#[test]
fn changes_of_another_surface_are_refused() {
    let shape = shape(signorini().unwrap(), 0.3, SolverKind::Newton);
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    let error =
        shape.contact_solver().tangents(&state.solution, &[vec![1.0; 3]], TangentsOf::Contact, 0.0).unwrap_err();
    assert!(error.to_string().contains("3 controls, 36 expected"), "{error}");
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
        let tangents =
            shape.contact_solver().tangents(&state.solution, &changes(&[column]), TangentsOf::Contact, 0.0).unwrap();
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
