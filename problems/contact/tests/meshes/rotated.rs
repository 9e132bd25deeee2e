//! Supports along normals: a turned body that oblique faces hold has the turned solution of the body along the axes.

use crate::elements::plus;
use crate::grid::{KINDS, Point, boxed, mesh};
use crate::setting::{PATHS, Rotation, difference, held, lattice_of, pushed, scene};
use contact::body::mesh::CellKind;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureMeasure, Quantity, Region};
use contact::scene::{CounterSurface, Held, Scene, Side, Support};
use contact::shape::Coordinates;
use nonsmooth::verify::seeded_direction;
use nonsmooth::{Accuracy, StateSolver, Vector};

const SIZE: Point = [10.0, 8.0, 6.0];
const ROUNDING: f64 = 1e-10;

/// Held along the normals of two sides that meet in an edge of the contact face, under a ball; turned by an angle, or
/// along the axes.
fn scene_of(kind: CellKind, friction: f64, angle: Option<f64>) -> Scene {
    let turn = Rotation::about(angle.unwrap_or(0.0));
    let map = boxed(SIZE);
    let mesh = mesh(kind, [3, 3, 2], 0.2, |place| turn.of(map(place)));
    let centre = turn.of([2.0, 1.0, SIZE[2] + 40.01]);
    let mut scene = scene(mesh, CounterSurface::Ball { centre, radius: 40.0, side: Side::Outside }, friction);
    let sides = ["x1-min", "x2-min"].map(str::to_owned);
    scene.bodies[0].supports = match angle {
        Some(_) => sides.map(|face| Support { face, held: Held::Normal(0.0) }).to_vec(),
        None => vec![held(&sides[0], [true, false, false]), held(&sides[1], [false, true, false])],
    };
    scene.bodies[0].loads =
        vec![pushed("bottom", turn.of([2.0, 1.0, 20.0])), pushed("x1-max", turn.of([-3.0, 1.0, 2.0]))];
    let edge = |axis: usize| turn.of(std::array::from_fn(|other| if other == axis { SIZE[axis] } else { 0.0 }));
    lattice_of(&mut scene).coordinates = Coordinates::Cartesian { corner: [0.0; 3], edges: std::array::from_fn(edge) };
    scene
}

struct Found {
    displacements: Vec<Point>,
    forces: Vec<Point>,
    value: f64,
    gradient: Vector,
}

fn solved(scene: &Scene, path: SolverKind, measure: &Quantity) -> Found {
    let shape = ContactShape::new(scene.clone(), path).unwrap();
    let objective = ContactObjective::new(shape, measure.clone(), &[]).unwrap();
    let controls = seeded_direction(scene.control_count(), 5) * 0.05;
    let states = objective.cases().solve(&controls, None, Accuracy::TIGHTEST).unwrap();
    let evaluation = objective.differentiate(&controls, &states).unwrap();
    let state = &states[0];
    let rows = state.rows.nodes.iter().zip(&state.forces.normal);
    // The force on the body along the free directions: λ_N P n + λ_T.
    let mut forces: Vec<Point> = rows.map(|(row, force)| row.directions[0].map(|n| force * n)).collect();
    for (force, tangential) in forces.iter_mut().zip(&state.forces.tangential) {
        *force = plus(*force, 1.0, *tangential);
    }
    let displacements = objective.solver().bodies(state).unwrap().remove(0).displacement;
    Found { displacements, forces, value: evaluation.value, gradient: evaluation.subgradient }
}

#[test]
fn supports_along_oblique_normals_hold_like_those_along_axes() {
    let measures = [
        Quantity::Pressure(PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Area }),
        Quantity::StressNorm { region: Region::WHOLE, exponent: 6.0 },
    ];
    for (kind, friction) in KINDS.into_iter().flat_map(|kind| [(kind, 0.0), (kind, 0.3)]) {
        for path in PATHS {
            for measure in &measures {
                let straight = solved(&scene_of(kind, friction, None), path, measure);
                let angle = 0.8;
                let found = solved(&scene_of(kind, friction, Some(angle)), path, measure);
                let turn = Rotation::about(angle);
                let turned = |vectors: &[Point]| vectors.iter().map(|x| turn.of(*x)).collect::<Vec<_>>();
                let displacements = difference(&found.displacements, &turned(&straight.displacements));
                let forces = difference(&found.forces, &turned(&straight.forces));
                let value = (found.value / straight.value - 1.0).abs();
                // Control points move along the edges of the lattice, which turn with the body.
                let gradient = (&found.gradient - &straight.gradient).norm() / straight.gradient.norm();
                println!(
                    "{kind:?}, {path:?}, friction {friction}: u {displacements:.1e}, forces {forces:.1e}, \
                     J {value:.1e}, gradient {gradient:.1e}"
                );
                let worst = displacements.max(forces).max(value).max(gradient);
                assert!(worst < ROUNDING, "{kind:?}, {path:?}, friction {friction}: {worst:.1e}");
            }
        }
    }
}
