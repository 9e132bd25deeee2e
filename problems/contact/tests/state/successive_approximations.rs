//! The paper's path against the Newton path on small scenes: states, subgradients, step counts, limits.

use crate::common::start_height;
use contact::body::mesh::BlockFace;
use contact::contact_shape::SolverKind;
use contact::equilibrium::{ContactForces, ContactProblem, ContactState, ContactWarmStart, Work};
use contact::error::ContactError;
use contact::qp::QpError;
use contact::scene::{Scene, hertz, signorini};
use contact::tfeti::{
    AugmentedLagrangianCounts, AugmentedLagrangianSettings, PreconditionerKind, TornOptions, TornState, TotalFeti,
    solve_by_successive_approximations,
};
use std::sync::Arc;

fn small(scene: Scene, bricks: usize, subdomains: usize, friction: f64) -> Arc<ContactProblem> {
    let scene = scene.with_bricks([bricks; 3], [subdomains; 3]).with_friction(friction);
    Arc::new(ContactProblem::new(scene).expect("valid scene"))
}

/// A gently wavy surface around the start height.
fn controls(problem: &ContactProblem) -> Vec<f64> {
    let height = start_height(&problem.scene);
    (0..36).map(|index| height * (1.0 + 2e-3 * (2.3 * index as f64).sin())).collect()
}

fn torn(problem: &Arc<ContactProblem>, preconditioner: PreconditionerKind) -> TotalFeti {
    let options = TornOptions { preconditioner, ..TornOptions::default() };
    TotalFeti::new(Arc::clone(problem), options).expect("torn")
}

struct Paper {
    state: TornState,
    forces: ContactForces,
    work: Work,
    counts: AugmentedLagrangianCounts,
}

fn paper(
    solver: &TotalFeti,
    start: Option<&[f64]>,
    settings: &AugmentedLagrangianSettings,
) -> Result<Paper, ContactError> {
    let controls = controls(solver.problem());
    let (state, counts) =
        solver.solve_by(SolverKind::AugmentedLagrangian, &controls, settings.tolerance, |contact| {
            solve_by_successive_approximations(contact, start, settings)
        })?;
    let (forces, work) = (state.forces.clone(), state.work());
    Ok(Paper { state: state.solution, forces, work, counts })
}

/// Largest difference of the normal and tangential forces over the largest normal force.
fn difference(a: &ContactForces, b: &ContactForces) -> f64 {
    let largest = b.normal.iter().fold(0.0_f64, |largest, force| largest.max(force.abs()));
    let normal = a.normal.iter().zip(&b.normal).map(|(a, b)| (a - b).abs());
    let tangential = a.tangential.iter().flatten().zip(b.tangential.iter().flatten()).map(|(a, b)| (a - b).abs());
    normal.chain(tangential).fold(0.0, f64::max) / largest
}

/// Solves by both paths to 1e-9 and compares forces, statuses and subgradients.
fn agrees(problem: &Arc<ContactProblem>, kind: PreconditionerKind, precondition: bool) -> Paper {
    let solver = torn(problem, kind);
    let ContactState { solution: newton_state, forces: newton, .. } =
        solver.solve(&controls(problem), None, 1e-11).expect("Newton");
    let settings = AugmentedLagrangianSettings { precondition, ..AugmentedLagrangianSettings::to(1e-9) };
    let paper = paper(&solver, None, &settings).expect("successive approximations");
    // The largest error of a force is 5 to 70 times the residual.
    assert!(difference(&paper.forces, &newton) < 1e-6, "{:.1e}", difference(&paper.forces, &newton));
    assert_eq!(paper.forces.status, newton.status);
    assert!(paper.forces.residuals.newton <= 1e-9 && paper.forces.residuals.equilibrium < 1e-9);
    assert_eq!(paper.work.newton_steps, paper.counts.fixed_point_steps);
    let direction: Vec<f64> = (0..problem.boundary.row_count).map(|row| (0.7 * row as f64).cos()).collect();
    let derivative = |state| solver.sensitivities(state, &direction, 1e-10).expect("adjoint").positions.concat();
    let (ours, theirs) = (derivative(&paper.state), derivative(&newton_state));
    let size = theirs.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    assert!(ours.iter().zip(&theirs).all(|(a, b)| (a - b).abs() < 1e-5 * size));
    paper
}

#[test]
fn signorini_with_and_without_friction() {
    let scene = || signorini().expect("preset");
    let coulomb = agrees(&small(scene(), 6, 2, 0.3), PreconditionerKind::Dirichlet, true);
    assert!((0.02..0.2).contains(&coulomb.counts.contraction), "{}", coulomb.counts.contraction);
    assert!(coulomb.work.dual_operator_applications <= 130, "{}", coulomb.work.dual_operator_applications);
    let frictionless = agrees(&small(scene(), 6, 2, 0.0), PreconditionerKind::Dirichlet, true);
    assert_eq!((frictionless.counts.fixed_point_steps, frictionless.counts.contraction), (1, 0.0));
    agrees(&small(scene(), 4, 1, 0.3), PreconditionerKind::Lumped, true);
    agrees(&small(scene(), 4, 2, 0.3), PreconditionerKind::None, false);
}

#[test]
fn two_bodies() {
    let scene = || hertz().expect("preset");
    agrees(&small(scene(), 4, 2, 0.3), PreconditionerKind::Dirichlet, true);
    agrees(&small(scene(), 4, 1, 0.0), PreconditionerKind::Lumped, true);
}

#[test]
fn grounded_motion_common_to_both_bodies() {
    // Nothing holds the translation of both bodies along x₂: contact sees only their difference.
    let mut scene = hertz().expect("preset");
    for body in &mut scene.bodies {
        body.supports.retain(|support| support.face != BlockFace::X2Min.name());
    }
    let solved = agrees(&small(scene, 4, 2, 0.3), PreconditionerKind::Dirichlet, true);
    assert!(solved.forces.counts().stick + solved.forces.counts().slip > 0);
}

#[test]
fn warm_start_needs_fewer_products() {
    let problem = small(signorini().expect("preset"), 6, 2, 0.3);
    let solver = torn(&problem, PreconditionerKind::Dirichlet);
    let settings = AugmentedLagrangianSettings::to(1e-7);
    let cold = paper(&solver, None, &settings).expect("cold");
    let ContactWarmStart::Multipliers(multipliers) = cold.state.warm_start() else { panic!("multipliers") };
    let warm = paper(&solver, Some(&multipliers), &settings).expect("warm");
    let (cold_work, warm_work) = (cold.work.dual_operator_applications, warm.work.dual_operator_applications);
    assert!(3 * warm_work < 2 * cold_work, "{warm_work} against {cold_work}");
    assert!(difference(&warm.forces, &cold.forces) < 1e-4);
}

#[test]
fn products_are_those_counted() {
    let problem = small(signorini().expect("preset"), 4, 2, 0.3);
    let solver = torn(&problem, PreconditionerKind::Dirichlet);
    let settings = AugmentedLagrangianSettings::to(1e-6);
    let Paper { work, counts, .. } = paper(&solver, None, &settings).expect("solved");
    let steps = counts.steps.products();
    // Beside the steps: λ₀, five Lanczos steps, the bonded start (about four), the final balanced multipliers.
    let rest = work.dual_operator_applications - steps;
    assert!((8..=14).contains(&rest), "{rest}");
}

#[test]
fn large_friction_still_contracts_on_this_scene() {
    let problem = small(signorini().expect("preset"), 4, 2, 3.0);
    agrees(&problem, PreconditionerKind::Dirichlet, true);
}

#[test]
fn limits_end_in_typed_errors() {
    let problem = small(signorini().expect("preset"), 4, 2, 0.3);
    let solver = torn(&problem, PreconditionerKind::Dirichlet);
    let defaults = AugmentedLagrangianSettings::to(1e-9);
    let fail = |settings| paper(&solver, None, &settings).map(|_| ()).expect_err("must fail");
    match fail(AugmentedLagrangianSettings { max_fixed_point_steps: 2, ..defaults }) {
        ContactError::NotConverged { solver: "successive approximations", history, .. } => assert_eq!(history.len(), 2),
        other => panic!("{other}"),
    }
    let mut limited = defaults;
    limited.qp.products = 10;
    assert!(matches!(fail(limited), ContactError::DualProblem(QpError::NotConverged { solver: "MPGP", .. })));
}
