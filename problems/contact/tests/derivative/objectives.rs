//! Taylor tests of the objectives beside pressure norm and peak: both solvers, one or two bodies, without friction too.

use crate::common::start_height;
use contact::body::mesh::BlockFace;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{
    Limit, LimitSide, NodeWeight, PressureMeasure, Quantity, Region, StateCost, StateView, WantedPressure,
};
use contact::scene::{Load, LoadKind, Scene, hertz, signorini};
use nonsmooth::verify::{Direction, seeded_direction, taylor_test};
use nonsmooth::{Accuracy, Answer, Evaluation, NonsmoothObjective, OracleError, Request, StateSolver, Vector};

const KINDS: [SolverKind; 2] = [SolverKind::Newton, SolverKind::Direct];

/// Both scenes without and with friction; loads act on side faces of both bodies as well, whose area changes.
fn scenes() -> impl Iterator<Item = Scene> {
    let scene = |scene: Scene, friction| {
        let mut scene = scene.with_bricks([4; 3], [2, 1, 2]).with_friction(friction);
        let push = scene.bodies[0].loads.first().map_or(20.0, |load| match load.kind {
            LoadKind::Traction([_, _, normal]) => 0.02 * normal,
            _ => unreachable!("the presets have tractions"),
        });
        scene.bodies[0].loads.push(Load::traction(BlockFace::X1Max, [-push, 0.0, 0.2 * push]));
        scene
    };
    [0.0, 0.3].into_iter().flat_map(move |friction| [signorini(), hertz()].map(|found| scene(found.unwrap(), friction)))
}

/// A box that leaves out parts of both bodies.
fn region(scene: &Scene, body: Option<&str>) -> Region {
    let ([a, b], height) = (scene.bodies[0].block().unwrap().size, start_height(scene));
    let (lower, upper) = ([0.0, 0.2 * b, 0.3 * height], [0.7 * a, b, 1.6 * height]);
    Region { lower, upper, body: body.map(str::to_owned), volume: None, face: None }
}

fn controls(shape: &ContactShape, seed: u64) -> Vector {
    let height = start_height(&shape.problem().scene);
    seeded_direction(36, seed).map(|entry| height * (0.98 + 0.01 * entry))
}

/// Smallest relative error of the directional derivative over the steps of a Taylor table around a shape without a kink
/// nearby, and the evaluation there.
fn derivative_error(shape: ContactShape, measure: Quantity) -> (f64, f64, Vector) {
    let at = controls(&shape, 3);
    let height = start_height(&shape.problem().scene);
    let objective = ContactObjective::new(shape, measure, &[]).unwrap();
    let direction = Direction::Given(seeded_direction(36, 4));
    let steps: Vec<f64> = (0..8).map(|k| height * 1e-4 * 10.0_f64.powf(-0.5 * f64::from(k))).collect();
    let test = taylor_test(&objective, &at, &direction, &steps).unwrap();
    let evaluation = objective.evaluate(&Request::tight(&at)).unwrap().into_evaluation();
    (test.best_derivative_error, evaluation.value, evaluation.subgradient)
}

/// Both solvers have the derivative that differences have, and the same one.
fn differentiated(name: &str, scene: &Scene, measure: impl Fn(&ContactShape) -> Quantity) {
    let found = KINDS.map(|kind| {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let measure = measure(&shape);
        derivative_error(shape, measure)
    });
    let [newton, direct] = &found;
    let (value, slope) = (newton.1 / direct.1 - 1.0, (&newton.2 - &direct.2).norm() / direct.2.norm());
    println!(
        "{name}, {}, friction {}: {:.6e}; derivatives {:.1e}, {:.1e}; solvers differ by {value:.1e}, {slope:.1e}",
        scene.name,
        scene.friction(),
        newton.1,
        newton.0,
        direct.0
    );
    assert!(newton.0 < 1e-6 && direct.0 < 1e-6, "{name}: {} {}", newton.0, direct.0);
    assert!(value.abs() < 1e-9 && slope < 1e-7, "{name}: {value:e} {slope:e}");
}

#[test]
fn stress_norm() {
    for scene in scenes() {
        let bodies = if scene.bodies.len() > 1 { vec![None, Some("lower"), Some("upper")] } else { vec![None] };
        for (body, exponent) in bodies.into_iter().zip([6.0, 12.0, 3.0]) {
            let measure = Quantity::StressNorm { region: region(&scene, body), exponent };
            let name = format!("stress norm {exponent}, body {body:?}");
            differentiated(&name, &scene, |_| measure.clone());
        }
    }
}

#[test]
fn largest_stress_and_displacement() {
    for scene in scenes() {
        let region = region(&scene, None);
        let stress = Quantity::Stress { region: region.clone(), without_held: false };
        differentiated("largest stress", &scene, |_| stress.clone());
        for (axis, least) in [(Some(2), true), (Some(2), false), (None, false)] {
            let measure = Quantity::Displacement { region: region.clone(), relative_to: None, axis, least };
            let name = format!("displacement {axis:?}, least {least}");
            differentiated(&name, &scene, |_| measure.clone());
        }
    }
}

#[test]
fn compliance() {
    for scene in scenes() {
        differentiated("compliance", &scene, |_| Quantity::Compliance);
    }
}

/// Σλ_N/ΣA of a state at the start, MPa.
fn mean_pressure(shape: &ContactShape) -> f64 {
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    state.forces.total_normal_force() / state.rows.area()
}

#[test]
fn measures_of_the_pressures() {
    for scene in scenes() {
        differentiated("deviation from a wanted pressure", &scene, |shape| {
            let mean = mean_pressure(shape);
            let grid = shape.problem().scene.bodies[0].block().unwrap().grid();
            let places = grid.places();
            let wanted = places.map(|[x1, x2]| mean * (1.0 + x1 / grid.size[0] - x2 / grid.size[1])).collect();
            Quantity::Pressure(PressureMeasure::Deviation { wanted: WantedPressure::AtNodes(wanted) })
        });
        differentiated("open area", &scene, |shape| {
            Quantity::Pressure(PressureMeasure::OpenArea { pressure: 1.7 * mean_pressure(shape) })
        });
    }
}

#[test]
fn successive_approximations_share_the_adjoint() {
    let scene = signorini().unwrap().with_bricks([4; 3], [2; 3]).with_friction(0.3);
    let subgradient = |kind| {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let at = controls(&shape, 3);
        let objective = ContactObjective::new(shape, Quantity::Compliance, &[]).unwrap();
        objective.evaluate(&Request::tight(&at)).unwrap().into_evaluation().subgradient
    };
    let [paper, direct] = [SolverKind::AugmentedLagrangian, SolverKind::Direct].map(subgradient);
    // Their states are accurate to 1e-9 or so.
    assert!((&paper - &direct).norm() < 1e-6 * direct.norm(), "{:e}", (&paper - &direct).norm() / direct.norm());
}

#[test]
fn a_dual_of_another_size_is_refused_and_a_state_without_displacements_has_no_value() {
    let scene = signorini().unwrap().with_bricks([4; 3], [2; 3]);
    for kind in KINDS {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
        let sizes = [shape.problem().boundary.row_count, shape.problem().displacement_count()];
        for wrong in [sizes[0] - 1, sizes[0] + 1, sizes[0] + sizes[1] - 1] {
            let refusal = shape.position_sensitivity(&state, &Vector::zeros(wrong)).unwrap_err().to_string();
            assert!(refusal.contains("dual of the contact state"), "{refusal}");
        }
        assert!(shape.position_sensitivity(&state, &Vector::zeros(sizes[0] + sizes[1])).is_ok());
        let cost = StateCost::new("objective", &Quantity::Compliance, shape.problem()).unwrap().unwrap();
        assert!(cost.value(shape.problem(), StateView::of(&state)).is_nan());
    }
}

#[test]
fn regions_without_a_brick_or_a_body_are_refused() {
    let scene = signorini().unwrap().with_bricks([4; 3], [2; 3]);
    let shape = ContactShape::new(scene, SolverKind::Direct).unwrap();
    let refused = |region: Region| {
        let measure = Quantity::StressNorm { region, exponent: 4.0 };
        StateCost::new("objective", &measure, shape.problem()).unwrap_err().to_string()
    };
    let all = Region::WHOLE;
    let outside = refused(Region { lower: [0.0, 0.0, 200.0], ..all.clone() });
    assert!(outside.contains("objective.region") && outside.contains("centre of a cell"), "{outside}");
    let upper = refused(Region { body: Some("upper".into()), ..all });
    assert!(upper.contains("objective.region.body = \"upper\""), "{upper}");
}

/// The limited peak, whose subgradient comes with the evaluation, as an objective of its own.
#[derive(Debug)]
struct LimitedPeak(ContactObjective);

impl NonsmoothObjective for LimitedPeak {
    type WarmStart = <ContactObjective as NonsmoothObjective>::WarmStart;

    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    fn evaluate(&self, request: &Request<'_, Self::WarmStart>) -> Result<Answer<Self::WarmStart>, OracleError> {
        let evaluation = self.0.evaluate(request)?.into_evaluation();
        let constraints = evaluation.constraints.unwrap();
        let subgradient = constraints.jacobian.row(0).transpose();
        Ok(Answer::Accurate(Evaluation::exact(constraints.values[0], subgradient, evaluation.warm_start)))
    }
}

#[test]
fn the_limited_peak_has_the_derivative_that_differences_have() {
    for scene in scenes() {
        let shape = ContactShape::new(scene, SolverKind::Direct).unwrap();
        let limit = 1.7 * shape.problem().load();
        let at = controls(&shape, 3);
        let height = start_height(&shape.problem().scene);
        let norm = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes };
        let peak = Limit::new(Quantity::Pressure(PressureMeasure::Peak), LimitSide::AtMost, limit);
        let objective = LimitedPeak(ContactObjective::new(shape, Quantity::Pressure(norm), &[peak]).unwrap());
        let direction = Direction::Given(seeded_direction(36, 4));
        let steps: Vec<f64> = (0..8).map(|k| height * 1e-4 * 10.0_f64.powf(-0.5 * f64::from(k))).collect();
        let test = taylor_test(&objective, &at, &direction, &steps).unwrap();
        assert!(test.best_derivative_error < 1e-6, "{test}");
        let state = objective.0.cases().solve(&at, None, Accuracy::TIGHTEST).unwrap();
        let peak = objective.0.pressures(&state[0]).into_iter().fold(0.0, f64::max);
        let value = objective.evaluate(&Request::tight(&at)).unwrap().into_evaluation().value;
        assert!((value - (peak - limit)).abs() < 1e-9 * peak, "{value} {peak} {limit}");
    }
}
