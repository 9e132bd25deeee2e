//! Bodies that only friction could hold: where contact cannot build up normal forces, the refusal has a proof.

use crate::common::{change_counter_surface, set_upper_block};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::direct::{DirectSolver, resistance};
use contact::equilibrium::ContactProblem;
use contact::error::ContactError;
use contact::scene::{CounterSurface, Load, Scene, Support, signorini};
use nonsmooth::{Accuracy, OracleError, StateSolver, Vector};
use proptest::prelude::*;
use std::sync::Arc;

/// A block of 100 mm whose bottom is held along x₃ only, beneath an obstacle, pushed at one side.
fn pushed(bricks: usize, friction: f64, ratio: f64, obstacle: CounterSurface, traction: [f64; 3]) -> Scene {
    let mut scene = signorini().unwrap();
    change_counter_surface(&mut scene, |_| obstacle.clone());
    let body = &mut scene.bodies[0];
    body.material = Material::new(1e4, ratio).unwrap();
    body.supports = vec![Support::new(BlockFace::Bottom, [false, false, true])];
    body.loads = vec![Load::traction(BlockFace::X1Max, traction)];
    scene.with_bricks([bricks; 3], [1; 3]).with_friction(friction)
}

/// The obstacle as a second body, which holds the first one.
fn between_bodies(mut scene: Scene) -> Scene {
    let (material, supports) = (scene.bodies[0].material, vec![Support::new(BlockFace::Top, [true; 3])]);
    set_upper_block(&mut scene, 200.0, material, supports, vec![]);
    scene
}

fn sphere(penetration: f64) -> CounterSurface {
    CounterSurface::Sphere { apex: 100.0 - penetration, radius: 2000.0, centre: [50.0, 50.0] }
}

fn waves(penetration: f64) -> CounterSurface {
    CounterSurface::Waves { base: 100.4 - penetration, first: 0.2, second: 0.2, period: 70.0, origin: [0.0; 2] }
}

fn refusal(scene: Scene) -> ContactError {
    let shape = ContactShape::new(scene, SolverKind::Auto).unwrap();
    let start = Vector::from_element(36, 100.0);
    match shape.solve(&start, None, Accuracy::TIGHTEST) {
        Err(OracleError::Failed(error)) => *error.downcast().unwrap(),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("a state was found"),
    }
}

/// The rigid statics of all four scenes are fine: normal forces may be as large as one likes. Contact cannot build them
/// up: the push is some three times what the solver still finds a state for.
#[test]
fn what_contact_cannot_build_up_is_refused_with_the_motion() {
    let light = |friction, obstacle, push: f64| pushed(4, friction, 0.3, obstacle, [push, 0.3 * push, 0.0]);
    let scenes = [
        light(0.3, CounterSurface::Plane { height: 99.9 }, 6.0),
        light(0.3, sphere(0.3), 6.0),
        light(0.7, waves(0.3), 15.0),
        between_bodies(light(0.3, sphere(0.3), 6.0)),
    ];
    for scene in scenes {
        let error = refusal(scene);
        println!("{error}");
        let ContactError::FrictionTooWeak { direction, resultant, largest } = error else { panic!("{error}") };
        assert!(direction.contains("sliding along"), "{direction}");
        assert!(0.0 < largest && largest < 0.999 * resultant, "{largest} of {resultant}");
    }
}

/// A slender column, sheared by loads in equilibrium and out of reach of the obstacle: what condensation leaves of the
/// resultant is rounding, of which no friction is needed.
#[test]
fn loads_in_equilibrium_need_no_friction() {
    for ratio in [0.3, 0.499, 0.4999999] {
        let scene = pushed(2, 0.3, ratio, CounterSurface::Plane { height: 101.0 }, [0.0, 0.0, 0.01]);
        let mut scene = scene.with_blocks(|blocks| (blocks.size, blocks.bricks) = ([1.0; 2], [2, 2, 24]));
        scene.bodies[0].loads.push(Load::traction(BlockFace::X1Min, [0.0, 0.0, -0.01]));
        let start = Vector::from_element(36, 100.0);
        let solver = DirectSolver::new(Arc::new(ContactProblem::new(scene.clone()).unwrap())).unwrap();
        let needed = resistance(&solver.contact(start.as_slice()).unwrap());
        assert!(needed.as_ref().is_none_or(|found| found.largest > 0.999 * found.resultant), "{ratio}: {needed:?}");
        match ContactShape::new(scene, SolverKind::Auto).unwrap().solve(&start, None, Accuracy::TIGHTEST) {
            Ok(_) => {}
            Err(OracleError::Failed(error)) => {
                let error: ContactError = *error.downcast().unwrap();
                assert!(!matches!(error, ContactError::FrictionTooWeak { .. }), "{ratio}: {error}");
            }
            Err(other) => panic!("{ratio}: {other}"),
        }
    }
}

/// No contact at all: nothing can be built up, and the bound says nearly that.
#[test]
fn an_obstacle_out_of_reach_holds_nothing() {
    let scene = pushed(3, 0.5, 0.3, CounterSurface::Plane { height: 110.0 }, [0.1, 0.0, 0.0]);
    match refusal(scene) {
        ContactError::FrictionTooWeak { resultant, largest, .. } => {
            assert!((resultant / 1000.0 - 1.0).abs() < 0.1 && largest < 1e-2 * resultant, "{largest} of {resultant}");
        }
        other => panic!("{other}"),
    }
}

/// Friction too large for the bound: the refusal says what both solvers tried.
#[test]
fn a_refusal_without_proof_says_what_was_tried() {
    let text = refusal(pushed(4, 3.0, 0.3, waves(0.0), [8.0, 2.0, 0.0])).to_string();
    let words =
        ["no state found", "Total FETI", "products with F", "Direct condensation", "continuation", "cone programs"];
    assert!(words.iter().all(|word| text.contains(word)) && !text.contains("no equilibrium"), "{text}");
}

/// Growing pushes: states, then refusals that say what was tried, then proofs.
#[test]
fn what_is_not_proved_is_not_claimed() {
    let outcome = |step: i32| {
        let push = 1.25_f64.powi(step);
        let scene = pushed(4, 0.7, 0.3, sphere(0.3), [push, 0.3 * push, 0.0]);
        match ContactShape::new(scene, SolverKind::Direct).unwrap().solve(
            &Vector::from_element(36, 100.0),
            None,
            Accuracy::TIGHTEST,
        ) {
            Ok(_) => 0,
            Err(error) if error.to_string().contains("no equilibrium") => 2,
            Err(error) => {
                assert!(error.to_string().contains("continuation"), "{error}");
                1
            }
        }
    };
    let outcomes: Vec<i32> = (0..14).map(outcome).collect();
    assert!(outcomes.is_sorted() && outcomes.contains(&0) && outcomes.contains(&2), "{outcomes:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// The resultant of every state is at most the bound: no scene with a state is refused. Pushes are drawn up to and
    /// beyond what friction can hold.
    #[test]
    fn a_solvable_scene_is_never_refused(
        mesh in 2_usize..=4, friction in 0.05_f64..2.5, ratio in -0.5_f64..0.49, penetration in 0.05_f64..0.5,
        push in -3.0_f64..1.0, across in -1.0_f64..1.0, lift in -0.3_f64..0.3, kind in 0_usize..3, second in 0_usize..4,
    ) {
        let obstacle = [CounterSurface::Plane { height: 100.0 - penetration }, sphere(penetration), waves(penetration)];
        let push = friction * penetration * 50.0 * 10_f64.powf(push);
        let mut scene = pushed(mesh, friction, ratio, obstacle[kind].clone(), [push, across * push, lift * push]);
        if second == 0 {
            scene = between_bodies(scene);
        }
        if second == 1 {
            scene.bodies[0].supports.push(Support::new(BlockFace::X2Min, [false, true, false]));
        }
        let solver = DirectSolver::new(Arc::new(ContactProblem::new(scene).unwrap())).unwrap();
        let controls = vec![100.0; 36];
        let bound = resistance(&solver.contact(&controls).unwrap());
        if let (Some(bound), Ok(_)) = (bound, solver.solve(&controls, None, 1e-10)) {
            prop_assert!(bound.largest >= bound.resultant * (1.0 - 1e-9), "{} < {}", bound.largest, bound.resultant);
        }
    }
}
