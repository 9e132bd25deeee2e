//! Derivatives where supports prescribe displacements: Taylor tests of the adjoint, and tangents, by both solvers.

use crate::common::{start_height, unit};
use contact::body::mesh::BlockFace;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureCost, PressureMeasure, Quantity, Region};
use contact::equilibrium::TangentsOf;
use contact::scene::{Held, NormalKind, Scene, Support, hertz, signorini};
use nonsmooth::verify::{Direction, seeded_direction, taylor_test};
use nonsmooth::{Accuracy, CompositeObjective, NonsmoothObjective, StateSolver, Vector};

const KINDS: [SolverKind; 2] = [SolverKind::Newton, SolverKind::Direct];

fn moved(face: BlockFace, values: [Option<f64>; 3]) -> Support {
    Support { face: face.name().into(), held: Held::Components(values) }
}

/// Prescribed displacements of either body of Hertz' example, of a block along waves, and of nodes of its contact face.
fn scenes() -> Vec<(&'static str, Scene)> {
    let of_hertz = |lower: f64, upper: f64| {
        let mut scene = hertz().unwrap().with_bricks([4; 3], [2, 1, 2]).with_friction(0.3);
        scene.bodies[0].supports[2] = moved(BlockFace::Bottom, [None, None, Some(lower)]);
        let body = &mut scene.bodies[1];
        body.loads.clear();
        body.supports.push(moved(BlockFace::Top, [None, None, Some(upper)]));
        scene
    };
    let of_signorini = |friction: f64| {
        let mut scene = signorini().unwrap().with_bricks([4; 3], [2, 1, 2]).with_friction(friction);
        scene.bodies[0].loads.clear();
        scene.bodies[0].supports = vec![moved(BlockFace::Bottom, [Some(0.4), Some(-0.2), Some(3.0)])];
        scene.contacts[0].normal = NormalKind::Surface;
        scene
    };
    let mut dragged = of_signorini(0.0);
    dragged.bodies[0].supports.push(moved(BlockFace::X1Min, [Some(0.4), None, None]));
    vec![
        ("upper body", of_hertz(0.0, -0.05)),
        ("lower body", of_hertz(0.05, 0.0)),
        ("along waves", of_signorini(0.3)),
        ("dragged contact nodes", dragged),
    ]
}

fn controls(shape: &ContactShape, seed: u64) -> Vector {
    let height = start_height(&shape.problem().scene);
    seeded_direction(36, seed).map(|entry| height * (0.999 + 0.001 * entry))
}

fn pressure_cost(shape: &ContactShape) -> PressureCost {
    let measure = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Area };
    PressureCost::new(measure, shape.problem()).unwrap()
}

fn stress() -> Quantity {
    Quantity::StressNorm { region: Region::WHOLE, exponent: 6.0 }
}

/// The error of the directional derivative of an objective by the adjoint.
fn derivative_error(objective: &impl NonsmoothObjective, at: &Vector, height: f64) -> f64 {
    let steps: Vec<f64> = (0..8).map(|k| height * 1e-4 * 10.0_f64.powf(-0.5 * f64::from(k))).collect();
    let direction = Direction::Given(seeded_direction(36, 4));
    taylor_test(objective, at, &direction, &steps).unwrap().best_derivative_error
}

#[test]
fn adjoints_have_the_derivative_that_differences_have() {
    for (words, scene) in scenes() {
        for kind in KINDS {
            let shape = || ContactShape::new(scene.clone(), kind).unwrap();
            let (pressed, stressed) = (shape(), shape());
            let (at, height) = (controls(&pressed, 3), start_height(&scene));
            let pressure = pressure_cost(&pressed);
            let errors = [
                derivative_error(&CompositeObjective::new(pressed, pressure), &at, height),
                derivative_error(&ContactObjective::new(stressed, stress(), &[]).unwrap(), &at, height),
            ];
            println!("{words}, {kind:?}: {:.1e}, {:.1e}", errors[0], errors[1]);
            assert!(errors.iter().all(|error| *error < 1e-6), "{words}, {kind:?}: {errors:?}");
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn tangents_are_those_of_differences_and_of_the_adjoint() {
    const STEP: f64 = 1e-5;
    for (words, scene) in scenes() {
        for kind in KINDS {
            let shape = ContactShape::new(scene.clone(), kind).unwrap();
            let height = start_height(&scene);
            let at = controls(&shape, 3);
            let solve = |controls: &Vector| shape.solve(controls, None, Accuracy::TIGHTEST).unwrap();
            let state = solve(&at);
            let changes: Vec<Vec<f64>> = [0, 14, 21].map(|column| unit(36, column)).to_vec();
            let tangents =
                shape.contact_solver().tangents(&state.solution, &changes, TangentsOf::Contact, 0.0).unwrap();
            let dual = seeded_direction(shape.problem().boundary.row_count, 100);
            let positions = shape.contact_solver().sensitivities(&state.solution, dual.as_slice(), 1e-12).unwrap();
            let by_adjoint = shape.problem().map.pull_back(&positions.positions);
            for (column, change) in changes.iter().enumerate() {
                let forces = &tangents.forces[column];
                let (forward, adjoint) = (dot(forces, dual.as_slice()), dot(&by_adjoint, change));
                let size: f64 = forces.iter().zip(dual.iter()).map(|(a, b)| (a * b).abs()).sum();
                assert!((forward - adjoint).abs() <= 1e-8 * size, "{words}, {kind:?}: {forward} {adjoint} {size}");
                let step = STEP * height;
                let [ahead, behind] =
                    [step, -step].map(|step| solve(&(&at + Vector::from_column_slice(change) * step)));
                assert_eq!(ahead.forces.status, behind.forces.status, "{words}: a kink lies between");
                let quotient = |a: &[f64], b: &[f64]| -> Vec<f64> {
                    a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * step)).collect()
                };
                let points = &shape.problem().boundary.points;
                let normal: Vec<f64> = points.iter().map(|point| forces[point.start]).collect();
                for (found, expected) in [
                    (&normal, quotient(&ahead.forces.normal, &behind.forces.normal)),
                    (&tangents.openings[column], quotient(&ahead.forces.opening, &behind.forces.opening)),
                ] {
                    let size = expected.iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
                    for (found, expected) in found.iter().zip(&expected) {
                        assert!((found - expected).abs() <= 1e-5 * size, "{words}: {found} {expected} of {size}");
                    }
                }
            }
        }
    }
}
