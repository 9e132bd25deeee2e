//! Bodies with several contacts at random, by both solvers: wedges between two obstacles, blocks that are squeezed,
//! stacks; curved and inclined faces of both elements, shapes moved by 0.001 to 10 mm. A state is right or refused.
//! `CONTACT_SCENES` sets the number of scenes.

use crate::grid::{KINDS, Point, curved, mesh};
use crate::setting::{extent, held, lattice, material, pushed};
use contact::body::mesh::Mesh;
use contact::error::ContactError;
use contact::scene::{
    BodyFace, BodyScene, ContactScene, CounterSurface, Geometry, Load, LoadKind, Master, MeshGeometry, Scene, Side,
    Support,
};
use contact::solvers::{Processes, SolverKind, SolverPlan};
use rayon::prelude::*;
use testset::kit::Random;

/// Relative difference of Θ up to which two solvers agree.
const AGREED: f64 = 1e-6;
/// Share of the scenes with a state that each solver must solve. Of 1000 scenes, direct condensation solves 99.8 %, and
/// total FETI about 97 %: bodies that few contact nodes hold; the default solver goes on with the other one.
const SOLVED: f64 = 0.94;
/// Width, depth and height of the bodies, mm.
const SIZE: Point = [100.0, 80.0, 60.0];

/// What a solver makes of a scene.
#[derive(Debug)]
enum Outcome {
    /// Θ = Σ A σ⁴, and whether friction is so strong that there may be several states.
    State(f64, bool),
    /// No solver could do better: the shape or the loads are refused.
    Refused(String),
    Failed(String),
}

fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * random.unit()
}

/// A mesh with straight or curved edges.
fn random_mesh(random: &mut Random, map: impl Fn(Point) -> Point) -> Mesh {
    let (kind, boxes) = (KINDS[random.below(2)], std::array::from_fn(|_| 2 + random.below(3)));
    let distortion = between(random, 0.0, 0.2);
    if random.below(2) == 0 { mesh(kind, boxes, distortion, map) } else { curved(kind, boxes, distortion, map) }
}

/// A body in its lattice.
fn body(random: &mut Random, name: &str, mesh: Mesh) -> BodyScene {
    let (corner, size) = extent(mesh.nodes());
    let geometry = Geometry::Mesh(MeshGeometry { mesh: mesh.into(), pieces: Some(1 + random.below(4)) });
    let elastic = [10_f64.powf(between(random, 3.0, 5.3)), between(random, 0.0, 0.45)];
    let points = std::array::from_fn(|_| 2 + random.below(2));
    BodyScene { shape: Some(lattice(corner, size, points)), ..BodyScene::new(name, geometry, material(elastic)) }
}

/// An obstacle that touches a place, but for a gap, along a normal from the body into it.
fn obstacle(random: &mut Random, place: Point, normal: Point) -> CounterSurface {
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    let gap = between(random, -0.2, 0.2);
    let along = |way: f64| -> Point { std::array::from_fn(|axis| place[axis] + way * normal[axis] / length) };
    let radius = between(random, 120.0, 1000.0);
    match random.below(4) {
        0 => CounterSurface::Ball { centre: along(gap + radius), radius, side: Side::Outside },
        1 => CounterSurface::Ball { centre: along(gap - radius), radius, side: Side::Inside },
        2 => CounterSurface::cylinder(along(gap + radius), [0.0, 1.0, 0.0], radius, Side::Outside),
        _ => CounterSurface::TiltedPlane { point: along(gap), normal },
    }
}

fn force(random: &mut Random, main: Point) -> Load {
    let aside: Point = std::array::from_fn(|_| between(random, -0.15, 0.15));
    let size = 10_f64.powf(between(random, -4.0, -1.0));
    let force = std::array::from_fn(|axis| size * (main[axis] + aside[axis]));
    Load { place: None, kind: LoadKind::BodyForce(force) }
}

/// Supports of a side: across x₃, so that all but one motion is held; across one plane; or none.
fn supports(random: &mut Random, side: &str, plane: [bool; 3]) -> Vec<Support> {
    match random.below(4) {
        0 => vec![],
        1 => vec![held(side, plane)],
        _ => vec![held(side, [true, true, false])],
    }
}

/// A wedge that is pulled between two obstacles at its flanks, as the root of a blade.
fn wedge(random: &mut Random, friction: f64) -> Scene {
    let (slope, bulge) = (between(random, 0.15, 1.0), [0.0, between(random, -3.0, 3.0)][random.below(2)]);
    let half = |r: f64| 50.0 - slope * 30.0 * r + bulge * 4.0 * r * (1.0 - r);
    let mesh = random_mesh(random, |[s, t, r]| [(2.0 * s - 1.0) * half(r), SIZE[1] * t, SIZE[2] * r]);
    let mut body = body(random, "wedge", mesh);
    body.supports = supports(random, "x2-min", [false, true, false]);
    body.loads = vec![force(random, [0.0, 0.0, 1.0])];
    if random.below(2) == 0 {
        body.loads.push(pushed("top", [0.0, 0.0, between(random, 0.1, 10.0)]));
    }
    let side = |random: &mut Random, name: &str, sign: f64| {
        let obstacle = obstacle(random, [sign * half(0.5), 0.5 * SIZE[1], 0.5 * SIZE[2]], [sign, 0.0, 0.5 * slope]);
        ContactScene::new(BodyFace::new(0, name), Master::Obstacle(obstacle), friction)
    };
    let contacts = vec![side(random, "x1-min", -1.0), side(random, "x1-max", 1.0)];
    Scene { name: "wedge".into(), bodies: vec![body], contacts }
}

/// A block with a curved bottom or top between two obstacles.
fn squeezed(random: &mut Random, friction: f64) -> Scene {
    let [low, high] = [between(random, -2.0, 2.0), between(random, -2.0, 2.0)];
    let hump = |s: f64| 4.0 * s * (1.0 - s);
    let map = |[s, t, r]: Point| {
        let (bottom, top) = (low * hump(s), SIZE[2] + high * hump(s) * hump(t));
        [SIZE[0] * (s - 0.5), SIZE[1] * t, bottom + (top - bottom) * r]
    };
    let mesh = random_mesh(random, map);
    let mut body = body(random, "block", mesh);
    body.supports = supports(random, "x1-min", [true, false, false]);
    let sign = [-1.0, 1.0][random.below(2)];
    body.loads = vec![force(random, [0.0, 0.0, sign])];
    let contact = |random: &mut Random, name: &str, place: Point, way: f64| {
        let tilt = between(random, -0.05, 0.05);
        let obstacle = obstacle(random, place, [tilt, 0.0, way]);
        ContactScene::new(BodyFace::new(0, name), Master::Obstacle(obstacle), friction)
    };
    let contacts = vec![
        contact(random, "bottom", [0.0, 0.5 * SIZE[1], low], -1.0),
        contact(random, "top", [0.0, 0.5 * SIZE[1], SIZE[2] + high], 1.0),
    ];
    Scene { name: "squeezed".into(), bodies: vec![body], contacts }
}

/// A block on an obstacle with another one on it.
fn stack(random: &mut Random, friction: f64) -> Scene {
    let tilt = between(random, -0.1, 0.1);
    let level = |s: f64| SIZE[2] + tilt * SIZE[0] * (s - 0.5);
    let lower = random_mesh(random, |[s, t, r]| [SIZE[0] * (s - 0.5), SIZE[1] * t, level(s) * r]);
    let upper = random_mesh(random, |[s, t, r]| [SIZE[0] * (s - 0.5), SIZE[1] * t, level(s) + (130.0 - level(s)) * r]);
    let (mut lower, mut upper) = (body(random, "lower", lower), body(random, "upper", upper));
    upper.shape = None;
    lower.supports = supports(random, "x2-min", [false, true, false]);
    upper.supports = supports(random, "x1-min", [true, false, false]);
    upper.loads = vec![pushed("top", [0.0, between(random, -0.1, 0.1), -between(random, 0.1, 20.0)])];
    let ground = obstacle(random, [0.0, 0.5 * SIZE[1], 0.0], [0.0, 0.0, -1.0]);
    let master = Master::Body(BodyFace::new(1, "bottom"));
    let contacts = vec![
        ContactScene::new(BodyFace::new(0, "bottom"), Master::Obstacle(ground), friction),
        ContactScene::new(BodyFace::new(0, "top"), master, friction),
    ];
    Scene { name: "stack".into(), bodies: vec![lower, upper], contacts }
}

/// The scene of a number, with the controls of a shape.
fn scene(number: u64) -> (Scene, Vec<f64>) {
    let random = &mut Random(number.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let friction = [0.0, between(random, 0.0, 0.8)][random.below(4).min(1)];
    let scene = [wedge, squeezed, stack][random.below(3)](random, friction);
    let moved = 10_f64.powf(between(random, -3.0, 1.0));
    // Towards the obstacles, away from them, or wavy.
    let [mean, wave] = [[0.5, 0.5], [-0.5, 0.5], [0.0, 1.0]][random.below(3)];
    let controls = (0..scene.control_count()).map(|_| moved * (mean + wave * random.signed())).collect();
    (scene, controls)
}

fn outcome(scene: &Scene, controls: &[f64], kind: SolverKind) -> Outcome {
    let solved = || -> Result<(f64, bool), ContactError> {
        let plan = SolverPlan::new(scene.clone(), kind);
        let solver = Processes::alone().solver(plan).expect("a solver");
        let state = solver.solve(controls, None, 1e-10)?;
        let pressures = state.rows.pressures(&state.forces.normal);
        let nodes = pressures.iter().zip(state.rows.contact_nodes());
        let objective = nodes.map(|(pressure, node)| node.area * pressure.max(0.0).powi(4)).sum();
        let contraction = if scene.has_friction() { solver.estimate_contraction(&state.solution, 50)? } else { 0.0 };
        Ok((objective, contraction >= 1.0))
    };
    match solved() {
        Ok((objective, many)) => Outcome::State(objective, many),
        Err(error) if error.ends_the_search() => Outcome::Refused(error.kind()),
        Err(error) => Outcome::Failed(error.to_string()),
    }
}

#[test]
fn both_solvers_agree_on_several_contacts_or_say_why_not() {
    let count: u64 = std::env::var("CONTACT_SCENES").map_or(100, |count| count.parse().expect("a number of scenes"));
    let kinds = [SolverKind::Direct, SolverKind::Newton];
    let examined = |number: u64| {
        let (scene, controls) = scene(number);
        (number, scene.name.clone(), kinds.map(|kind| outcome(&scene, &controls, kind)))
    };
    let outcomes: Vec<_> = (0..count).into_par_iter().map(examined).collect();
    let (mut apart, mut several, mut refused) = (Vec::new(), 0, std::collections::BTreeMap::<String, usize>::new());
    let (mut solvable, mut solved) = (0, [0; 2]);
    for (number, name, both) in &outcomes {
        if let [Outcome::State(a, first), Outcome::State(b, second)] = both {
            let difference = (a - b).abs() / a.max(*b).max(f64::MIN_POSITIVE);
            if difference > AGREED && !first && !second {
                apart.push(format!("{number} ({name}): {a:e}, {b:e}, {difference:.1e}"));
            }
            several += usize::from(difference > AGREED && (*first || *second));
        }
        if let Some(Outcome::Refused(kind)) = both.iter().find(|found| matches!(found, Outcome::Refused(_))) {
            *refused.entry(kind.clone()).or_default() += 1;
            continue;
        }
        solvable += 1;
        for (found, solved) in both.iter().zip(&mut solved) {
            match found {
                Outcome::State(..) => *solved += 1,
                Outcome::Failed(reason) => println!("{number} ({name}): {reason}"),
                Outcome::Refused(_) => {}
            }
        }
    }
    println!(
        "{count} scenes, refused {refused:?}; of {solvable}: direct {}, newton {}; several states {several}; apart {apart:#?}",
        solved[0], solved[1]
    );
    assert!(apart.is_empty(), "{apart:#?}");
    assert!(2 * solvable > count as usize, "{solvable} of {count}");
    assert!(solved.iter().all(|&solved| solved as f64 >= SOLVED * solvable as f64), "{solved:?} of {solvable}");
}
