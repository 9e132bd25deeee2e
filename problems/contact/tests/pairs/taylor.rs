//! Subgradients through the mortar weights: central differences of the objective along random directions of the
//! controls of both bodies, forward derivatives against adjoints, both normals, both kinds of cells, both solvers.

use crate::grid::{KINDS, Point, mesh};
use crate::setting::{body, lattice, pair, stacked};
use contact::body::mesh::CellKind;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureMeasure, Quantity};
use contact::equilibrium::TangentsOf;
use contact::scene::{NormalKind, Scene};
use nonsmooth::{Accuracy, StateSolver, Vector};

/// The height of the interface over a base of 10 mm × 10 mm.
fn interface([x1, x2]: [f64; 2]) -> f64 {
    10.0 - 0.01 * (x1 * x1 + 0.5 * x2 * x2) + 0.002 * x1 * x2
}

/// Two bodies with a curved interface, both in lattices of their own; the upper one is pressed into the lower one.
pub fn curved(kind: CellKind, boxes: [[usize; 3]; 2], slave: usize, friction: f64) -> Scene {
    let below = |[s, t, r]: Point| [10.0 * s, 10.0 * t, r * interface([10.0 * s, 10.0 * t])];
    let above = |[s, t, r]: Point| {
        let height = interface([10.0 * s, 10.0 * t]) + 0.01;
        [10.0 * s, 10.0 * t, height + r * (18.0 - height)]
    };
    let mut lower = body("lower", mesh(kind, boxes[0], 0.15, below), [1000.0, 0.3]);
    let mut upper = body("upper", mesh(kind, boxes[1], 0.15, above), [3000.0, 0.25]);
    lower.shape = lattice([0.0; 3], [10.0, 10.0, 10.5], [true; 3]);
    upper.shape = lattice([0.0, 0.0, 6.0], [10.0, 10.0, 12.0], [true; 3]);
    let mut bodies = stacked(lower, upper, 8.0);
    bodies[1].loads.push(contact::scene::Load::traction("x1-max", [1.5, 0.4, 0.0]));
    pair(bodies, slave, friction)
}

fn objective(scene: &Scene, kind: SolverKind, measure: &Quantity) -> ContactObjective {
    ContactObjective::new(ContactShape::new(scene.clone(), kind).unwrap(), measure.clone(), &[]).unwrap()
}

/// Relative difference of ⟨g, d⟩ and the difference quotient of fourth order.
fn slope_error(scene: &Scene, kind: SolverKind, measure: &Quantity) -> f64 {
    let objective = objective(scene, kind, measure);
    let count = scene.control_count();
    let at = Vector::from_fn(count, |k, _| 0.02 * (2.0 * k as f64 + 1.0).cos());
    let direction = Vector::from_fn(count, |k, _| (k as f64 + 1.0).sin());
    let solve = |control: &Vector| objective.cases().solve(control, None, Accuracy::TIGHTEST).unwrap();
    let here = solve(&at);
    let slope = objective.differentiate(&at, &here).unwrap().subgradient.dot(&direction);
    let status = &here[0].forces.status;
    let step = 2e-5;
    let value = |steps: f64| {
        let there = solve(&(&at + &direction * (steps * step)));
        assert_eq!(there[0].forces.status, *status, "the status changes within the steps");
        objective.value(&there)
    };
    let quotient = (8.0 * (value(1.0) - value(-1.0)) - (value(2.0) - value(-2.0))) / (12.0 * step);
    (slope / quotient - 1.0).abs()
}

fn measures(friction: f64) -> Vec<Quantity> {
    let norm = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Area };
    let stress = Quantity::StressNorm { region: contact::cost::Region::WHOLE, exponent: 6.0 };
    let moment = Quantity::ContactMoment { contact: None, axis: Some(1), about: [1.0, 2.0, 3.0] };
    let mut measures = vec![Quantity::Pressure(norm), stress, moment, Quantity::MeanPressure { contact: Some(0) }];
    if friction > 0.0 {
        measures.push(Quantity::ContactForce { contact: None, axis: Some(0) });
    }
    measures
}

#[test]
fn subgradients_are_those_of_differences() {
    for kind in KINDS {
        let boxes = if kind == CellKind::Hex8 { [[3, 3, 2], [4, 4, 2]] } else { [[2, 2, 1], [3, 3, 1]] };
        for slave in [0, 1] {
            for normal in [NormalKind::Surface, NormalKind::X3] {
                for friction in [0.0, 0.3] {
                    let mut scene = curved(kind, boxes, slave, friction);
                    scene.contacts[0].normal = normal;
                    for measure in &measures(friction) {
                        for solver in [SolverKind::Direct, SolverKind::Newton] {
                            let error = slope_error(&scene, solver, measure);
                            println!(
                                "{kind:?} {slave} {normal:?} {friction} {solver:?} {}: {error:.1e}",
                                measure.name()
                            );
                            assert!(
                                error < 2e-6,
                                "{kind:?} {slave} {normal:?} {friction} {solver:?} {measure:?}: {error:e}"
                            );
                        }
                    }
                }
            }
        }
    }
}

/// With so little friction the faces slide.
#[test]
fn work_and_slip_of_sliding_faces_have_the_derivatives_of_differences() {
    for (kind, boxes) in [(CellKind::Hex8, [[3, 3, 2], [4, 4, 2]]), (CellKind::Tet10, [[2, 2, 1], [3, 3, 1]])] {
        for slave in [0, 1] {
            let scene = curved(kind, boxes, slave, 0.02);
            for quantity in [Quantity::FrictionWork { contact: None }, Quantity::Slip { contact: Some(0) }] {
                for solver in [SolverKind::Direct, SolverKind::Newton] {
                    let error = slope_error(&scene, solver, &quantity);
                    println!("{kind:?} {slave} {solver:?} {}: {error:.1e}", quantity.name());
                    assert!(error < 2e-6, "{kind:?} {slave} {solver:?} {quantity:?}: {error:e}");
                }
            }
        }
    }
}

/// Tangents along all controls against adjoints of single contact forces.
#[test]
fn forward_and_adjoint_derivatives_agree() {
    for solver in [SolverKind::Direct, SolverKind::Newton] {
        let scene = curved(CellKind::Hex8, [[3, 3, 2], [4, 4, 2]], 0, 0.3);
        let shape = ContactShape::new(scene.clone(), solver).unwrap();
        let count = scene.control_count();
        let at = Vector::from_fn(count, |k, _| 0.02 * (2.0 * k as f64 + 1.0).cos());
        let state = shape.solve(&at, None, Accuracy::TIGHTEST).unwrap();
        let tangents = shape.tangents(&state, TangentsOf::Displacements, Accuracy::TIGHTEST).unwrap();
        let rows = shape.problem().boundary.row_count;
        let displacements = tangents.displacements.as_ref().unwrap();
        let entries = displacements[0].len();
        for seed in 0..3 {
            let dual = Vector::from_fn(rows + entries, |i, _| (1.0 + (seed * 7 + i) as f64).sin());
            let (gradient, _) = shape.pull_back(&at, &state, &dual).unwrap();
            let forward = Vector::from_fn(count, |k, _| {
                let forces: f64 = tangents.forces[k].iter().zip(dual.iter()).map(|(a, b)| a * b).sum();
                let moved = displacements[k].iter().zip(dual.iter().skip(rows)).map(|(a, b)| a * b);
                forces + moved.sum::<f64>()
            });
            let error = (&forward - &gradient).norm() / gradient.norm();
            println!("{solver:?}: {error:.1e}");
            assert!(error < 1e-7, "{solver:?}: {error:e}");
        }
    }
}
