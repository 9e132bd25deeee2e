//! Factors that solvers of one run share: counted once, and of no influence on any result.

use crate::rank::Rank;
use contact::communication::Communication;
use contact::contact_shape::{ContactShape, ContactState, SolverKind};
use contact::equilibrium::ContactProblem;
use contact::scene::{Held, Scene, Support, hertz};
use contact::solvers::{Processes, SolverPlan};
use contact::tfeti::{TornOptions, TotalFeti};
use nonsmooth::{Accuracy, StateSolver, Vector};
use std::sync::Arc;

/// Scenes that differ by loads, friction and prescribed displacements alone.
fn cases() -> [Scene; 3] {
    let scene = || hertz().unwrap().with_bricks([4; 3], [2, 1, 2]);
    let held = |value| Support { face: "top".into(), held: Held::Components([None, None, Some(value)]) };
    let [mut loaded, mut pressed, mut again] = [scene(), scene().with_friction(0.2), scene().with_friction(0.5)];
    for load in &mut loaded.bodies[1].loads {
        *load = load.scaled(0.7);
    }
    for (scene, value) in [(&mut loaded, 0.0), (&mut pressed, -0.03), (&mut again, -0.01)] {
        let body = &mut scene.bodies[1];
        if value != 0.0 {
            body.loads.clear();
        }
        body.supports.push(held(value));
    }
    pressed.bodies[0].supports[2] = Support { face: "bottom".into(), held: Held::Components([None, None, Some(0.04)]) };
    // Held at rest, a top that is loaded presses nothing: the first case pushes its foot.
    loaded.bodies[0].supports[2] = Support { face: "bottom".into(), held: Held::Components([None, None, Some(0.02)]) };
    [loaded, pressed, again]
}

fn solve(shape: &ContactShape, factor: f64) -> ContactState {
    let controls: Vector = shape.start() * factor;
    shape.solve(&controls, None, Accuracy::TIGHTEST).unwrap()
}

fn shape(processes: &Processes, scene: Scene, kind: SolverKind, clusters: Option<usize>) -> ContactShape {
    let plan = SolverPlan { clusters, ..SolverPlan::new(scene, kind) };
    ContactShape::by(processes.solver(plan).unwrap())
}

#[test]
fn later_cases_take_over_the_factors_that_the_first_one_holds() {
    for (kind, clusters) in [(SolverKind::Newton, None), (SolverKind::Newton, Some(2)), (SolverKind::Direct, None)] {
        let processes = Processes::alone();
        let shared = cases().map(|scene| shape(&processes, scene, kind, clusters));
        for factor in [0.9999, 0.9998] {
            let states: Vec<ContactState> = shared.iter().map(|shape| solve(shape, factor)).collect();
            let counts: Vec<usize> = states.iter().map(|state| state.work().factorizations).collect();
            assert!(counts[0] > 0 && counts[1] == 0 && counts[2] == 0, "{kind:?}, {clusters:?}: {counts:?}");
            for ((state, shape_of), scene) in states.iter().zip(&shared).zip(cases()) {
                let alone = shape(&Processes::alone(), scene, kind, clusters);
                let own = solve(&alone, factor);
                assert!(own.forces.total_normal_force() > 0.0);
                assert_eq!(state.forces.normal, own.forces.normal, "{kind:?}, {clusters:?}");
                assert_eq!(state.forces.tangential, own.forces.tangential, "{kind:?}, {clusters:?}");
                assert_eq!(shape_of.bodies(state).unwrap(), alone.bodies(&own).unwrap(), "{kind:?}, {clusters:?}");
            }
        }
        // Nothing is kept that no state holds; bodies of fixed shape belong to their solver.
        let [first, second, _] = &shared;
        let counts = [first, second].map(|shape| solve(shape, 0.9997).work().factorizations);
        assert!(counts[0] > 0 && counts[0] == counts[1], "{kind:?}, {clusters:?}: {counts:?}");
    }
}

/// Of two processes, one may still hold factors that the other has dropped: then both factor again.
#[test]
fn processes_take_over_factors_only_where_all_hold_them() {
    let work = |rank: Rank, number: usize| {
        let shelf = Arc::default();
        let communication: Arc<dyn Communication> = Arc::new(rank);
        let [first, second, third] = cases().map(|scene| {
            let options = TornOptions {
                communication: Arc::clone(&communication),
                shelf: Arc::clone(&shelf),
                ..TornOptions::default()
            };
            TotalFeti::new(Arc::new(ContactProblem::new(scene).unwrap()), options).unwrap()
        });
        let controls = vec![9.999; 36];
        let solve = |solver: &TotalFeti| solver.solve(&controls, None, 1e-10).unwrap();
        let (one, two) = (solve(&first), solve(&second));
        let mut counts = vec![one.work().factorizations, two.work().factorizations];
        let held = (number == 0).then_some((one, two));
        counts.push(solve(&third).work().factorizations);
        drop(held);
        counts
    };
    let ranks: Vec<_> = Rank::all(2)
        .enumerate()
        .map(|(number, rank)| {
            std::thread::spawn(move || {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
                pool.install(|| work(rank, number))
            })
        })
        .collect();
    for handle in ranks {
        let counts = handle.join().unwrap();
        // The lower body again, the upper one is still held by the solvers of both processes.
        assert!(counts[0] > 0 && counts[1] == 0 && counts[2] > 0 && counts[2] < counts[0], "{counts:?}");
    }
}

#[test]
fn bodies_of_other_stiffness_are_factored_for_themselves() {
    let [first, mut other, _] = cases();
    other.bodies[0].material = other.bodies[1].material;
    let mut free = first.clone();
    free.bodies[0].supports.remove(0);
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let processes = Processes::alone();
        let shapes = [first.clone(), other.clone(), free.clone()].map(|scene| shape(&processes, scene, kind, None));
        let states: Vec<ContactState> = shapes.iter().map(|shape| solve(shape, 0.999)).collect();
        assert!(states.iter().all(|state| state.work().factorizations > 0), "{kind:?}");
    }
}
