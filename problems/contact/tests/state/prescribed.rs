//! Displacements that supports prescribe: closed forms, two solvers, units, conflicts.

use crate::common::change_counter_surface;
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, ContactState, SolverKind};
use contact::equilibrium::ContactProblem;
use contact::friction_problem::{FrictionProblem, ROWS};
use contact::scene::{CounterSurface, Held, NormalKind, Scene, Support, hertz, signorini};
use nonsmooth::{Accuracy, StateSolver, Vector};

/// A support with these values of its components.
fn moved(face: BlockFace, values: [Option<f64>; 3]) -> Support {
    Support { face: face.name().into(), held: Held::Components(values) }
}

fn solve(scene: &Scene, kind: SolverKind) -> (ContactShape, ContactState) {
    let shape = ContactShape::new(scene.clone(), kind).unwrap();
    let mut controls = shape.start();
    let count = controls.len();
    controls.iter_mut().enumerate().for_each(|(k, height)| *height *= 1.0 - 0.002 * ((k % count) as f64).sin().abs());
    let state = shape.solve(&controls, None, Accuracy::TIGHTEST).unwrap();
    (shape, state)
}

/// The Hertz example, pressed by its top instead of by loads.
fn pressed_hertz(friction: f64) -> Scene {
    let mut scene = hertz().unwrap().with_bricks([4; 3], [2; 3]).with_friction(friction);
    let upper = &mut scene.bodies[1];
    upper.loads.clear();
    upper.supports.push(moved(BlockFace::Top, [None, None, Some(-0.05)]));
    scene
}

/// The wavy obstacle, with the block pushed into it and along it by its bottom.
fn pushed_signorini(friction: f64) -> Scene {
    let mut scene = signorini().unwrap().with_bricks([6; 3], [2; 3]).with_friction(friction);
    scene.bodies[0].loads.clear();
    scene.bodies[0].supports = vec![moved(BlockFace::Bottom, [Some(0.4), Some(-0.2), Some(2.5)])];
    scene
}

/// A bar without lateral strain, free to slide, pressed by its foot against a plane at a gap.
fn bar(displacement: f64, gap: f64) -> Scene {
    let mut scene = signorini().unwrap().with_bricks([3, 3, 4], [1, 1, 2]).with_friction(0.0);
    scene.bodies[0].material = Material::new(1.1e5, 0.0).unwrap();
    scene.bodies[0].loads.clear();
    scene.bodies[0].supports = vec![
        moved(BlockFace::X1Min, [Some(0.0), Some(0.0), None]),
        moved(BlockFace::Bottom, [None, None, Some(displacement)]),
    ];
    change_counter_surface(&mut scene, |_| CounterSurface::Plane { height: 100.0 + gap });
    scene
}

/// λ_N = E (u₃ − gap)/h · A, and no force where the gap does not close: exact for ν = 0.
#[test]
fn a_bar_pressed_by_its_foot_has_the_pressure_of_its_shortening() {
    for kind in [SolverKind::Newton, SolverKind::Direct, SolverKind::AugmentedLagrangian] {
        for (displacement, gap) in [(0.3, 0.1), (0.3, 0.0), (0.05, 0.1), (-0.2, 0.0), (20.0, 19.9)] {
            let shape = ContactShape::new(bar(displacement, gap), kind).unwrap();
            let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
            let exact = 1.1e5 * (displacement - gap).max(0.0) / 100.0;
            for pressure in state.rows.pressures(&state.forces.normal) {
                let error = (pressure - exact).abs();
                let scale = 1.1e5 * displacement.abs() / 100.0;
                assert!(error < 1e-9 * scale, "{kind:?}, u3 = {displacement}, gap {gap}: {pressure}, exact {exact}");
            }
            let top = shape.fields(&state).unwrap().bodies[0].displacement.clone();
            let positions = shape.problem().start_positions();
            for (u, x) in top.iter().zip(positions[0].iter()) {
                let exact = displacement - (displacement - gap).max(0.0) * x[2] / 100.0;
                assert!((u[2] - exact).abs() < 1e-9 * displacement.abs(), "{kind:?}: {} {exact}", u[2]);
            }
        }
    }
}

fn assert_same(a: &ContactState, b: &ContactState, words: &str) {
    let size = a.forces.total_normal_force();
    assert!(size > 0.0, "{words}: no contact");
    assert_eq!(a.forces.status, b.forces.status, "{words}");
    for (one, other) in a.forces.normal.iter().zip(&b.forces.normal) {
        assert!((one - other).abs() < 1e-9 * size, "{words}: {one} {other} of {size}");
    }
    for (one, other) in a.forces.tangential.iter().flatten().zip(b.forces.tangential.iter().flatten()) {
        assert!((one - other).abs() < 1e-9 * size, "{words}: {one} {other} of {size}");
    }
}

fn scenes() -> Vec<(&'static str, Scene)> {
    let mut tilted = pushed_signorini(0.3);
    tilted.contacts[0].normal = NormalKind::Surface;
    let mut loaded = pressed_hertz(0.3);
    loaded.bodies[1].loads = hertz().unwrap().bodies[1].loads[1..].to_vec();
    // The lower nodes of the edge are held where the upper ones are free.
    let mut lower = pressed_hertz(0.3);
    lower.bodies[0].supports[2] = moved(BlockFace::Bottom, [None, None, Some(0.02)]);
    lower.bodies[1].supports[2] = moved(BlockFace::Top, [Some(0.03), Some(0.01), Some(-0.02)]);
    lower.bodies[1].supports.drain(..2);
    lower.bodies[0].supports.push(moved(BlockFace::X2Max, [Some(0.01), None, None]));
    lower.bodies[0].supports.remove(0);
    vec![
        ("hertz", pressed_hertz(0.0)),
        ("hertz with friction", pressed_hertz(0.3)),
        ("signorini", pushed_signorini(0.0)),
        ("signorini with friction", pushed_signorini(0.3)),
        ("signorini by normals", tilted),
        ("hertz with loads", loaded),
        ("both bodies of hertz", lower),
    ]
}

#[test]
fn both_solvers_find_one_state_with_all_its_displacements() {
    for (words, scene) in scenes() {
        let [(torn_shape, torn), (direct_shape, direct)] =
            [SolverKind::Newton, SolverKind::Direct].map(|kind| solve(&scene, kind));
        assert_same(&torn, &direct, words);
        let [torn, direct] =
            [(torn_shape, torn), (direct_shape, direct)].map(|(shape, state)| shape.fields(&state).unwrap().bodies);
        for (one, other) in torn.iter().zip(&direct) {
            for (one, other) in one.displacement.iter().flatten().zip(other.displacement.iter().flatten()) {
                assert!((one - other).abs() < 1e-8, "{words}: {one} {other}");
            }
        }
    }
}

#[test]
fn forces_scale_with_the_modulus_and_not_with_anything_else() {
    for (words, scene) in
        scenes().into_iter().filter(|(_, scene)| scene.bodies.iter().all(|body| body.loads.is_empty()))
    {
        for kind in [SolverKind::Newton, SolverKind::Direct] {
            let (_, one) = solve(&scene, kind);
            for factor in [1e-9, 1e9] {
                let mut other = scene.clone();
                for body in &mut other.bodies {
                    let material = body.material;
                    body.material = Material::new(factor * material.young_modulus(), material.poisson_ratio()).unwrap();
                }
                let (_, mut state) = solve(&other, kind);
                state.forces.normal.iter_mut().for_each(|force| *force /= factor);
                state.forces.tangential.iter_mut().flatten().for_each(|force| *force /= factor);
                assert_same(&one, &state, words);
            }
        }
    }
}

/// A body that its support carries as a whole stays undeformed, and one that does not move at all is at rest.
#[test]
fn a_body_carried_away_has_no_forces() {
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        for lift in [-3.0, 0.0] {
            let mut scene = bar(lift, 0.5);
            scene.bodies[0].supports[1] = moved(BlockFace::Bottom, [Some(0.0), Some(0.0), Some(lift)]);
            scene.bodies[0].supports.remove(0);
            let (shape, state) = solve(&scene, kind);
            assert_eq!(state.forces.total_normal_force(), 0.0, "{kind:?}");
            assert_eq!(state.load > 0.0, lift != 0.0, "{kind:?}");
            for u in &shape.fields(&state).unwrap().bodies[0].displacement {
                assert!(u[0].abs().max(u[1].abs()).max((u[2] - lift).abs()) < 1e-11, "{kind:?}: {u:?}");
            }
        }
    }
}

#[test]
fn supports_that_contradict_each_other_are_refused() {
    let mut scene = pressed_hertz(0.0);
    scene.bodies[0].supports[2] = moved(BlockFace::Bottom, [Some(0.1), None, Some(0.0)]);
    let error = ContactProblem::new(scene.clone()).unwrap_err().to_string();
    assert!(error.contains("lower.supports[2]") && error.contains("lower.supports[0]"), "{error}");
    scene.bodies[0].supports[0] = moved(BlockFace::X1Min, [Some(0.1), None, None]);
    ContactProblem::new(scene.clone()).unwrap();
    // −u₁ along the outward normal of the face x1-min.
    let normal = |value: f64| Support { face: BlockFace::X1Min.name().into(), held: Held::Normal(value) };
    scene.bodies[0].supports.push(normal(-0.1));
    ContactProblem::new(scene.clone()).unwrap();
    scene.bodies[0].supports[3] = normal(0.1);
    let error = ContactProblem::new(scene.clone()).unwrap_err().to_string();
    assert!(error.contains("lower.supports[3]") && error.contains("lower.supports[0]"), "{error}");
    scene.bodies[0].supports[3] = normal(f64::NAN);
    let error = ContactProblem::new(scene).unwrap_err().to_string();
    assert!(error.contains("lower.supports[3]") && error.contains("finite"), "{error}");
}

/// Friction at a node that a support drags along the obstacle would be no unknown.
#[test]
fn nodes_dragged_along_with_friction_are_refused() {
    let mut scene = pushed_signorini(0.0);
    scene.bodies[0].supports.push(moved(BlockFace::X1Min, [Some(0.4), None, None]));
    ContactProblem::new(scene.clone()).unwrap();
    let error = ContactProblem::new(scene.with_friction(0.3)).unwrap_err().to_string();
    assert!(error.starts_with("contact[0].friction") && error.contains("contact node"), "{error}");
}

/// Dragged along waves, a node meets another height: gaps by surface normals follow.
#[test]
fn a_body_dragged_along_a_slope_meets_it_where_both_solvers_say() {
    let mut scene = bar(0.0, 0.0);
    scene.bodies[0].supports = vec![
        moved(BlockFace::X1Min, [Some(0.5), Some(0.0), None]),
        moved(BlockFace::X1Max, [Some(0.5), None, None]),
        moved(BlockFace::Bottom, [None, None, Some(0.0)]),
    ];
    scene.contacts[0].normal = NormalKind::Surface;
    change_counter_surface(&mut scene, |_| CounterSurface::TiltedPlane {
        point: [0.0, 0.0, 100.0],
        normal: [0.1, 0.0, 1.0],
    });
    let [(_, torn), (_, direct)] = [SolverKind::Newton, SolverKind::Direct].map(|kind| solve(&scene, kind));
    assert_same(&torn, &direct, "tilted");
}

/// The exported matrices know of prescribed displacements: solved states satisfy their equations.
#[test]
fn exported_matrices_hold_for_the_solved_state() {
    for (words, scene) in scenes() {
        let shape = ContactShape::new(scene, SolverKind::Direct).unwrap();
        let controls: Vector = shape.start();
        let state = shape.solve(&controls, None, Accuracy::TIGHTEST).unwrap();
        let bodies = shape.fields(&state).unwrap().bodies;
        let problem = FrictionProblem::new(shape.problem(), controls.as_slice()).unwrap();
        let u: Vec<f64> =
            problem.unknowns.iter().map(|&[body, node, axis]| bodies[body].displacement[node][axis]).collect();
        let mut rest: Vec<f64> = problem.load.iter().map(|force| -force).collect();
        for &(row, column, value) in &problem.stiffness {
            rest[row] += value * u[column];
            if row != column {
                rest[column] += value * u[row];
            }
        }
        let along = |node: usize, vector: [f64; 3], row: usize| -> f64 {
            let direction = state.rows.nodes[node].directions.get(row).copied().unwrap_or_default();
            (0..3).map(|axis| direction[axis] * vector[axis]).sum()
        };
        let count = problem.gaps.len();
        let mut jumps = vec![0.0; ROWS * count];
        for &(row, column, value) in &problem.contact {
            let (node, part) = (row / ROWS, row % ROWS);
            let tangential = state.forces.tangential.get(node).copied().unwrap_or_default();
            let force = if part == 0 { state.forces.normal[node] } else { along(node, tangential, part) };
            rest[column] -= value * force;
            jumps[row] += value * u[column];
        }
        let total = state.forces.total_normal_force();
        let worst = rest.iter().fold(0.0, |worst: f64, entry| worst.max(entry.abs()));
        assert!(worst < 1e-9 * total, "{words}: {worst} N of {total} N");
        for node in 0..count {
            let normal = jumps[ROWS * node] + problem.gaps[node] + state.forces.opening[node];
            assert!(normal.abs() < 1e-11, "{words}: {normal}");
            for part in (1..state.rows.nodes[node].directions.len()).filter(|_| !state.forces.slip.is_empty()) {
                let slip = along(node, state.forces.slip[node], part);
                let w = jumps[ROWS * node + part] + problem.slips[node][part - 1];
                assert!((w + slip).abs() < 1e-11, "{words}: {w} {slip}");
            }
        }
    }
}
