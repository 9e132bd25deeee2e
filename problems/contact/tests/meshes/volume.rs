//! The limit of the relative volume: its value is that of the tests' own elements, its gradient passes Taylor's test.

use crate::elements;
use crate::grid::{KINDS, boxed, curved, mesh, shell};
use crate::setting::{held, pushed, scene};
use contact::body::mesh::Mesh;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{Limit, LimitSide, NodeWeight, PressureMeasure, Quantity};
use contact::scene::CounterSurface;
use nonsmooth::verify::seeded_direction;
use nonsmooth::{ConstraintEvaluation, ConstraintKind, NonsmoothObjective, Request, Vector};

fn objective(mesh: Mesh, top: f64, limits: &[Limit]) -> ContactObjective {
    let plane = CounterSurface::TiltedPlane { point: [0.0, 0.0, top], normal: [0.0, 0.0, 1.0] };
    let mut scene = scene(mesh, plane, 0.0);
    scene.bodies[0].supports = vec![held("bottom", [true; 3])];
    scene.bodies[0].loads = vec![pushed("x1-max", [-1.0, 0.0, 1.0])];
    let shape = ContactShape::new(scene, SolverKind::Direct).unwrap();
    let norm = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Area };
    ContactObjective::new(shape, Quantity::Pressure(norm), limits).unwrap()
}

fn constraints(objective: &ContactObjective, at: &Vector) -> ConstraintEvaluation {
    objective.evaluate(&Request::tight(at)).unwrap().into_evaluation().constraints.unwrap()
}

/// Volume over that of the start, by other elements.
fn relative_volume(objective: &ContactObjective, at: &Vector) -> f64 {
    let problem = objective.solver().problem();
    let volume = |positions: &[[f64; 3]]| elements::volume(&problem.bodies[0].mesh, positions);
    volume(&problem.map.positions(at.as_slice())[0]) / volume(problem.bodies[0].mesh.nodes())
}

/// Steps in units of the direction, whose entries are up to 1 mm.
const STEPS: [f64; 4] = [0.08, 0.04, 0.02, 0.01];

fn check(objective: &ContactObjective, name: &str) {
    let count = objective.dimension();
    let (at, direction) = (seeded_direction(count, 3) * 0.3, seeded_direction(count, 4));
    let here = constraints(objective, &at);
    let volume = relative_volume(objective, &at);
    let errors = [here.values[1] - (volume - 1.1), here.values[2] - (0.9 - volume)];
    assert!(errors.iter().all(|error| error.abs() < 1e-13), "{name}: {errors:?}");
    let along = |row: usize| here.jacobian.row(row).transpose().dot(&direction);
    let derivative = along(1);
    assert!((along(2) + derivative).abs() < 1e-15 * derivative.abs(), "{name}");
    let remainder =
        |step: f64| constraints(objective, &(&at + &direction * step)).values[1] - here.values[1] - step * derivative;
    let remainders = STEPS.map(remainder);
    let slopes: Vec<f64> = remainders.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    // The volume is cubic in the controls: r = e t + h t² + k t³, q(t) = 4 r(t/2) − r(t) = e t − k t³/2, and
    // 8 q(t/2) − q(t) = 3 e t is what a wrong derivative leaves.
    let [_, r0, r1, r2] = remainders;
    let linear = (8.0 * (4.0 * r2 - r1) - (4.0 * r1 - r0)) / (3.0 * STEPS[1]) / derivative;
    println!("{name}: slopes {slopes:.3?}, linear part {linear:.1e}");
    assert!(slopes.iter().all(|slope| (slope - 2.0).abs() < 0.1), "{name}: {slopes:?}");
    assert!(linear.abs() < 1e-11, "{name}: {linear:.1e}");
}

#[test]
fn the_limit_of_the_volume_has_its_value_and_its_gradient() {
    let limit = Limit::new;
    let limits = [
        limit(Quantity::RelativeVolume, LimitSide::Equal, 1.1),
        limit(Quantity::RelativeVolume, LimitSide::AtLeast, 0.9),
        limit(Quantity::Pressure(PressureMeasure::Peak), LimitSide::AtMost, 100.0),
    ];
    for kind in KINDS {
        let bodies = [
            ("box", mesh(kind, [3, 3, 2], 0.2, boxed([10.0, 8.0, 5.0])), 5.01),
            ("shell", curved(kind, [3, 3, 2], 0.2, shell([5.0, 9.0], 1.0)), 9.01),
        ];
        for (name, mesh, top) in bodies {
            let objective = objective(mesh, top, &limits);
            // Constraints of the pressure come first, whatever their order was.
            let kinds = [ConstraintKind::Nonsmooth, ConstraintKind::SmoothEquality, ConstraintKind::Smooth];
            assert_eq!(objective.constraint_kinds(), kinds);
            check(&objective, &format!("{kind:?}, {name}"));
        }
    }
}
