//! Subgradients along true normals: remainders of Taylor's formula fall with the square of the step for every obstacle,
//! both kinds of cells, without and with friction, for pressures and for fields.

use crate::cases::{obstacles, pressed, shape_and_direction};
use crate::grid::KINDS;
use contact::body::mesh::CellKind;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureMeasure, Quantity, Region};
use contact::equilibrium::StatusCounts;
use contact::scene::Scene;
use nonsmooth::{Accuracy, StateSolver, Vector};

fn measures(friction: f64) -> Vec<(&'static str, Quantity)> {
    let norm = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Area };
    let stress = Quantity::StressNorm { region: Region::WHOLE, exponent: 6.0 };
    let mut measures = vec![("pressure norm", Quantity::Pressure(norm)), ("stress norm", stress)];
    if friction > 0.0 {
        let held = Region { face: Some("x1-min".into()), ..Region::WHOLE };
        measures.push(("reaction", Quantity::Reaction { region: held, axis: None }));
        measures.push(("contact moment", Quantity::ContactMoment { contact: None, axis: Some(0), about: [1.0; 3] }));
    }
    measures
}

/// Steps in units of the direction, whose entries are up to 1 mm.
const STEPS: [f64; 5] = [1.6e-3, 8e-4, 4e-4, 2e-4, 1e-4];

/// Remainders J(a + t d) − J(a) − t ⟨g, d⟩ over the steps, |⟨g, d⟩|, and numbers of statuses, which are the same at all
/// steps.
struct Found {
    remainders: Vec<f64>,
    derivative: f64,
    /// |g| |d|.
    size: f64,
    value: f64,
    counts: StatusCounts,
}

fn remainders(objective: &ContactObjective, at: &Vector, direction: &Vector) -> Result<Found, String> {
    let solve = |control: &Vector| objective.cases().solve(control, None, Accuracy::TIGHTEST).unwrap();
    let here = solve(at);
    let evaluation = objective.differentiate(at, &here).unwrap();
    let derivative = evaluation.subgradient.dot(direction);
    let mut remainders = Vec::new();
    for step in STEPS {
        let control = at + direction * step;
        let there = solve(&control);
        if there[0].forces.status != here[0].forces.status {
            return Err(format!("the status changes within a step of {step}"));
        }
        remainders.push(objective.value(&there) - evaluation.value - step * derivative);
    }
    let size = evaluation.subgradient.norm() * direction.norm();
    Ok(Found {
        remainders,
        derivative: derivative.abs(),
        size,
        value: evaluation.value,
        counts: here[0].forces.counts(),
    })
}

/// Slope of log|remainder| over log(step), by least squares.
fn slope(remainders: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> = STEPS.iter().zip(remainders).map(|(t, r)| (t.ln(), r.abs().ln())).collect();
    let count = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / count, sum.1 + point.1 / count));
    let sums = points.iter().fold((0.0, 0.0), |sums, point| {
        let x = point.0 - mean.0;
        (sums.0 + x * (point.1 - mean.1), sums.1 + x * x)
    });
    sums.0 / sums.1
}

/// The part of the last remainders that is linear in the step: what a wrong derivative leaves. With
/// r(t) = e t + h t² + k t³ and q(t) = 4 r(t/2) − r(t) = e t − k t³/2, it is 8 q(t/2) − q(t) = 3 e t.
fn linear_part(remainders: &[f64]) -> f64 {
    let [.., r0, r1, r2] = remainders else { unreachable!("at least three steps") };
    let q = [4.0 * r1 - r0, 4.0 * r2 - r1];
    (8.0 * q[1] - q[0]) / (3.0 * STEPS[STEPS.len() - 3])
}

/// The shape of some seed, near which no status changes: the first of a few, so that no case is left out.
fn case(scene: &Scene, measure: &Quantity, seed: u64) -> Found {
    let shape = ContactShape::new(scene.clone(), SolverKind::Newton).unwrap();
    let objective = ContactObjective::new(shape, measure.clone(), &[]).unwrap();
    let mut reasons = Vec::new();
    for attempt in 0..6 {
        let [at, direction] = shape_and_direction(scene.control_count(), seed + attempt);
        match remainders(&objective, &at, &direction) {
            Ok(found) => return found,
            Err(reason) => reasons.push(reason),
        }
    }
    unreachable!("six shapes near kinks: {reasons:?}")
}

/// Runs all cases of one kind of cells.
fn check(kind: CellKind) {
    let mut all = StatusCounts::default();
    for (number, (name, obstacle)) in obstacles().into_iter().enumerate() {
        for friction in [0.0, 0.3, 0.8] {
            let scene = pressed(kind, obstacle.clone(), friction);
            for (what, measure) in measures(friction) {
                let found = case(&scene, &measure, 10 * number as u64 + 1);
                let (slope, linear) = (slope(&found.remainders), linear_part(&found.remainders) / found.size);
                println!(
                    "{kind:?}, {name}, friction {friction}, {what}: slope {slope:.3}, linear part {linear:.1e}, {:?}, \
                     last remainder {:.1e} of {:.1e}",
                    found.counts,
                    found.remainders[STEPS.len() - 1],
                    found.value
                );
                assert!((slope - 2.0).abs() < 0.1, "{kind:?}, {name}, friction {friction}, {what}: slope {slope:.3}");
                assert!(linear.abs() < 1e-8, "{kind:?}, {name}, friction {friction}, {what}: {linear:.1e}");
                all.open += found.counts.open;
                all.stick += found.counts.stick;
                all.slip += found.counts.slip;
            }
        }
    }
    println!("{kind:?}: {all:?}");
    assert!(all.open > 20 && all.stick > 20 && all.slip > 20, "all statuses occur often: {all:?}");
}

#[test]
fn remainders_are_quadratic_on_hexahedra() {
    check(KINDS[0]);
}

#[test]
fn remainders_are_quadratic_on_tetrahedra() {
    check(KINDS[1]);
}

/// Taylor's formula notices what it must: the linear part of a derivative that is off by 1e-4.
#[test]
fn a_slightly_wrong_derivative_is_noticed() {
    let (_, obstacle) = obstacles().swap_remove(1);
    let (_, measure) = measures(0.0).swap_remove(1);
    let found = case(&pressed(CellKind::Hex8, obstacle, 0.3), &measure, 11);
    let wrong: Vec<f64> = found.remainders.iter().zip(STEPS).map(|(r, t)| r + 1e-4 * t * found.derivative).collect();
    let linear = linear_part(&wrong) / found.derivative;
    // The derivative itself is known to 1e-7 of its size, its remainders are of second order in steps of 1e-3.
    assert!((linear / 1e-4 - 1.0).abs() < 1e-2, "{linear:.2e}");
}
