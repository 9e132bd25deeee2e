//! The error that a state reports bounds the true error of Θ, over random scenes, solvers and tolerances.

use contact::contact_shape::{AnySolver, ContactShape};
use contact::cost::{PressureCost, PressureMeasure};
use contact::direct::DirectSolver;
use contact::equilibrium::{ContactProblem, ContactSolver, ValueError};
use contact::scene::{Scene, hertz, signorini};
use contact::tfeti::{DualMethod, PreconditionerKind, Recycling, TotalFeti};
use nonsmooth::{Accuracy, Cost, ReducedObjective, StateSolver, Vector};
use proptest::prelude::*;
use std::sync::Arc;

type Objective = ReducedObjective<ContactShape, PressureCost>;

/// A solver of total FETI, or direct condensation.
type Solver = Option<(PreconditionerKind, DualMethod)>;

fn objective(scene: &Scene, solver: Solver) -> Objective {
    let problem = Arc::new(ContactProblem::new(scene.clone()).unwrap());
    let solver = match solver {
        Some((preconditioner, method)) => AnySolver::from(TotalFeti::new(problem, preconditioner, method).unwrap()),
        None => AnySolver::from(DirectSolver::new(problem).unwrap()),
    };
    let cost = PressureCost::new(PressureMeasure::Norm { exponent: 4.0 }, &solver.problem().boundary).unwrap();
    ReducedObjective::new(ContactShape::by(solver), cost)
}

fn value(objective: &Objective, control: &Vector, accuracy: Accuracy) -> (f64, ValueError) {
    let state = objective.solver().solve(control, None, accuracy).unwrap();
    let gradient = objective.cost().gradient(control, &state);
    let error = objective.solver().pull_back(control, &state, &gradient.state).unwrap().1;
    // What the optimizer is told is the same bound.
    assert_eq!(objective.differentiate(control, &state).unwrap().error_bound, error.bound);
    (objective.cost().value(control, &state), error)
}

fn check(scene: &Scene, control: &Vector) -> Result<(), TestCaseError> {
    let exact = value(&objective(scene, None), control, Accuracy::TIGHTEST).0;
    for solver in [
        Some((PreconditionerKind::Dirichlet, DualMethod::Newton(Recycling::On))),
        Some((PreconditionerKind::None, DualMethod::Newton(Recycling::On))),
        Some((PreconditionerKind::Lumped, DualMethod::Newton(Recycling::Off))),
        Some((PreconditionerKind::Dirichlet, DualMethod::SuccessiveApproximations)),
        None,
    ] {
        let objective = objective(scene, solver);
        for tolerance in [1e-2, 1e-4, 1e-7, 1e-10] {
            let (found, error) = value(&objective, control, Accuracy::relative(tolerance).unwrap());
            let truth = (found - exact).abs();
            // Rounding of the reference.
            let rounding = 1e-13 * exact;
            prop_assert!(
                truth <= error.bound + rounding,
                "{solver:?} {tolerance:.0e}: error {truth:.3e}, bound {:.3e}",
                error.bound
            );
            // The first order term predicts the error, up to what the bound allows for.
            let rest = (found - error.first_order - exact).abs();
            prop_assert!(rest <= error.bound + rounding, "{rest:.3e} {:.3e}", error.bound);
        }
    }
    Ok(())
}

fn shape(seed: u64, level: f64, size: f64) -> Vector {
    nonsmooth::verify::seeded_direction(36, seed).map(|entry| level + size * entry)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    #[test]
    fn one_body(seed in 0_u64..1_000_000, friction in prop_oneof![Just(0.0), 0.05..0.7], load in 0.3_f64..2.0) {
        let mut scene = Scene { mesh: [4; 3], friction, ..signorini().unwrap() };
        scene.lower.loads[0].traction[2] *= load;
        check(&scene, &shape(seed, 98.0, 1.0))?;
    }

    #[test]
    fn two_bodies(seed in 0_u64..1_000_000, friction in prop_oneof![Just(0.0), 0.05..0.6]) {
        check(&Scene { mesh: [4; 3], friction, ..hertz().unwrap() }, &shape(seed, 9.7, 0.1))?;
    }
}

#[test]
fn successive_approximations_meet_loose_tolerances_after_balancing() {
    // Scenes whose balanced multipliers once missed the tolerance that the dual problem had met.
    let scene = Scene { mesh: [4; 3], friction: 0.454_064_788_045_924_9, ..hertz().unwrap() };
    check(&scene, &shape(711_030, 9.7, 0.1)).unwrap();
    let mut scene = Scene { mesh: [4; 3], friction: 0.337_002_695_297_198_3, ..signorini().unwrap() };
    scene.lower.loads[0].traction[2] *= 1.569_833_001_404_742_1;
    check(&scene, &shape(414_454, 98.0, 1.0)).unwrap();
}
