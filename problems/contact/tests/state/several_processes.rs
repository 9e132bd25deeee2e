//! Several processes, played by threads that share nothing but pieces of subdomains: each factors and solves its own, and all end at
//! the state of a single process, to the last bit.

use contact::equilibrium::ContactProblem;
use contact::error::ContactError;
use contact::scene::{Scene, hertz, signorini};
use contact::tfeti::{Communication, PreconditionerKind, TornSolver};
use std::ops::Range;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

/// What passes through a channel.
type Message = (Vec<Vec<f64>>, Option<String>);

/// One of several ranks, with a channel to and from each of the others.
#[derive(Debug)]
struct Rank {
    rank: usize,
    /// Whether it reports a failure when all agree.
    fails: bool,
    to: Vec<Mutex<Sender<Message>>>,
    from: Vec<Mutex<Receiver<Message>>>,
}

impl Rank {
    fn all(count: usize) -> Vec<Self> {
        let mut ranks: Vec<Self> =
            (0..count).map(|rank| Self { rank, fails: false, to: vec![], from: vec![] }).collect();
        for sender in 0..count {
            for receiver in 0..count {
                let (to, from) = channel();
                ranks[sender].to.push(Mutex::new(to));
                ranks[receiver].from.push(Mutex::new(from));
            }
        }
        ranks
    }

    /// What every rank sends, in the order of ranks.
    fn all_to_all(&self, message: &Message) -> Vec<Message> {
        self.to.iter().for_each(|to| to.lock().unwrap().send(message.clone()).unwrap());
        self.from.iter().map(|from| from.lock().unwrap().recv().unwrap()).collect()
    }

    fn range(&self, rank: usize, count: usize) -> Range<usize> {
        rank * count / self.to.len()..(rank + 1) * count / self.to.len()
    }
}

impl Communication for Rank {
    fn owned(&self, count: usize) -> Range<usize> {
        self.range(self.rank, count)
    }

    fn share(&self, pieces: &mut [Vec<f64>]) {
        let own = pieces[self.owned(pieces.len())].to_vec();
        for (rank, (theirs, _)) in self.all_to_all(&(own, None)).into_iter().enumerate() {
            let range = self.range(rank, pieces.len());
            pieces[range].clone_from_slice(&theirs);
        }
    }

    fn agree(&self, failure: Option<String>) -> Option<String> {
        let failure = failure.or_else(|| self.fails.then(|| format!("rank {}: no memory", self.rank)));
        self.all_to_all(&(vec![], failure)).into_iter().find_map(|(_, failure)| failure)
    }
}

#[derive(Debug, PartialEq)]
struct Outcome {
    forces: [Vec<f64>; 2],
    heights: Vec<f64>,
    tangents: Vec<Vec<f64>>,
    displacement: Vec<f64>,
    gluing_defect: f64,
    strain_energy: f64,
    factorizations: usize,
    products: usize,
}

fn solve(scene: &Scene, communication: Option<Rank>) -> Outcome {
    let problem = Arc::new(ContactProblem::new(scene.clone()).unwrap());
    let solver = match communication {
        Some(rank) => {
            TornSolver::with_communication(Arc::clone(&problem), PreconditionerKind::Dirichlet, Arc::new(rank))
        }
        None => TornSolver::new(Arc::clone(&problem), PreconditionerKind::Dirichlet),
    }
    .unwrap();
    let controls = vec![scene.start_height; 36];
    let (state, forces, work) = solver.solve(&controls, None, 1e-12).unwrap();
    let dual: Vec<f64> = (0..problem.boundary.row_count).map(|row| (0.3 * row as f64).sin()).collect();
    let heights = solver.sensitivities(&state, &dual, 1e-11).unwrap().heights;
    let changes: Vec<Vec<f64>> = (0..3)
        .map(|change| (0..problem.grid.column_count()).map(|node| f64::from(node % 3 == change)).collect())
        .collect();
    let tangents = solver.tangents(&state, &changes, 1e-6).unwrap().forces;
    let bodies = solver.bodies(&state).unwrap();
    Outcome {
        forces: [forces.normal, forces.tangential.as_flattened().to_vec()],
        heights,
        tangents,
        displacement: bodies.iter().flat_map(|body| body.displacement.as_flattened().to_vec()).collect(),
        gluing_defect: bodies.iter().map(|body| body.gluing_defect).fold(0.0, f64::max),
        strain_energy: solver.strain_energy(&state),
        factorizations: work.factorizations,
        products: work.dual_operator_applications,
    }
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
    let scenes = [(signorini(), [2; 3]), (hertz(), [2, 1, 2]), (signorini(), [1; 3]), (signorini(), [2, 1, 1])];
    for (scene, subdomains) in scenes.map(|(scene, subdomains)| (scene.unwrap(), subdomains)) {
        let scene = Scene { mesh: [4; 3], subdomains, ..scene };
        let alone = solve(&scene, None);
        for (processes, threads) in [(1, 1), (2, 2), (3, 1), (4, 1)] {
            let ranks = Rank::all(processes).into_iter().map(|rank| {
                let scene = scene.clone();
                on_threads(threads, move || solve(&scene, Some(rank)))
            });
            for (rank, handle) in ranks.collect::<Vec<_>>().into_iter().enumerate() {
                assert_eq!(handle.join().unwrap(), alone, "rank {rank} of {processes}");
            }
        }
    }
}

#[test]
fn a_failure_in_one_process_ends_the_others() {
    let mut ranks = Rank::all(3);
    ranks[1].fails = true;
    let handles = ranks.into_iter().map(|rank| {
        on_threads(1, move || {
            let scene = Scene { mesh: [4; 3], ..signorini().unwrap() };
            let controls = vec![scene.start_height; 36];
            let problem = Arc::new(ContactProblem::new(scene).unwrap());
            let kind = PreconditionerKind::Dirichlet;
            let solver = TornSolver::with_communication(problem, kind, Arc::new(rank)).unwrap();
            solver.solve(&controls, None, 1e-8).unwrap_err()
        })
    });
    for handle in handles.collect::<Vec<_>>() {
        let error = handle.join().unwrap();
        assert!(matches!(&error, ContactError::Factorization { .. }), "{error}");
        assert!(error.to_string().contains("rank 1: no memory"), "{error}");
    }
}
