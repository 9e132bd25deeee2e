//! The coderivative against central differences over random shapes, friction coefficients and loads.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureCost, PressureMeasure};
use contact::scene::{Scene, hertz, signorini};
use nonsmooth::{CompositeObjective, NonsmoothObjective, Request, Vector};
use proptest::prelude::*;

type Objective = CompositeObjective<ContactShape, PressureCost>;

fn objective(scene: Scene, friction: f64, load: f64, measure: PressureMeasure) -> Objective {
    let mut scene = scene.with_bricks([4; 3], [2; 3]).with_friction(friction);
    for part in scene.bodies.iter_mut().flat_map(|body| &mut body.loads) {
        *part = part.scaled(load);
    }
    let shape = ContactShape::new(scene, SolverKind::Newton).unwrap();
    let cost = PressureCost::new(measure, shape.problem()).unwrap();
    CompositeObjective::new(shape, cost)
}

/// Largest relative difference of the subgradient's product and a difference quotient that counts as agreement.
const AGREEMENT: f64 = 1e-6;

/// Whether ⟨ξ, d⟩ agrees with the central quotient of one of five steps. A long step may lie across a kink, a short one
/// drown in rounding; a wrong subgradient agrees with none.
fn agrees(objective: &Objective, control: &Vector, direction: &Vector) -> Result<(), TestCaseError> {
    let evaluate = |control: &Vector| objective.evaluate(&Request::tight(control)).unwrap().into_evaluation();
    let subgradient = evaluate(control).subgradient;
    let (product, size) = (subgradient.dot(direction), subgradient.norm() * direction.norm());
    let mut errors = Vec::new();
    for exponent in [4, 5, 6, 3, 7] {
        let step = control.norm() / 6.0 * 10.0_f64.powi(-exponent);
        let (ahead, behind) = (evaluate(&(control + direction * step)), evaluate(&(control - direction * step)));
        let quotient = (ahead.value - behind.value) / (2.0 * step);
        errors.push((quotient - product).abs() / size);
        if errors[errors.len() - 1] < AGREEMENT {
            return Ok(());
        }
    }
    Err(TestCaseError::fail(format!("relative differences of five steps {errors:?}")))
}

fn numbers(seed: u64, count: usize) -> Vector {
    nonsmooth::verify::seeded_direction(count, seed)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn one_body_against_an_obstacle(
        seed in 0_u64..1_000_000, friction in prop_oneof![Just(0.0), 0.05..0.8],
        load in 0.3_f64..2.0, exponent in 2.0_f64..6.0,
    ) {
        let measure = PressureMeasure::Norm { exponent, weight: NodeWeight::Nodes };
        let objective = objective(signorini().unwrap(), friction, load, measure);
        let control = numbers(seed, 36).map(|entry| 98.0 + entry);
        agrees(&objective, &control, &numbers(seed + 1, 36))?;
    }

    #[test]
    fn two_bodies(
        seed in 0_u64..1_000_000, friction in prop_oneof![Just(0.0), 0.05..0.6], load in 0.5_f64..1.5,
    ) {
        let measure = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes };
        let objective = objective(hertz().unwrap(), friction, load, measure);
        let control = numbers(seed, 36).map(|entry| 9.7 + 0.1 * entry);
        agrees(&objective, &control, &numbers(seed + 1, 36))?;
    }
}

#[test]
fn peak_pressure_has_the_subgradient_of_its_node() {
    let objective = objective(signorini().unwrap(), 0.3, 1.0, PressureMeasure::Peak);
    let control = numbers(5, 36).map(|entry| 98.0 + entry);
    agrees(&objective, &control, &numbers(6, 36)).unwrap();
}
