//! Reference cases of an independent implementation (direct condensation and Newton in another language): Θ within
//! 1e-10, the subgradient within 1e-9, for both contact solvers.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureCost, PressureMeasure};
use contact::scene::{Scene, hertz, signorini};
use nonsmooth::{Accuracy, CompositeObjective, StateSolver, Vector};
use serde_json::Value;
use testset::kit::numbers;

struct Outcome {
    objective: f64,
    subgradient: Vector,
    counts: [u64; 3],
    total: f64,
}

fn evaluate(scene: Scene, case: &Value, kind: SolverKind, subdomains: usize) -> Outcome {
    let bricks = case["mesh"].as_u64().unwrap() as usize;
    let scene = scene.with_bricks([bricks; 3], [subdomains; 3]).with_friction(case["friction"].as_f64().unwrap());
    let shape = ContactShape::new(scene, kind).unwrap();
    let measure = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes };
    let cost = PressureCost::new(measure, shape.problem()).unwrap();
    let objective = CompositeObjective::new(shape, cost);
    let controls = Vector::from_vec(numbers(&case["controls"]));
    let state = objective.solver().solve(&controls, None, Accuracy::TIGHTEST).unwrap();
    let evaluation = objective.differentiate(&controls, &state).unwrap();
    let counts = state.forces.counts();
    Outcome {
        objective: evaluation.value,
        subgradient: evaluation.subgradient,
        counts: [counts.open as u64, counts.stick as u64, counts.slip as u64],
        total: state.forces.total_normal_force(),
    }
}

fn relative(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected.abs()
}

fn check(scene: &Scene, case: &Value, kind: SolverKind) {
    let outcome = evaluate(scene.clone(), case, kind, 2);
    let label = format!("{} mesh {} friction {} {kind:?}", scene.name, case["mesh"], case["friction"]);
    let objective = relative(outcome.objective, case["objective"].as_f64().unwrap());
    assert!(objective < 1e-10, "{label}: objective off by {objective:.1e}");
    let total = relative(outcome.total, case["total_normal_force"].as_f64().unwrap());
    assert!(total < 1e-8, "{label}: total force off by {total:.1e}");
    let status = ["open", "stick", "slip"].map(|name| case["status"][name].as_u64().unwrap());
    assert_eq!(outcome.counts, status, "{label}");
    let (slope_error, allowed) = if case["subgradient"].is_array() {
        let expected = Vector::from_vec(numbers(&case["subgradient"]));
        ((&outcome.subgradient - &expected).norm() / expected.norm(), 1e-9)
    } else {
        let direction = Vector::from_vec(numbers(&case["direction"]));
        let product = outcome.subgradient.dot(&direction);
        // The reference's own difference quotient carries six digits or so.
        (relative(product, case["directional_derivative"].as_f64().unwrap()), 1e-6)
    };
    println!("{label}: objective {objective:.1e}, subgradient {slope_error:.1e}");
    assert!(slope_error < allowed, "{label}: subgradient off by {slope_error:.1e}");
}

fn cases(text: &str) -> Vec<Value> {
    serde_json::from_str(text).unwrap()
}

#[test]
fn signorini_by_total_feti() {
    for case in cases(include_str!("../data/signorini_cases.json")) {
        check(&signorini().unwrap(), &case, SolverKind::Newton);
    }
}

#[test]
fn signorini_by_direct_condensation() {
    for case in cases(include_str!("../data/signorini_cases.json")) {
        check(&signorini().unwrap(), &case, SolverKind::Direct);
    }
}

#[test]
fn hertz_by_total_feti() {
    for case in cases(include_str!("../data/hertz_cases.json")) {
        check(&hertz().unwrap(), &case, SolverKind::Newton);
    }
}

#[test]
fn hertz_by_direct_condensation() {
    for case in cases(include_str!("../data/hertz_cases.json")) {
        check(&hertz().unwrap(), &case, SolverKind::Direct);
    }
}
