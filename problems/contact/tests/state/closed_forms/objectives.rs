//! Objectives of a block that a plane presses on evenly: σ = p everywhere, σ_vM = p, and f·u = p² a b h/E.

use super::setting::{FIRST, SECOND, block, load, support, torn};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{FieldCost, FieldMeasure, PressureCost, PressureMeasure, Region};
use contact::scene::{CounterSurface, Scene};
use nonsmooth::composite::OuterFunction;
use nonsmooth::{Accuracy, Cost, OutputJacobian, StateSolver};

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
            (cost.value(&shape.outputs(&state)), cost)
        };
        let wanted =
            |factor: f64| PressureMeasure::Deviation { wanted: vec![factor * PRESSURE; problem.boundary.points.len()] };
        // Squares of errors of 1e-12.
        assert!(pressure(wanted(1.0)).0 < 1e-22 * PRESSURE * PRESSURE);
        assert!((pressure(wanted(3.0)).0 / (4.0 * PRESSURE * PRESSURE) - 1.0).abs() < 1e-11);
        assert!((pressure(PressureMeasure::OpenArea { pressure: PRESSURE }).0) < 1e-11 * area);
        let (open, cost) = pressure(PressureMeasure::OpenArea { pressure: 4.0 * PRESSURE });
        assert!((open / (0.75 * area) - 1.0).abs() < 1e-11, "{open}");
        let areas = cost.contact_areas(&state).unwrap();
        assert!((areas.closed / area - 1.0).abs() < 1e-14 && (areas.smoothed / (0.25 * area) - 1.0).abs() < 1e-11);
        let field = |measure| FieldCost::new(measure, problem).unwrap().value(&start, &state);
        for (region, exponent) in [(&whole, 3.0), (&whole, 40.0), (&part, 8.0)] {
            let norm = field(FieldMeasure::StressNorm { region: region.clone(), exponent });
            assert!((norm / PRESSURE - 1.0).abs() < 1e-10, "{exponent}: {norm}");
        }
        let compliance = field(FieldMeasure::Compliance);
        let exact = PRESSURE * PRESSURE * area * HEIGHT / MODULUS;
        assert!((compliance / exact - 1.0).abs() < 1e-10, "{compliance} {exact}");
    }
}
