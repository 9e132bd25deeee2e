//! Jacobians of the outputs, by tangents of the state, against adjoints and against differences: along true normals
//! both take the turning of the rows and the change of the areas along.

use crate::cases::{obstacles, pressed, shape_and_direction};
use crate::grid::KINDS;
use crate::setting::PATHS;
use contact::contact_shape::ContactShape;
use contact::cost::{NodeWeight, PressureCost, PressureMeasure};
use contact::equilibrium::ContactStatus;
use nonsmooth::verify::seeded_direction;
use nonsmooth::{Accuracy, Coderivative, OutputJacobian, StateSolver, Vector};

/// Tangents and adjoints are solved to a relative residual of 1e-11, times the condition of the contact problem.
const OF_ADJOINTS: f64 = 1e-9;
/// Central differences over a step of 1e-5 mm: truncation 1e-10, rounding 1e-13/1e-5.
const STEP: f64 = 1e-5;
const OF_DIFFERENCES: f64 = 3e-7;

fn check(shape: &ContactShape, name: &str, seed: u64) -> [f64; 3] {
    let [at, direction] = shape_and_direction(shape.control_dimension(), seed);
    let solve = |at: &Vector| shape.solve(at, None, Accuracy::TIGHTEST).unwrap();
    let state = solve(&at);
    let found = shape.linearize(&at, &state, Accuracy::TIGHTEST).unwrap();
    assert_eq!(found.outputs, shape.outputs(&state));
    let weights = seeded_direction(found.outputs.len(), seed + 7);
    let dual = shape.output_dual(&at, &state, &weights);
    let adjoint = dual.control + shape.coderivative(&at, &state, &dual.state).unwrap().element;
    let tangent = found.jacobian.tr_mul(&weights);
    let of_adjoint = (&tangent - &adjoint).norm() / adjoint.norm();
    let [ahead, behind] = [1.0, -1.0].map(|way| solve(&(&at + &direction * (way * STEP))));
    assert!(ahead.forces.status == state.forces.status && behind.forces.status == state.forces.status, "{name}");
    let quotient = (shape.outputs(&ahead) - shape.outputs(&behind)) / (2.0 * STEP);
    let change = &found.jacobian * &direction;
    let of_outputs = (&change - &quotient).norm() / quotient.norm();
    let inactive = found.inactive.unwrap();
    let open = (0..state.forces.status.len()).filter(|&node| state.forces.status[node] == ContactStatus::Open);
    let openings = open.map(|node| (behind.forces.opening[node] - ahead.forces.opening[node]) / (2.0 * STEP));
    let quotient = Vector::from_vec(openings.collect());
    let change = &inactive.jacobian * &direction;
    let of_slacks = (&change - &quotient).norm() / quotient.norm().max(f64::MIN_POSITIVE);
    [of_adjoint, of_outputs, of_slacks]
}

#[test]
fn jacobians_of_outputs_and_slacks_are_those_of_adjoints_and_of_differences() {
    let mut worst = [0.0_f64; 3];
    for kind in KINDS {
        for (number, (name, obstacle)) in obstacles().into_iter().enumerate() {
            for (friction, path) in [0.0, 0.3, 0.8].into_iter().flat_map(|friction| PATHS.map(|path| (friction, path)))
            {
                let shape = ContactShape::new(pressed(kind, obstacle.clone(), friction), path).unwrap();
                let norm = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Area };
                let cost = PressureCost::new(norm, shape.problem()).unwrap();
                let shape = shape.with_outputs(cost.outputs(false));
                let name = format!("{kind:?}, {name}, friction {friction}, {path:?}");
                let [adjoint, outputs, slacks] = check(&shape, &name, 10 * number as u64 + 1);
                worst = [worst[0].max(adjoint), worst[1].max(outputs), worst[2].max(slacks)];
                assert!(adjoint < OF_ADJOINTS, "{name}: adjoint {adjoint:.1e}");
                assert!(outputs < OF_DIFFERENCES && slacks < OF_DIFFERENCES, "{name}: {outputs:.1e} {slacks:.1e}");
            }
        }
    }
    println!("largest differences: adjoint {:.1e}, outputs {:.1e}, slacks {:.1e}", worst[0], worst[1], worst[2]);
}
