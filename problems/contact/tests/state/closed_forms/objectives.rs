//! Objectives of a block that a plane presses on evenly: σ = p everywhere, σ_vM = p, and f·u = p² a b h/E.

use super::setting::{FIRST, SECOND, block, load, support, torn};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{PressureCost, PressureMeasure, Quantity, Region, StateCost, StateView, WantedPressure};
use contact::scene::{CounterSurface, Scene};
use nonsmooth::composite::OuterFunction;
use nonsmooth::{Accuracy, OutputJacobian, StateSolver};

const PRESSURE: f64 = 12.0;
const MODULUS: f64 = 3.0e4;
const SIZE: [f64; 2] = [6.0, 5.0];
const HEIGHT: f64 = 4.0;

fn pressed() -> Scene {
    let material = Material::new(MODULUS, 0.31).unwrap();
    let scene = block(SIZE, HEIGHT, [4, 2, 3], material, CounterSurface::Plane { height: HEIGHT });
    let mut scene = torn(scene, [2, 1, 1]);
    scene.bodies[0].supports = vec![support(BlockFace::X1Min, FIRST), support(BlockFace::X2Min, SECOND)];
    scene.bodies[0].loads = vec![load(BlockFace::Bottom, [0.0, 0.0, PRESSURE])];
    scene
}

#[test]
fn objectives_of_a_uniformly_pressed_block() {
    let area = SIZE[0] * SIZE[1];
    let whole = Region::WHOLE;
    let (lower, upper) = ([1.0, 0.0, 0.0], [5.0, 2.5, 2.0]);
    let part = Region { lower, upper, body: Some("lower".into()), volume: None, face: None };
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let shape = ContactShape::new(pressed(), kind).unwrap().with_displacements();
        let (problem, start) = (shape.problem(), shape.start());
        let state = shape.solve(&start, None, Accuracy::TIGHTEST).unwrap();
        let pressure = |measure| {
            let cost = PressureCost::new(measure, problem).unwrap();
            cost.value(&shape.outputs(&state))
        };
        let wanted = |factor: f64| PressureMeasure::Deviation {
            wanted: WantedPressure::AtNodes(vec![factor * PRESSURE; problem.boundary.points.len()]),
        };
        // Squares of errors of 1e-12.
        assert!(pressure(wanted(1.0)) < 1e-22 * PRESSURE * PRESSURE);
        assert!((pressure(wanted(3.0)) / (4.0 * PRESSURE * PRESSURE) - 1.0).abs() < 1e-11);
        assert!(pressure(PressureMeasure::OpenArea { pressure: PRESSURE }) < 1e-11 * area);
        let open = pressure(PressureMeasure::OpenArea { pressure: 4.0 * PRESSURE });
        assert!((open / (0.75 * area) - 1.0).abs() < 1e-11, "{open}");
        let field = |quantity: Quantity| {
            let cost = StateCost::new("objective", &quantity, problem).unwrap().unwrap();
            cost.value(problem, StateView::of(&state))
        };
        let loaded = field(Quantity::LoadedArea { pressure: 4.0 * PRESSURE });
        assert!((loaded / (0.25 * area) - 1.0).abs() < 1e-11, "{loaded}");
        assert!((field(Quantity::ClosedArea { contact: None }) / area - 1.0).abs() < 1e-14);
        assert!((field(Quantity::MeanPressure { contact: Some(0) }) / PRESSURE - 1.0).abs() < 1e-11);
        let force = |axis| Quantity::ContactForce { contact: None, axis };
        let moment = |axis, about| Quantity::ContactMoment { contact: Some(0), axis: Some(axis), about };
        let whole_force = PRESSURE * area;
        for (quantity, exact) in [
            // The plane above holds what is pushed from below.
            (force(Some(2)), -whole_force),
            (force(None), whole_force),
            (moment(0, [0.0; 3]), -whole_force * 0.5 * SIZE[1]),
            (moment(1, [1.0, 7.0, 3.0]), whole_force * (0.5 * SIZE[0] - 1.0)),
        ] {
            let found = field(quantity.clone());
            assert!((found / exact - 1.0).abs() < 1e-10, "{quantity:?}: {found} {exact}");
        }
        let face = |name: &str| Region { face: Some(name.into()), ..Region::WHOLE };
        let (region, relative_to) = (face("bottom"), Some(face("top")));
        let shortened = field(Quantity::Displacement { region, relative_to, axis: Some(2), least: false });
        assert!((shortened * MODULUS / (PRESSURE * HEIGHT) - 1.0).abs() < 1e-10, "{shortened}");
        // Nothing presses against the supports at the sides.
        let reaction = field(Quantity::Reaction { region: face("x1-min"), axis: Some(0) });
        assert!(reaction.abs() < 1e-10 * whole_force, "{reaction}");
        for (region, exponent) in [(&whole, 3.0), (&whole, 40.0), (&part, 8.0)] {
            let norm = field(Quantity::StressNorm { region: region.clone(), exponent });
            assert!((norm / PRESSURE - 1.0).abs() < 1e-10, "{exponent}: {norm}");
        }
        let compliance = field(Quantity::Compliance);
        let exact = PRESSURE * PRESSURE * area * HEIGHT / MODULUS;
        assert!((compliance / exact - 1.0).abs() < 1e-10, "{compliance} {exact}");
    }
}
