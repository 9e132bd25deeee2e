//! Hybrid total FETI: clusters with six rigid motions each find the states and derivatives of single subdomains.

use crate::common::{start_height, unit};
use contact::equilibrium::{ContactProblem, TangentsOf};
use contact::error::ContactError;
use contact::linear::vector::norm;
use contact::scene::{Scene, hertz, signorini};
use contact::solvers::{Processes, SolverKind, SolverPlan};
use contact::tfeti::{DualMethod, Recycling, TornOptions, TotalFeti};
use std::sync::Arc;
use testset::kit::wavy;

const NEWTON: DualMethod = DualMethod::Newton(Recycling::On);

fn solver(scene: &Scene, clusters: Option<usize>, method: DualMethod) -> TotalFeti {
    let problem = Arc::new(ContactProblem::new(scene.clone()).unwrap());
    TotalFeti::new(problem, TornOptions { clusters, ..TornOptions::default() }).unwrap().with_method(method)
}

/// The relative difference |found − expected|/|expected|.
fn error(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let difference: Vec<f64> = found.iter().zip(expected).map(|(found, expected)| found - expected).collect();
    norm(&difference) / norm(expected)
}

/// Forces, displacements, sensitivities and tangents of a scene at bent controls.
fn results(scene: &Scene, clusters: Option<usize>, method: DualMethod) -> Vec<(&'static str, Vec<f64>)> {
    let solver = solver(scene, clusters, method);
    let problem = solver.problem();
    let state = solver.solve(&wavy(start_height(scene), 36), None, 1e-11).unwrap();
    let (forces, solution) = (state.forces, state.solution);
    let dual: Vec<f64> = (0..problem.boundary.row_count).map(|row| (0.3 * row as f64).sin()).collect();
    let changes: Vec<Vec<f64>> = [0, 17, 35].map(|control| unit(36, control)).into();
    let bodies = solver.bodies(&solution).unwrap();
    let positions = solver.sensitivities(&solution, &dual, 1e-11).unwrap().positions;
    let tangents = solver.tangents(&solution, &changes, TangentsOf::Contact, 1e-10).unwrap();
    vec![
        ("normal forces", forces.normal),
        ("tangential forces", forces.tangential.as_flattened().to_vec()),
        ("displacements", bodies.iter().flat_map(|body| body.displacement.as_flattened().to_vec()).collect()),
        ("energy", bodies.iter().zip(&*problem.bodies).map(|(solved, body)| solved.strain_energy(body)).collect()),
        ("sensitivities", positions.concat()),
        ("tangents", tangents.forces.concat()),
    ]
}

#[test]
fn clusters_find_the_state_of_single_subdomains() {
    let cases = [
        (signorini(), [8; 3], [4; 3], 8, NEWTON),
        (hertz(), [12; 3], [4; 3], 16, NEWTON),
        (hertz(), [6; 3], [2; 3], 2, NEWTON),
        (signorini(), [8; 3], [4, 2, 2], 8, DualMethod::Newton(Recycling::Off)),
        (hertz(), [6; 3], [3, 2, 1], 4, NEWTON),
        (signorini(), [6; 3], [2; 3], 2, DualMethod::SuccessiveApproximations),
    ];
    for (scene, bricks, subdomains, clusters, method) in cases {
        let scene = scene.unwrap().with_bricks(bricks, subdomains);
        let plain = results(&scene, None, method);
        for ((what, found), (_, expected)) in results(&scene, Some(clusters), method).iter().zip(&plain) {
            let error = error(found, expected);
            println!("{} {subdomains:?} {clusters}: {what} {error:.1e}", scene.name);
            // States are solved to 1e-11 and derivatives to 1e-10, relative to residuals.
            assert!(error < 1e-8, "{} {subdomains:?} {clusters}: {what} {error:.1e}", scene.name);
        }
    }
}

#[test]
fn clusters_take_rows_out_of_the_dual_problem_and_cost_few_products() {
    let scene = signorini().unwrap().with_bricks([12; 3], [4; 3]);
    let cost = |clusters| {
        let solver = solver(&scene, clusters, NEWTON);
        let state = solver.solve(&[start_height(&scene); 36], None, 1e-8).unwrap();
        (solver.sizes(), state.work().dual_operator_applications)
    };
    let ([dofs, rows], products) = cost(None);
    let ([same_dofs, fewer_rows], more_products) = cost(Some(8));
    assert_eq!(dofs, same_dofs);
    assert!(fewer_rows < rows, "{fewer_rows} rows of B of {rows}");
    // 8 coarse motions in place of 64 cost products, but not many times as many.
    assert!((products..2 * products).contains(&more_products), "{products}, {more_products}");
}

#[test]
fn clusters_that_do_not_fit_are_refused() {
    let scene = |bricks: usize| signorini().unwrap().with_bricks([bricks; 3], [4; 3]);
    for clusters in [0, 65] {
        let plan = SolverPlan { clusters: Some(clusters), ..SolverPlan::new(scene(8), SolverKind::Newton) };
        let refusal = Processes::alone().solver(plan).unwrap_err().to_string();
        assert!(refusal.contains("solver.clusters") && refusal.contains("1 … 64"), "{clusters}: {refusal}");
    }
    // Bricks as subdomains: the inner ones of a cluster have a single node that no other cluster touches.
    let problem = Arc::new(ContactProblem::new(scene(4)).unwrap());
    match TotalFeti::new(problem, TornOptions { clusters: Some(8), ..TornOptions::default() }).unwrap_err() {
        ContactError::Clusters { count: 8, reason } => assert!(reason.contains("do not hold"), "{reason}"),
        error => panic!("{error}"),
    }
}
