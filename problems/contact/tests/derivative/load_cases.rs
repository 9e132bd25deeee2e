//! Several load cases of one shape: value, subgradient, Jacobian and limits over all of them.

use crate::common::{change_counter_surface, start_height};
use contact::body::mesh::BlockFace;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{Limit, LimitSide, NodeWeight, PressureMeasure, Quantity, Region};
use contact::load_cases::{LoadCase, Over};
use contact::scene::{Load, Scene, hertz};
use contact::solvers::{Processes, SolverPlan};
use nonsmooth::composite::LinearizationRequest;
use nonsmooth::verify::{Direction, seeded_direction, taylor_test};
use nonsmooth::{Accuracy, ConstraintEvaluation, NonsmoothObjective, OutputJacobian, Request, StateSolver, Vector};

/// Three loadings of the pressed and pulled block: the pull, the friction, the place of the sphere.
fn scenes() -> [(&'static str, Scene); 3] {
    let scene = |pull: f64, friction, moved| {
        let mut scene = hertz().unwrap().with_bricks([4; 3], [2; 3]).with_friction(friction);
        change_counter_surface(&mut scene, |surface| surface.moved([moved, 0.0, 0.0]));
        scene.bodies[1].loads[1] = Load::traction(BlockFace::X1Max.name(), [pull, 0.0, -2000.0]);
        scene
    };
    [("left", scene(-500.0, 0.3, -0.5)), ("still", scene(0.0, 0.0, 0.0)), ("right", scene(500.0, 0.3, 0.5))]
}

fn norm() -> Quantity {
    Quantity::Pressure(PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes })
}

/// The objective over some cases, by solvers of one run.
fn objective(
    scenes: &[(&str, Scene)],
    kind: SolverKind,
    measure: &Quantity,
    over: Over,
    limits: &[Limit],
) -> ContactObjective {
    let processes = Processes::alone();
    let case = |(index, (name, scene)): (usize, &(&str, Scene))| LoadCase {
        name: (*name).to_owned(),
        weight: [1.0, 1.5, 0.9][index % 3],
        shape: ContactShape::by(processes.solver(SolverPlan::new(scene.clone(), kind)).unwrap()),
        quantity: measure.clone(),
    };
    ContactObjective::of_cases(scenes.iter().enumerate().map(case).collect(), over, limits, &[]).unwrap()
}

fn shape(objective: &ContactObjective, seed: u64) -> Vector {
    let height = start_height(&objective.solver().problem().scene);
    seeded_direction(36, seed).map(|entry| height * (0.98 + 0.01 * entry))
}

fn steps() -> Vec<f64> {
    (0..8).map(|k| 1e-3 * 10.0_f64.powf(-0.5 * f64::from(k))).collect()
}

#[test]
fn the_value_is_the_worst_or_the_sum_of_the_single_cases() {
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let single = scenes().map(|(name, scene)| {
            let alone = objective(&[(name, scene)], kind, &norm(), Over::Worst, &[]);
            let at = shape(&alone, 3);
            alone.evaluate(&Request::tight(&at)).unwrap().into_evaluation().value
        });
        let weighted: Vec<f64> = single.iter().zip([1.0, 1.5, 0.9]).map(|(value, weight)| value * weight).collect();
        for (over, expected) in
            [(Over::Worst, weighted.iter().copied().fold(0.0, f64::max)), (Over::Sum, weighted.iter().sum::<f64>())]
        {
            let all = objective(&scenes(), kind, &norm(), over, &[]);
            let value = all.evaluate(&Request::tight(&shape(&all, 3))).unwrap().into_evaluation().value;
            assert!((value / expected - 1.0).abs() < 1e-10, "{kind:?} {over:?}: {value} {expected}");
        }
    }
}

/// The lower body is the same in all cases; the upper one begins at the moved sphere.
#[test]
fn bodies_of_equal_stiffness_are_factored_once_for_all_cases() {
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let [left, _, right] = scenes();
        let objective = objective(&[left, right], kind, &norm(), Over::Worst, &[]);
        let states = objective.cases().solve(&shape(&objective, 3), None, Accuracy::TIGHTEST).unwrap();
        let [first, second] = [0, 1].map(|case| states[case].work().factorizations);
        assert_eq!(first, 2 * second, "{kind:?}");
    }
}

#[test]
fn equal_cases_are_worth_a_single_one() {
    let [_, _, (name, scene)] = scenes();
    let alone = objective(&[(name, scene.clone())], SolverKind::Direct, &norm(), Over::Worst, &[]);
    let at = shape(&alone, 5);
    let value = alone.evaluate(&Request::tight(&at)).unwrap().into_evaluation().value;
    let cases = [("a", scene.clone()), ("b", scene)];
    let both = objective(&cases, SolverKind::Direct, &norm(), Over::Worst, &[]);
    let worst = both.evaluate(&Request::tight(&at)).unwrap().into_evaluation().value;
    // The second case has the weight 1.5.
    assert!((worst / (1.5 * value) - 1.0).abs() < 1e-12);
}

#[test]
fn the_subgradient_over_cases_is_that_of_differences() {
    let field = Quantity::Compliance;
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        for (measure, over) in [(norm(), Over::Worst), (norm(), Over::Sum), (field.clone(), Over::Sum)] {
            let objective = objective(&scenes(), kind, &measure, over, &[]);
            let direction = Direction::Given(seeded_direction(36, 4));
            let test = taylor_test(&objective, &shape(&objective, 3), &direction, &steps()).unwrap();
            assert!(test.best_derivative_error < 1e-6, "{kind:?} {over:?} {measure:?}: {test}");
        }
    }
}

#[test]
fn the_stacked_jacobian_has_the_rows_that_adjoints_give() {
    for (measure, kind) in [
        (norm(), SolverKind::Newton),
        (norm(), SolverKind::Direct),
        (Quantity::Compliance, SolverKind::Direct),
        (Quantity::Volume, SolverKind::Direct),
    ] {
        let limit = Limit::new(Quantity::Pressure(PressureMeasure::Peak), LimitSide::AtMost, 5000.0);
        let objective = objective(&scenes(), kind, &measure, Over::Worst, &[limit]);
        let (cases, at) = (objective.cases(), shape(&objective, 7));
        let states = cases.solve(&at, None, Accuracy::TIGHTEST).unwrap();
        let known = cases.linearize(&at, &states, Accuracy::relative(1e-9).unwrap()).unwrap();
        assert_eq!(known.outputs, cases.outputs(&states));
        let weights = seeded_direction(known.outputs.len(), 11);
        let dual = cases.output_dual(&at, &states, &weights);
        let pulled =
            dual.control + nonsmooth::Coderivative::coderivative(cases, &at, &states, &dual.state).unwrap().element;
        let product = known.jacobian.tr_mul(&weights);
        assert!((&pulled - &product).norm() < 1e-7 * product.norm(), "{measure:?} {kind:?}");
        // With two active cases, the model of the worst needs the curvature of both.
        let parts = nonsmooth::composite::OuterFunction::parts(objective.cost(), &known.outputs);
        assert_eq!(parts.len(), if measure == Quantity::Volume { 0 } else { 3 });
    }
}

#[test]
fn the_bending_is_added_with_its_derivatives() {
    let weight = 1e10;
    let fair = |(name, scene): (&'static str, Scene)| (name, scene.with_shapes(|heights| heights.fairness = weight));
    for over in [Over::Worst, Over::Sum] {
        let plain = objective(&scenes(), SolverKind::Direct, &norm(), over, &[]);
        let bent = objective(&scenes().map(fair), SolverKind::Direct, &norm(), over, &[]);
        let at = shape(&plain, 3);
        let value =
            |objective: &ContactObjective| objective.evaluate(&Request::tight(&at)).unwrap().into_evaluation().value;
        let scene = &plain.solver().problem().scene;
        let energy = (contact::shape::bending_rows(scene).unwrap() * &at).norm_squared();
        let expected = value(&plain) + weight * energy;
        assert!((value(&bent) / expected - 1.0).abs() < 1e-12 && weight * energy > 1e-9 * expected);
        let direction = Direction::Given(seeded_direction(36, 4));
        let test = taylor_test(&bent, &at, &direction, &steps()).unwrap();
        assert!(test.best_derivative_error < 1e-6, "{over:?}: {test}");
        let states = bent.cases().solve(&at, None, Accuracy::TIGHTEST).unwrap();
        let known = bent.cases().linearize(&at, &states, Accuracy::relative(1e-9).unwrap()).unwrap();
        assert_eq!(known.outputs, bent.cases().outputs(&states));
        let weights = seeded_direction(known.outputs.len(), 11);
        let dual = bent.cases().output_dual(&at, &states, &weights);
        let pulled = dual.control
            + nonsmooth::Coderivative::coderivative(bent.cases(), &at, &states, &dual.state).unwrap().element;
        let product = known.jacobian.tr_mul(&weights);
        assert!((&pulled - &product).norm() < 1e-7 * product.norm(), "{over:?}");
    }
}

fn limits() -> Vec<Limit> {
    let region = Region { body: Some("lower".into()), face: Some("top".into()), ..Region::WHOLE };
    let displacement =
        |least| Quantity::Displacement { region: region.clone(), relative_to: None, axis: Some(2), least };
    let one = |quantity, side, bound, case: Option<&str>| Limit {
        case: case.map(str::to_owned),
        ..Limit::new(quantity, side, bound)
    };
    vec![
        one(Quantity::Volume, LimitSide::AtMost, 990.0, None),
        one(Quantity::Compliance, LimitSide::AtMost, 1e5, Some("right")),
        one(Quantity::Pressure(PressureMeasure::Peak), LimitSide::AtMost, 9000.0, None),
        one(Quantity::Stress { region: Region::WHOLE, without_held: true }, LimitSide::AtMost, 3000.0, None),
        one(displacement(false), LimitSide::AtMost, 0.1, Some("left")),
        one(displacement(true), LimitSide::AtLeast, -0.5, Some("left")),
        one(Quantity::LoadedArea { pressure: 2500.0 }, LimitSide::AtLeast, 60.0, Some("still")),
    ]
}

#[test]
fn limits_hold_in_all_cases_or_in_one_with_exact_derivatives() {
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let objective = objective(&scenes(), kind, &norm(), Over::Worst, &limits());
        let names: Vec<(&str, Option<&str>)> =
            objective.limits().map(|limit| (limit.quantity.name(), limit.case.as_deref())).collect();
        let [left, still, right] = [Some("left"), Some("still"), Some("right")];
        let peaks = [left, still, right].map(|case| ("peak-pressure", case));
        let stresses = [left, still, right].map(|case| ("stress", case));
        let expected = [
            &peaks[..],
            &[("volume", None), ("compliance", right)],
            &stresses,
            &[("displacement", left), ("displacement", left), ("loaded-area", still)],
        ];
        assert_eq!(names, expected.concat());
        let (direction, at) = (seeded_direction(36, 4), shape(&objective, 3));
        let constraints = |at: &Vector| -> ConstraintEvaluation {
            objective.evaluate(&Request::tight(at)).unwrap().into_evaluation().constraints.unwrap()
        };
        let derivatives = constraints(&at).jacobian * &direction;
        let mut best = vec![f64::INFINITY; names.len()];
        for step in steps() {
            let [before, after] = [-step, step].map(|step| constraints(&(&at + &direction * step)).values);
            for (index, best) in best.iter_mut().enumerate() {
                let quotient = (after[index] - before[index]) / (2.0 * step);
                *best = best.min((quotient - derivatives[index]).abs() / derivatives[index].abs());
            }
        }
        for (error, name) in best.iter().zip(&names) {
            assert!(*error < 1e-6, "{kind:?} {name:?}: {error:e}");
        }
    }
}

/// With a Jacobian at hand, the gradients come from it, and maxima have all points near the largest.
#[test]
fn a_jacobian_gives_the_gradients_of_the_limits_without_adjoints() {
    let objective = objective(&scenes(), SolverKind::Direct, &norm(), Over::Worst, &limits());
    let at = shape(&objective, 3);
    let plain = objective.evaluate(&Request::tight(&at)).unwrap().into_evaluation().constraints.unwrap();
    let accuracy = Accuracy::relative(1e-9).unwrap();
    let wanted = Some(LinearizationRequest { accuracy, below: f64::INFINITY });
    let request = Request { linearization: wanted, ..Request::tight(&at) };
    let known = objective.evaluate(&request).unwrap().into_evaluation().constraints.unwrap();
    assert_eq!(plain.values, known.values);
    for (index, (plain, known)) in plain.jacobian.row_iter().zip(known.jacobian.row_iter()).enumerate() {
        assert!((plain - known).norm() < 1e-7 * plain.norm(), "limit {index}");
    }
    assert!(known.pieces.len() > plain.pieces.len() + 10, "{}", known.pieces.len());
    for piece in &known.pieces {
        assert!(piece.value <= known.values[piece.constraint]);
    }
}

#[test]
fn a_case_without_equilibrium_fails_the_evaluation_with_its_name() {
    let [(name, scene), mut loose, _] = scenes();
    // Nothing but contact holds the upper body along x3, and it is pulled off.
    loose.1.bodies[1].loads = vec![Load::traction(BlockFace::Top.name(), [0.0, 0.0, 100.0])];
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let objective = objective(&[(name, scene.clone()), loose.clone()], kind, &norm(), Over::Worst, &[]);
        let error = objective.evaluate(&Request::tight(&shape(&objective, 3))).unwrap_err().to_string();
        assert!(error.contains("case \"still\""), "{error}");
    }
}
