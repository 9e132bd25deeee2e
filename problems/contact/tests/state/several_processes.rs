//! Several processes, played by threads that share nothing but pieces of subdomains: each factors and solves its own,
//! and all end at the state of a single process, to the last bit.

use crate::common::{start_height, unit};
use crate::rank::Rank;
use contact::communication::Communication;
use contact::equilibrium::{ContactProblem, SolvedBody, TangentsOf};
use contact::error::ContactError;
use contact::scene::{Held, Scene, Support, hertz, signorini};
use contact::tfeti::{DualMethod, Recycling, TornOptions, TotalFeti};
use std::sync::Arc;

#[derive(Debug, Clone, PartialEq)]
struct Outcome {
    forces: Vec<f64>,
    tangential: Vec<[f64; 3]>,
    positions: Vec<[f64; 3]>,
    /// Sensitivities of a function of the displacements.
    positions_by_displacements: Vec<[f64; 3]>,
    tangents: Vec<Vec<f64>>,
    /// At process 0 alone: elsewhere without entries.
    displacement_tangents: Vec<Vec<f64>>,
    /// At process 0 alone.
    bodies: Vec<SolvedBody>,
    contraction: f64,
    factorizations: usize,
    products: usize,
}

fn solve(scene: &Scene, clusters: Option<usize>, communication: Option<Rank>, method: DualMethod) -> Outcome {
    let problem = Arc::new(ContactProblem::new(scene.clone()).unwrap());
    let mut options = TornOptions { clusters, ..TornOptions::default() };
    if let Some(rank) = communication {
        options.communication = Arc::new(rank);
    }
    let solver = TotalFeti::new(Arc::clone(&problem), options).unwrap().with_method(method);
    let height = start_height(scene);
    let first = solver.solve(&[height; 36], None, 1e-6).unwrap();
    let moved: Vec<f64> = (0..36).map(|index| height - 0.01 * (index as f64).sin()).collect();
    let state = solver.solve(&moved, Some(&first.solution.warm_start()), 1e-10).unwrap();
    let (forces, work) = (state.forces.clone(), state.work());
    let state = state.solution;
    let dual: Vec<f64> = (0..problem.boundary.row_count).map(|row| (0.3 * row as f64).sin()).collect();
    let positions = solver.sensitivities(&state, &dual, 1e-11).unwrap().positions;
    let loads = (0..problem.displacement_count()).map(|dof| (0.7 * dof as f64).cos());
    let both: Vec<f64> = dual.iter().copied().chain(loads).collect();
    let positions_by_displacements = solver.sensitivities(&state, &both, 1e-11).unwrap().positions;
    let changes: Vec<Vec<f64>> = [0, 17, 35].map(|control| unit(36, control)).into();
    let tangents = solver.tangents(&state, &changes, TangentsOf::Displacements, 1e-6).unwrap();
    let contraction = solver.diagnose(&state).unwrap().contraction;
    Outcome {
        forces: forces.normal,
        tangential: forces.tangential,
        positions,
        positions_by_displacements,
        tangents: tangents.forces,
        displacement_tangents: tangents.displacements.unwrap(),
        bodies: solver.bodies(&state).unwrap(),
        contraction,
        factorizations: work.factorizations,
        products: work.dual_operator_applications,
    }
}

/// Bodies that prescribed displacements press and shift.
fn pressed() -> Scene {
    let mut scene = hertz().unwrap();
    let upper = &mut scene.bodies[1];
    upper.loads.clear();
    let held = Held::Components([Some(0.01), Some(0.0), Some(-0.05)]);
    upper.supports = vec![Support { face: "top".into(), held }];
    scene
}

/// Runs a rank on a pool of its own: a rank that waits must not hold up the work of the others.
fn on_threads<T: Send + 'static>(
    threads: usize,
    work: impl FnOnce() -> T + Send + 'static,
) -> std::thread::JoinHandle<T> {
    std::thread::spawn(move || rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work))
}

#[test]
fn any_number_of_processes_finds_the_state_of_one_bit_by_bit() {
    let newton = DualMethod::Newton(Recycling::On);
    let cases = [
        (signorini(), [2; 3], None, newton),
        (hertz(), [2, 1, 2], None, newton),
        (signorini(), [1; 3], None, newton),
        (hertz(), [2, 2, 1], None, DualMethod::Newton(Recycling::Off)),
        (signorini(), [2, 2, 1], None, DualMethod::SuccessiveApproximations),
        (hertz(), [2; 3], Some(8), newton),
        (signorini(), [2; 3], Some(4), DualMethod::SuccessiveApproximations),
        (Ok(pressed()), [2, 1, 2], None, newton),
    ];
    for (scene, subdomains, clusters, method) in cases {
        let scene = scene.unwrap().with_bricks([4; 3], subdomains);
        let alone = solve(&scene, clusters, None, method);
        for (processes, threads) in [(1, 1), (2, 2), (3, 1), (4, 1)] {
            let ranks = Rank::all(processes).map(|rank| {
                let scene = scene.clone();
                on_threads(threads, move || solve(&scene, clusters, Some(rank), method))
            });
            for (rank, handle) in ranks.collect::<Vec<_>>().into_iter().enumerate() {
                let mut expected = alone.clone();
                if rank > 0 {
                    expected.bodies.clear();
                    expected.displacement_tangents.iter_mut().for_each(Vec::clear);
                }
                assert_eq!(handle.join().unwrap(), expected, "rank {rank} of {processes}");
            }
        }
    }
}

#[test]
fn a_failure_in_one_process_ends_the_others() {
    let handles = Rank::all(3).enumerate().map(|(number, rank)| {
        on_threads(1, move || {
            let scene = signorini().unwrap().with_bricks([4; 3], [2; 3]);
            // The bodies of the second process are so flat that no factor of theirs has a digit.
            let controls = vec![if number == 1 { 1e-9 } else { start_height(&scene) }; 36];
            let problem = Arc::new(ContactProblem::new(scene).unwrap());
            let options = TornOptions { communication: Arc::new(rank), ..TornOptions::default() };
            let solver = TotalFeti::new(problem, options).unwrap();
            solver.solve(&controls, None, 1e-8).unwrap_err()
        })
    });
    let errors: Vec<ContactError> =
        handles.collect::<Vec<_>>().into_iter().map(|handle| handle.join().unwrap()).collect();
    let reason = errors[1].to_string();
    for error in errors {
        assert!(matches!(&error, ContactError::Factorization { .. }), "{error}");
        assert!(error.to_string().ends_with(&reason), "{error}; {reason}");
    }
}

#[test]
fn the_first_failure_is_known_to_all() {
    let handles = Rank::all(3).enumerate().map(|(number, rank)| {
        on_threads(1, move || {
            let communication: &dyn Communication = &rank;
            let failure = |fails: bool| fails.then(|| format!("rank {number}: too little memory, 5 \u{b0}C"));
            (
                communication.agree(None),
                communication.agree(failure(number > 0)),
                communication.all_of_first(vec![number as f64 + 0.5])[0],
                communication.gather_any(&vec![number as f64; number]),
            )
        })
    });
    for handle in handles.collect::<Vec<_>>() {
        let pieces = vec![vec![], vec![1.0], vec![2.0; 2]];
        assert_eq!(handle.join().unwrap(), (None, Some("rank 1: too little memory, 5 \u{b0}C".into()), 0.5, pieces));
    }
}
