//! Two blocks with different numbers of bricks, by an independent implementation: Θ and total force within 1e-8, the
//! derivative within 1e-7, for both contact solvers.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureCost, PressureMeasure};
use contact::scene::{Geometry, Scene, hertz};
use nonsmooth::{Accuracy, CompositeObjective, StateSolver, Vector};
use serde_json::Value;
use testset::kit::numbers;

/// The Hertz scene with so many bricks per edge of the lower and of the upper body.
fn scene(lower: usize, upper: usize) -> Scene {
    let mut scene = hertz().unwrap();
    for (body, bricks) in scene.bodies.iter_mut().zip([lower, upper]) {
        if let Geometry::Block(block) = &mut body.geometry {
            (block.bricks, block.subdomains) = ([bricks; 3], [2; 3]);
        }
    }
    scene
}

fn check(case: &Value, kind: SolverKind) {
    let [lower, upper] = ["lower_mesh", "upper_mesh"].map(|name| case[name].as_u64().unwrap() as usize);
    let scene = scene(lower, upper).with_friction(case["friction"].as_f64().unwrap());
    let shape = ContactShape::new(scene, kind).unwrap();
    let measure = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes };
    let cost = PressureCost::new(measure, shape.problem()).unwrap();
    let objective = CompositeObjective::new(shape, cost);
    let controls = Vector::from_vec(numbers(&case["controls"]));
    let state = objective.solver().solve(&controls, None, Accuracy::TIGHTEST).unwrap();
    let evaluation = objective.differentiate(&controls, &state).unwrap();
    let counts = state.forces.counts();
    let expected = ["open", "stick", "slip"].map(|name| case["status"][name].as_u64().unwrap() as usize);
    let direction = Vector::from_fn(controls.len(), |k, _| (k as f64 + 1.0).sin());
    let off = |found: f64, name: &str| (found / case[name].as_f64().unwrap() - 1.0).abs();
    let errors = [
        off(evaluation.value, "objective"),
        off(state.forces.total_normal_force(), "total_normal_force"),
        off(evaluation.subgradient.dot(&direction), "directional_derivative"),
    ];
    println!("{lower} on {upper}, friction {}, {kind:?}: {errors:?}", case["friction"]);
    assert_eq!([counts.open, counts.stick, counts.slip], expected, "{lower} {upper} {kind:?}");
    assert!(errors[0] < 1e-8 && errors[1] < 1e-8 && errors[2] < 1e-7, "{lower} {upper} {kind:?}: {errors:?}");
}

#[test]
fn blocks_of_different_meshes_by_both_solvers() {
    let cases: Vec<Value> = serde_json::from_str(include_str!("../data/two_bodies.json")).unwrap();
    for case in &cases {
        check(case, SolverKind::Newton);
        check(case, SolverKind::Direct);
    }
}
