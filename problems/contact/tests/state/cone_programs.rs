//! The last resort of direct condensation, driven alone: cone programs lead to the states that Newton's method finds.

use contact::direct::DirectSolver;
use contact::equilibrium::{ContactProblem, ContactSolver};
use contact::scene::{Scene, hertz, signorini};
use std::sync::Arc;
use testset::kit::wavy;

/// Steps that no scene of these tests needs.
const MANY_STEPS: usize = 10_000;

fn problem(scene: Scene, mesh: usize, friction: f64) -> Arc<ContactProblem> {
    Arc::new(ContactProblem::new(Scene { mesh: [mesh; 3], subdomains: [1; 3], friction, ..scene }).unwrap())
}

/// Σσ⁴ over the contact nodes.
fn objective(problem: &ContactProblem, normal: impl Iterator<Item = f64>) -> f64 {
    problem.boundary.points.iter().zip(normal).map(|(point, force)| (force.max(0.0) / point.area).powi(4)).sum()
}

#[test]
fn cone_programs_lead_to_the_states_of_newtons_method() {
    for (scene, name) in [(signorini().unwrap(), "signorini"), (hertz().unwrap(), "hertz")] {
        for friction in [0.0, 0.3, 1.0] {
            let problem = problem(scene.clone(), 5, friction);
            let controls = wavy(problem.scene.start_height, 36);
            let solver = DirectSolver::new(Arc::clone(&problem)).unwrap();
            let state = solver.solve(&controls, None, 0.0).unwrap();
            let mut contact = solver.contact(&controls).unwrap();
            let found = contact.by_cone_programs(0.0, MANY_STEPS);
            let (forces, _) = contact.dimensional(found.unknowns.as_ref().unwrap());
            let expected = objective(&problem, state.forces.normal.iter().copied());
            let normal = problem.boundary.points.iter().map(|point| forces[point.start]);
            let difference = (objective(&problem, normal) / expected - 1.0).abs();
            println!(
                "{name}, friction {friction}: {} programs, {} steps, {difference:.1e}",
                found.count,
                found.steps()
            );
            assert!(difference < 1e-7, "{name}, friction {friction}: {difference:.1e}");
            // Each program takes some iterations, and Newton's method some steps from the last one.
            assert!(found.count >= 1 && found.steps() > 5 * found.count, "{} {}", found.count, found.steps());
        }
    }
}

/// Without a step nothing is tried, and the problem is left as it was.
#[test]
fn cone_programs_keep_within_their_work() {
    let problem = problem(signorini().unwrap(), 4, 0.3);
    let mut contact = DirectSolver::new(problem).unwrap().contact(&[100.0; 36]).unwrap();
    let before = contact.constant().to_vec();
    for steps in [0, 3] {
        let found = contact.by_cone_programs(0.0, steps);
        assert!(found.unknowns.is_none() && found.steps() <= steps, "{}", found.steps());
        assert_eq!(contact.constant(), before);
    }
}
