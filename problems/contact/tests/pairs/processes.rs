//! Mortar rows over several processes, played by threads: states, adjoints and tangents to the last bit.

use crate::rank::Rank;
use crate::stack::tower;
use contact::equilibrium::{ContactProblem, TangentsOf};
use contact::tfeti::{TornOptions, TotalFeti};
use std::sync::Arc;

#[derive(Debug, PartialEq)]
struct Outcome {
    forces: Vec<f64>,
    tangential: Vec<[f64; 3]>,
    positions: Vec<[f64; 3]>,
    tangents: Vec<Vec<f64>>,
    products: usize,
}

fn solve(communication: Option<Rank>) -> Outcome {
    let scene = tower(0.3);
    let problem = Arc::new(ContactProblem::new(scene.clone()).unwrap());
    let mut options = TornOptions::default();
    if let Some(rank) = communication {
        options.communication = Arc::new(rank);
    }
    let solver = TotalFeti::new(Arc::clone(&problem), options).unwrap();
    let count = scene.control_count();
    let at: Vec<f64> = (0..count).map(|k| 0.02 * (2.0 * k as f64 + 1.0).cos()).collect();
    let state = solver.solve(&at, None, 1e-10).unwrap();
    let (forces, work) = (state.forces.clone(), state.work());
    let dual: Vec<f64> = (0..problem.boundary.row_count).map(|row| (0.3 * row as f64).sin()).collect();
    let positions = solver.sensitivities(&state.solution, &dual, 1e-11).unwrap().positions;
    let change = |control: usize| (0..count).map(|k| f64::from(u8::from(k == control))).collect::<Vec<f64>>();
    let changes = [0, count / 2, count - 1].map(change);
    let tangents = solver.tangents(&state.solution, &changes, TangentsOf::Contact, 1e-6).unwrap().forces;
    Outcome {
        forces: forces.normal,
        tangential: forces.tangential,
        positions,
        tangents,
        products: work.dual_operator_applications,
    }
}

#[test]
fn any_number_of_processes_finds_the_state_of_one_bit_by_bit() {
    let alone = solve(None);
    for size in [2, 3, 4] {
        let ranks = Rank::all(size);
        let work = ranks.map(|rank| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
            std::thread::spawn(move || pool.install(|| solve(Some(rank))))
        });
        let work: Vec<_> = work.collect();
        for outcome in work.into_iter().map(|thread| thread.join().unwrap()) {
            assert_eq!(outcome, alone, "{size} processes");
        }
    }
}
