//! Three bodies on top of each other, two contacts with friction: both solvers, derivatives, resultants, processes.

use crate::setting::{body, boxed, lattice, symmetric};
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureMeasure, Quantity};
use contact::scene::{BodyFace, ContactKind, ContactScene, Load, Master, Scene, Support};
use nonsmooth::{Accuracy, StateSolver, Vector};

/// A tower of three boxes of different grids; controls shape the middle and the upper one.
pub fn tower(friction: f64) -> Scene {
    let own = |count: usize, from: f64, to: f64| boxed([count, count, 2], 0.1, [0.0, 0.0, from], [8.0, 8.0, to]);
    let mut lower = body("lower", own(3, 0.0, 5.0), [1000.0, 0.3]);
    let mut middle = body("middle", own(5, 5.0, 9.0), [2000.0, 0.3]);
    let mut upper = body("upper", own(4, 9.0, 13.0), [1500.0, 0.2]);
    middle.shape = lattice([0.0, 0.0, 4.9], [8.0, 8.0, 4.2], [true; 3]);
    upper.shape = lattice([0.0, 0.0, 8.9], [8.0, 8.0, 4.2], [true; 3]);
    for body in [&mut lower, &mut middle, &mut upper] {
        body.supports = symmetric();
    }
    lower.supports.push(Support::new("bottom", [false, false, true]));
    upper.loads = vec![Load::traction("top", [0.0, 0.0, -6.0]), Load::traction("x1-max", [0.8, 0.3, 0.0])];
    let face = BodyFace::new;
    let contacts = vec![
        ContactScene::new(face(0, "top"), Master::Body(face(1, "bottom")), friction),
        ContactScene::new(face(2, "bottom"), Master::Body(face(1, "top")), friction),
    ];
    Scene { name: "tower".into(), bodies: vec![lower, middle, upper], contacts }
}

fn at(scene: &Scene) -> Vector {
    Vector::from_fn(scene.control_count(), |k, _| 0.02 * (2.0 * k as f64 + 1.0).cos())
}

#[test]
fn both_solvers_find_the_same_state_in_equilibrium() {
    let scene = tower(0.05);
    let [first, second] = [SolverKind::Direct, SolverKind::Newton].map(|kind| {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let state = shape.solve(&at(&scene), None, Accuracy::TIGHTEST).unwrap();
        let resultants = shape.resultants(&state).unwrap();
        for body in &resultants.bodies {
            let off = body.imbalance().iter().fold(0.0, |off: f64, force| off.max(force.abs()));
            assert!(off < 1e-8 * 384.0, "{kind:?} {}: {off:e}", body.body);
        }
        (shape.bodies(&state).unwrap(), state.forces.clone())
    });
    assert_eq!(first.1.status, second.1.status);
    assert!(first.1.counts().slip > 0 && first.1.counts().stick > 0, "{:?}", first.1.counts());
    for (a, b) in first.0.iter().zip(&second.0) {
        let off =
            a.displacement.iter().zip(&b.displacement).flat_map(|(a, b)| (0..3).map(move |k| (a[k] - b[k]).abs()));
        let off = off.fold(0.0, f64::max);
        assert!(off < 1e-9, "{off:e}");
    }
}

/// The tower, and with its upper bodies glued.
fn towers() -> [Scene; 2] {
    let mut glued = tower(0.05);
    glued.contacts[1] = ContactScene { kind: ContactKind::Tied, friction: 0.0, ..glued.contacts[1].clone() };
    [tower(0.05), glued]
}

#[test]
fn subgradients_are_those_of_differences() {
    let norm = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Area };
    let [parting, glued] = towers();
    for (scene, quantity) in [
        (&parting, Quantity::Pressure(norm)),
        (&parting, Quantity::MeanPressure { contact: Some(1) }),
        (&parting, Quantity::FrictionWork { contact: Some(0) }),
        (&parting, Quantity::ContactForce { contact: Some(1), axis: Some(1) }),
        (&glued, Quantity::ContactForce { contact: Some(1), axis: Some(0) }),
        (&glued, Quantity::ContactMoment { contact: Some(1), axis: None, about: [1.0, 2.0, 9.0] }),
        (&glued, Quantity::FrictionWork { contact: None }),
    ] {
        differentiated(scene, &quantity);
    }
}

fn differentiated(scene: &Scene, quantity: &Quantity) {
    for kind in [SolverKind::Direct, SolverKind::Newton] {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let objective = ContactObjective::new(shape, quantity.clone(), &[]).unwrap();
        let solve = |control: &Vector| objective.cases().solve(control, None, Accuracy::TIGHTEST).unwrap();
        let (at, step) = (at(scene), 2e-5);
        let here = solve(&at);
        let direction = Vector::from_fn(at.len(), |k, _| (k as f64 + 1.0).sin());
        let slope = objective.differentiate(&at, &here).unwrap().subgradient.dot(&direction);
        let value = |steps: f64| {
            let there = solve(&(&at + &direction * (steps * step)));
            assert_eq!(there[0].forces.status, here[0].forces.status, "the status changes within the steps");
            objective.value(&there)
        };
        let quotient = (8.0 * (value(1.0) - value(-1.0)) - (value(2.0) - value(-2.0))) / (12.0 * step);
        println!("{kind:?}, {quantity:?}: {:e}", slope / quotient - 1.0);
        assert!((slope / quotient - 1.0).abs() < 1e-6, "{kind:?}, {quantity:?}: {slope} {quotient}");
    }
}
