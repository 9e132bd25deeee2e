//! Small bodies at random: total FETI and direct condensation agree, and their states satisfy equilibrium, Signorini's
//! conditions and Coulomb's law as the tests compute them.

use crate::elements::{cross, plus};
use crate::grid::{KINDS, Point, boxed, curved, mesh, sector, shell};
use crate::law::violation;
use crate::setting::{PATHS, difference, extent, held, lattice, lattice_of, material, pushed, scene};
use contact::body::mesh::Mesh;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, ContactState};
use contact::cost::{NodeWeight, PressureMeasure, Quantity};
use contact::scene::{CounterSurface, Geometry, Load, LoadKind, Scene, Side};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{Accuracy, NonsmoothObjective, Request, StateSolver, Vector};
use proptest::prelude::*;

/// What both paths may differ by, relative to the largest force or displacement: rounding times the condition number of
/// these small bodies.
const ROUNDING: f64 = 1e-9;
/// What gradients may differ by: total FETI ends its adjoint at a relative residual of 1e-11.
const OF_SLOPES: f64 = 1e-8;

/// A box, a part of a cylinder, a part of a shell with curved edges or straight ones; all about 10 mm wide. And the
/// place on their top that is nearest to the obstacle.
fn body(shape: usize, kind: usize, boxes: [usize; 3], distortion: f64) -> (Mesh, Point) {
    let kind = KINDS[kind];
    match shape {
        0 => (mesh(kind, boxes, distortion, boxed([10.0, 8.0, 5.0])), [5.0, 4.0, 5.0]),
        1 => (curved(kind, boxes, distortion, sector([6.0, 10.0], 1.1, 7.0)), [0.0, 3.5, 10.0]),
        2 => (curved(kind, boxes, distortion, shell([5.0, 9.0], 1.0)), [0.0, 0.0, 9.0]),
        _ => (mesh(kind, boxes, distortion, shell([5.0, 9.0], 1.0)), [0.0, 0.0, 9.0]),
    }
}

/// How deep the body lies in the obstacle before it is deformed: more than a shape changes, so that they touch.
const OVERLAP: f64 = 0.4;

/// An obstacle above a place of the body, along a tilted normal.
fn obstacle(form: usize, place: Point, [a, b]: [f64; 2], radius: f64) -> CounterSurface {
    let normal = [a, b, 1.0].map(|entry| entry / (1.0 + a * a + b * b).sqrt());
    let along = |length: f64| plus(place, length, normal);
    match form {
        0 => CounterSurface::TiltedPlane { point: along(-OVERLAP), normal: [a, b, 1.0] },
        1 => CounterSurface::Ball { centre: along(radius - OVERLAP), radius, side: Side::Outside },
        2 => CounterSurface::Ball { centre: along(-radius - OVERLAP), radius, side: Side::Inside },
        3 => {
            // An axis across the normal.
            let (point, axis) = (along(radius - OVERLAP), cross(normal, [-0.4, 1.0, 0.1]));
            CounterSurface::cylinder(point, axis, radius, Side::Outside)
        }
        _ => CounterSurface::Waves { base: place[2] - OVERLAP, first: a, second: b, period: 17.0, origin: [0.0; 2] },
    }
}

/// How a body is held and pushed.
#[derive(Debug, Clone)]
enum Grip {
    /// Its bottom is held, and a force per volume drives it up.
    Bottom,
    /// Its near side is held across x₃ alone, and a traction on a far side drives it up: rigid motions are left to
    /// contact, and nodes on the edge of the contact face have cut rows.
    Side,
}

#[derive(Debug, Clone)]
struct Case {
    shape: usize,
    kind: usize,
    boxes: [usize; 3],
    pieces: usize,
    distortion: f64,
    form: usize,
    tilt: [f64; 2],
    radius: f64,
    poisson_ratio: f64,
    friction: f64,
    push: [f64; 2],
    grip: Grip,
    seed: u64,
}

fn cases() -> impl Strategy<Value = Case> {
    let body = (0..4_usize, 0..2_usize, [2..6_usize, 2..5_usize, 1..4_usize], 0.0..0.25_f64, 1..6_usize);
    let obstacle = (0..5_usize, [-0.1..0.1_f64, -0.1..0.1_f64], 15.0..60.0_f64);
    let rest = (0.0..0.45_f64, prop_oneof![1 => Just(0.0), 2 => 0.05..1.0_f64], [-0.3..0.3_f64, -0.3..0.3_f64]);
    let grip = prop_oneof![2 => Just(Grip::Bottom), 1 => Just(Grip::Side)];
    (body, obstacle, rest, grip, any::<u64>()).prop_map(|(body, obstacle, rest, grip, seed)| Case {
        shape: body.0,
        kind: body.1,
        boxes: body.2,
        distortion: body.3,
        pieces: body.4,
        form: obstacle.0,
        tilt: obstacle.1,
        radius: obstacle.2,
        poisson_ratio: rest.0,
        friction: rest.1,
        push: rest.2,
        grip,
        seed,
    })
}

fn scene_of(case: &Case) -> Scene {
    let (mesh, place) = body(case.shape, case.kind, case.boxes, case.distortion);
    let (corner, size) = extent(mesh.nodes());
    let obstacle = obstacle(case.form, place, case.tilt, case.radius);
    let mut scene = scene(mesh, obstacle, case.friction);
    scene.bodies[0].material = material([1000.0, case.poisson_ratio]);
    if let Geometry::Mesh(geometry) = &mut scene.bodies[0].geometry {
        geometry.pieces = Some(case.pieces);
    }
    let [a, b] = case.push;
    match case.grip {
        Grip::Bottom => {
            let force = [4.0 * a, 4.0 * b, 4.0];
            scene.bodies[0].supports = vec![held("bottom", [true; 3])];
            scene.bodies[0].loads = vec![Load { place: None, kind: LoadKind::BodyForce(force) }];
        }
        Grip::Side => {
            scene.bodies[0].supports = vec![held("x1-min", [true, true, false])];
            let force = [a, b, 2.0];
            scene.bodies[0].loads = vec![Load { place: None, kind: LoadKind::BodyForce(force) }];
            // Sides of curved bodies are flat only where the map has planes: those of the box.
            if case.shape == 0 {
                scene.bodies[0].loads.push(pushed("bottom", [a, b, 5.0]));
            }
        }
    }
    // The lattice leaves the bottom as it is: its tractions are those of flat faces.
    let middle = [corner[0], corner[1], corner[2] + 0.4 * size[2]];
    let lattice_of = lattice_of(&mut scene);
    *lattice_of = lattice(middle, [size[0], size[1], 0.6 * size[2]], [2; 3]);
    // The first layer stays, so that the shape is continuous.
    lattice_of.frozen[2] = [1, 0];
    scene
}

/// The gradient of a pressure norm.
fn gradient(shape: ContactShape, controls: &Vector) -> Vector {
    let norm = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Area };
    let objective = ContactObjective::new(shape, Quantity::Pressure(norm), &[]).unwrap();
    objective.evaluate(&Request::tight(controls)).unwrap().into_evaluation().subgradient
}

fn check(case: &Case) -> Result<(), TestCaseError> {
    let scene = scene_of(case);
    let controls = seeded_direction(scene.control_count(), case.seed) * 0.1;
    let mut states = Vec::new();
    for path in PATHS {
        let shape = ContactShape::new(scene.clone(), path).unwrap();
        let state = shape.solve(&controls, None, Accuracy::TIGHTEST);
        let state = state.map_err(|error| TestCaseError::fail(format!("{path:?}: {error}")))?;
        let found = violation(&shape, &state);
        println!(
            "shape {}, {:?}, {:?}, obstacle {}, friction {:.2}, {:?}, {path:?}: {:.0e}, {:?}",
            case.shape,
            KINDS[case.kind],
            case.boxes,
            case.form,
            case.friction,
            case.grip,
            found.largest(),
            state.forces.counts()
        );
        prop_assert!(found.largest() < ROUNDING, "{path:?}: {found:?}");
        prop_assert!(state.forces.total_normal_force() > 0.0);
        let displacement = shape.bodies(&state).unwrap().remove(0).displacement;
        let gradient = gradient(shape, &controls);
        states.push((state, displacement, gradient));
    }
    let [(torn, u, slope), (direct, v, own_slope)] = &states[..] else { unreachable!("two paths") };
    let normal =
        |state: &ContactState| -> Vec<Point> { state.forces.normal.iter().map(|force| [*force, 0.0, 0.0]).collect() };
    let forces = difference(&normal(torn), &normal(direct));
    let displacements = difference(u, v);
    prop_assert!(forces < ROUNDING && displacements < ROUNDING, "{forces:.1e} {displacements:.1e}");
    if case.friction > 0.0 {
        let pairs = torn.forces.tangential.iter().zip(&direct.forces.tangential).flat_map(|(a, b)| a.iter().zip(b));
        let largest = direct.forces.normal.iter().copied().fold(0.0, f64::max);
        let friction = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
        prop_assert!(friction < ROUNDING, "{friction:.1e}");
    }
    prop_assert_eq!(&torn.forces.status, &direct.forces.status);
    let slopes = (slope - own_slope).norm() / own_slope.norm();
    prop_assert!(slopes < OF_SLOPES, "{slopes:.1e}");
    Ok(())
}

/// Number of scenes: 24, or what MESH_SCENES says.
fn count() -> u32 {
    std::env::var("MESH_SCENES").map_or(24, |count| count.parse().expect("MESH_SCENES is a number"))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: count(), ..ProptestConfig::default() })]

    #[test]
    fn both_paths_satisfy_the_equations(case in cases()) {
        check(&case)?;
    }
}
