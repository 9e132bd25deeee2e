//! What Θ, ξ and the status must not notice: the unit of force, and the hand of a mirrored shape.

use crate::common::start_height;
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, ContactWarmStart, SolverKind};
use contact::cost::{NodeWeight, PressureCost, PressureMeasure};
use contact::equilibrium::ContactStatus;
use contact::scene::{Load, Scene, hertz, signorini};
use nonsmooth::{Accuracy, CompositeObjective, Evaluation, StateSolver, Vector};
use testset::kit::relative_difference;

struct Outcome {
    evaluation: Evaluation<ContactWarmStart>,
    status: Vec<ContactStatus>,
    opening: Vec<f64>,
    displacement: Vec<f64>,
}

fn evaluate(scene: &Scene, control: &Vector, kind: SolverKind) -> Outcome {
    let shape = ContactShape::new(scene.clone(), kind).unwrap();
    let measure = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes };
    let cost = PressureCost::new(measure, shape.problem()).unwrap();
    let objective = CompositeObjective::new(shape, cost);
    let state = objective.solver().solve(control, None, Accuracy::TIGHTEST).unwrap();
    let evaluation = objective.differentiate(control, &state).unwrap();
    let displacement = state.solution.torn().map_or_else(Vec::new, |state| state.displacement().to_vec());
    Outcome { evaluation, status: state.forces.status.clone(), opening: state.forces.opening.clone(), displacement }
}

fn scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    for body in &mut scene.bodies {
        let material = body.material;
        body.material = Material::new(factor * material.young_modulus(), material.poisson_ratio()).unwrap();
        for load in &mut body.loads {
            *load = load.scaled(factor);
        }
    }
    scene
}

fn bent(scene: &Scene) -> Vector {
    nonsmooth::verify::seeded_direction(36, 11).map(|bend| start_height(scene) * (0.99 + 0.005 * bend))
}

#[test]
fn stiffness_and_loads_scaled_together_change_the_unit_of_force_only() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        let scene = scene.with_bricks([6; 3], [2; 3]);
        let control = bent(&scene);
        for kind in [SolverKind::Newton, SolverKind::Direct] {
            let unit = evaluate(&scene, &control, kind);
            for factor in [1e-6, 3.7, 1e9] {
                let other = evaluate(&scaled(&scene, factor), &control, kind);
                assert_eq!(unit.status, other.status);
                let value = (other.evaluation.value / (factor.powi(4) * unit.evaluation.value) - 1.0).abs();
                let rescaled = &other.evaluation.subgradient / factor.powi(4);
                let slope = relative_difference(&rescaled, &unit.evaluation.subgradient);
                let opening = relative_difference(&other.opening, &unit.opening);
                let displacement = relative_difference(&other.displacement, &unit.displacement);
                println!(
                    "{} {kind:?} s = {factor:.0e}: Θ/s⁴ {value:.1e}, ξ/s⁴ {slope:.1e}, gaps {opening:.1e}, u {displacement:.1e}",
                    scene.name
                );
                assert!(value < 1e-10 && slope < 1e-8 && opening < 1e-10 && displacement < 1e-10);
            }
        }
    }
}

/// Controls, or a subgradient, of the shape seen in a mirror: x₂ ↦ b − x₂, or x₁ ↔ x₂.
fn mirrored(control: &Vector, swap: bool) -> Vector {
    Vector::from_fn(36, |index, _| {
        let (i, j) = (index / 6, index % 6);
        if swap { control[6 * j + i] } else { control[6 * i + 5 - j] }
    })
}

#[test]
fn a_mirrored_shape_has_the_mirrored_subgradient() {
    let mut other_hand = hertz().unwrap();
    other_hand.bodies[1].loads[1] = Load::traction(BlockFace::X2Max, [0.0, 500.0, -2000.0]);
    // The obstacle of Signorini's example is even about x₂ = b/2; the sphere does not know x₁ from x₂.
    let cases = [(signorini().unwrap(), signorini().unwrap(), false), (hertz().unwrap(), other_hand, true)];
    for (scene, image, swap) in cases {
        let [scene, image] = [scene, image].map(|scene| scene.with_bricks([6; 3], [2; 3]));
        let control = bent(&scene);
        for kind in [SolverKind::Newton, SolverKind::Direct] {
            let here = evaluate(&scene, &control, kind).evaluation;
            let there = evaluate(&image, &mirrored(&control, swap), kind).evaluation;
            let value = (there.value / here.value - 1.0).abs();
            let slope = relative_difference(&mirrored(&there.subgradient, swap), &here.subgradient);
            println!("{} {kind:?} mirrored: Θ {value:.1e}, ξ {slope:.1e}", scene.name);
            assert!(value < 1e-10 && slope < 1e-8, "{value:.1e} {slope:.1e}");
        }
    }
}
