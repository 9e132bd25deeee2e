//! Independent paths give the same state: TFETI against direct condensation, several tearings and numbers of threads.

use crate::common::{bent, change_counter_surface};
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, ContactState, SolverKind};
use contact::equilibrium::ContactProblem;
use contact::scene::{CounterSurface, Load, Scene, Support, hertz, signorini};
use contact::solvers::{Processes, SolverPlan};
use contact::tfeti::{Precision, PreconditionerKind, TornOptions, TotalFeti};
use nonsmooth::{Accuracy, Coderivative, StateSolver, Vector};
use std::sync::Arc;

fn solve(scene: Scene, kind: SolverKind, bricks: usize, subdomains: usize) -> (ContactShape, ContactState) {
    let scene = scene.with_bricks([bricks; 3], [subdomains; 3]);
    let control = bent(&scene);
    let shape = ContactShape::new(scene, kind).unwrap();
    let state = shape.solve(&control, None, Accuracy::TIGHTEST).unwrap();
    (shape, state)
}

fn assert_same(first: &ContactState, second: &ContactState, label: &str) {
    let largest = first.forces.normal.iter().copied().fold(0.0, f64::max);
    let pairs = first.forces.normal.iter().zip(&second.forces.normal);
    let normal = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
    let pairs = first.forces.tangential.iter().flatten().zip(second.forces.tangential.iter().flatten());
    let tangential = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
    println!("{label}: normal {normal:.1e}, tangential {tangential:.1e}");
    assert!(normal < 1e-8 && tangential < 1e-8, "{label}: normal {normal:.1e}, tangential {tangential:.1e}");
    assert_eq!(first.forces.status, second.forces.status, "{label}");
}

#[test]
fn tfeti_equals_direct_condensation() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        for friction in [0.0, 0.3, 0.8] {
            let scene = scene.clone().with_friction(friction);
            let (_, torn) = solve(scene.clone(), SolverKind::Newton, 6, 2);
            let (_, direct) = solve(scene.clone(), SolverKind::Direct, 6, 2);
            assert_same(&torn, &direct, &format!("{} friction {friction}", scene.name));
        }
    }
}

#[test]
fn tearing_does_not_change_the_state() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        let (_, whole) = solve(scene.clone(), SolverKind::Newton, 6, 1);
        for subdomains in [2, 3, 6] {
            let (_, torn) = solve(scene.clone(), SolverKind::Newton, 6, subdomains);
            assert_same(&whole, &torn, &format!("{} S = {subdomains}", scene.name));
        }
    }
}

#[test]
fn every_preconditioner_gives_the_same_state() {
    let scene = signorini().unwrap().with_bricks([6; 3], [2; 3]);
    let control = bent(&scene);
    let state = |kind| {
        let plan = SolverPlan { preconditioner: kind, ..SolverPlan::new(scene.clone(), SolverKind::Newton) };
        let shape = ContactShape::by(Processes::alone().solver(plan).unwrap());
        shape.solve(&control, None, Accuracy::TIGHTEST).unwrap()
    };
    let reference = state(PreconditionerKind::Dirichlet);
    assert_same(&reference, &state(PreconditionerKind::Lumped), "lumped");
    assert_same(&reference, &state(PreconditionerKind::None), "none");
}

/// Largest difference over the largest entry of the second.
fn relative_difference(first: &[f64], second: &[f64]) -> f64 {
    let largest = second.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    first.iter().zip(second).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

#[test]
fn single_precision_of_search_directions_changes_neither_state_nor_subgradient() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        for friction in [0.0, 0.3] {
            let scene = scene.clone().with_bricks([6; 3], [2; 3]).with_friction(friction);
            let (label, control) = (format!("{} friction {friction}", scene.name), bent(&scene));
            let problem = Arc::new(ContactProblem::new(scene).unwrap());
            let dual: Vec<f64> = (0..problem.boundary.row_count).map(|row| (0.7 * row as f64).cos()).collect();
            let solve = |precision| {
                let solver = TotalFeti::new(Arc::clone(&problem), TornOptions::default()).unwrap();
                let solver = solver.with_precision(precision);
                let state = solver.solve(control.as_slice(), None, 0.0).unwrap();
                let adjoint = solver.sensitivities(&state.solution, &dual, 1e-11).unwrap();
                let products = state.work().dual_operator_applications;
                (state.forces, adjoint.positions.concat(), products)
            };
            let (mixed, mixed_slopes, mixed_products) = solve(Precision::Mixed);
            let (double, double_slopes, double_products) = solve(Precision::Double);
            let normal = relative_difference(&mixed.normal, &double.normal);
            let slopes = relative_difference(&mixed_slopes, &double_slopes);
            println!("{label}: normal {normal:.1e}, subgradient {slopes:.1e}, {mixed_products} {double_products}");
            assert!(normal < 1e-10, "{label}: normal {normal:.1e}");
            assert!(slopes < 1e-8, "{label}: subgradient {slopes:.1e}");
            assert_eq!(mixed.status, double.status, "{label}");
            // Residual replacement is all that the single precision costs.
            assert!(mixed_products <= double_products + double_products / 2, "{mixed_products} {double_products}");
        }
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (shape, state) = solve(hertz().unwrap(), SolverKind::Newton, 6, 2);
            let dual = Vector::from_fn(shape.problem().boundary.row_count, |i, _| (0.7 * i as f64).cos());
            let control = bent(&shape.problem().scene);
            let slope = shape.coderivative(&control, &state, &dual).unwrap();
            (state.forces.normal.clone(), slope)
        })
    };
    let reference = run(1);
    for threads in [2, 4] {
        assert_eq!(run(threads), reference, "{threads} threads");
    }
}

#[test]
fn warm_start_ends_at_the_same_state() {
    for (scene, kind) in [
        (signorini().unwrap(), SolverKind::Newton),
        (hertz().unwrap(), SolverKind::Newton),
        (hertz().unwrap(), SolverKind::Direct),
    ] {
        let (shape, old) = solve(scene, kind, 6, 2);
        let control = bent(&shape.problem().scene).map(|height| height * 0.9995);
        let cold = shape.solve(&control, None, Accuracy::TIGHTEST).unwrap();
        let warm = shape.solve(&control, Some(&shape.warm_start(&old)), Accuracy::TIGHTEST).unwrap();
        assert_same(&cold, &warm, "warm start");
        assert!(warm.work().newton_steps <= cold.work().newton_steps, "{:?} {:?}", warm.work(), cold.work());
    }
}

/// Supports leave a motion free that frictionless contact does not feel and no load drives: no force depends on it, and
/// the rounding of its jumps must not be taken for a motion.
#[test]
fn a_motion_without_jumps_changes_no_force() {
    let mut scene = signorini().unwrap().with_friction(0.0);
    scene.bodies[0].supports = vec![Support::new(BlockFace::Bottom, [true, false, true])];
    scene.bodies[0].loads = vec![Load::traction(BlockFace::X2Max, [0.0, 0.0, 3000.0])];
    change_counter_surface(&mut scene, |_| CounterSurface::Sphere { apex: 100.1, radius: 1e4, centre: [0.0; 2] });
    let (_, torn) = solve(scene.clone(), SolverKind::Newton, 4, 2);
    let (_, direct) = solve(scene, SolverKind::Direct, 4, 2);
    assert!(torn.forces.total_normal_force() > 0.0);
    assert_same(&torn, &direct, "free along x2");
}
