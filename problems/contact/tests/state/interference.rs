//! Interference of the bodies before loading.

use crate::common::{bent, change_counter_surface};
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureCost, PressureMeasure};
use contact::equilibrium::ContactProblem;
use contact::scene::{Scene, Support, hertz, signorini};
use nonsmooth::verify::{Direction, seeded_direction, taylor_test};
use nonsmooth::{Accuracy, CompositeObjective, StateSolver};

const KINDS: [SolverKind; 2] = [SolverKind::Newton, SolverKind::Direct];

/// Bodies that nothing but their interference presses.
fn pressed(mut scene: Scene, interference: f64) -> Scene {
    scene = scene.with_bricks([4; 3], [2; 3]);
    scene.bodies[0].loads.clear();
    scene.bodies[0].supports.push(Support::new("bottom", [false, false, true]));
    if let Some(upper) = scene.bodies.get_mut(1) {
        upper.loads.clear();
        upper.supports.push(Support::new("top", [false, false, true]));
    }
    scene.contacts[0].interference = interference;
    scene
}

/// Along x₃, interference is a counter surface that stands lower.
#[test]
fn interference_along_x3_is_a_counter_surface_moved_down() {
    let scene = signorini().unwrap();
    for kind in KINDS {
        let with = pressed(scene.clone(), 1.5);
        let mut without = pressed(scene.clone(), 0.0);
        change_counter_surface(&mut without, |surface| surface.moved([0.0, 0.0, -1.5]));
        let [with, without] = [with, without].map(|scene| {
            let shape = ContactShape::new(scene.clone(), kind).unwrap();
            assert!(shape.problem().start_rows().nodes.iter().any(|node| node.gap < 0.0));
            shape.solve(&bent(&scene), None, Accuracy::TIGHTEST).unwrap()
        });
        assert!(with.forces.total_normal_force() > 0.0);
        for (a, b) in with.forces.normal.iter().zip(&without.forces.normal) {
            assert!((a - b).abs() < 1e-9 * with.forces.total_normal_force(), "{kind:?}: {a} {b}");
        }
        for (a, b) in with.rows.gaps().zip(without.rows.gaps()) {
            assert!((a - b).abs() < 1e-12, "{kind:?}: {a} {b}");
        }
    }
}

#[test]
fn states_with_interference_have_the_derivatives_of_differences() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        let interference = if scene.bodies.len() > 1 { 0.1 } else { 3.0 };
        for kind in KINDS {
            let scene = pressed(scene.clone(), interference);
            let at = bent(&scene);
            let shape = ContactShape::new(scene, kind).unwrap();
            let norm = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes };
            let cost = PressureCost::new(norm, shape.problem()).unwrap();
            let objective = CompositeObjective::new(shape, cost);
            let steps: Vec<f64> = (0..8).map(|k| 1e-3 * 10.0_f64.powf(-0.5 * f64::from(k))).collect();
            let direction = Direction::Given(seeded_direction(at.len(), 4));
            let test = taylor_test(&objective, &at, &direction, &steps).unwrap();
            assert!(test.best_derivative_error < 1e-6, "{kind:?}: {test}");
        }
    }
}

#[test]
fn interference_that_is_no_number_is_refused() {
    let error = ContactProblem::new(pressed(signorini().unwrap(), f64::INFINITY)).unwrap_err().to_string();
    assert!(error.starts_with("contact[0].interference = inf"), "{error}");
}
