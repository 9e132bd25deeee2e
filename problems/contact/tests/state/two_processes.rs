//! Two processes, played by two threads that share nothing but sums: each factors and solves its own half of the subdomains,
//! both end at the state of a single process.

use contact::equilibrium::ContactProblem;
use contact::scene::{Scene, hertz, signorini};
use contact::tfeti::{Communication, PreconditionerKind, TornSolver};
use std::ops::Range;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use testset::kit::relative_difference;

/// One of two ranks, connected by channels.
#[derive(Debug)]
struct Rank {
    rank: usize,
    send: Mutex<Sender<Vec<f64>>>,
    receive: Mutex<Receiver<Vec<f64>>>,
}

impl Rank {
    fn pair() -> [Self; 2] {
        let ((to_second, from_first), (to_first, from_second)) = (channel(), channel());
        let rank = |rank, send, receive| Self { rank, send: Mutex::new(send), receive: Mutex::new(receive) };
        [rank(0, to_second, from_second), rank(1, to_first, from_first)]
    }
}

impl Communication for Rank {
    fn owned(&self, count: usize) -> Range<usize> {
        if self.rank == 0 { 0..count / 2 } else { count / 2..count }
    }

    fn exchange(&self, rows: &mut [f64]) {
        self.sum(rows);
    }

    fn sum(&self, values: &mut [f64]) {
        self.send.lock().unwrap().send(values.to_vec()).unwrap();
        let other = self.receive.lock().unwrap().recv().unwrap();
        for (value, other) in values.iter_mut().zip(other) {
            // Two summands: the same on both sides whatever their order.
            *value += other;
        }
    }
}

struct Outcome {
    normal: Vec<f64>,
    heights: Vec<f64>,
    displacement: Vec<f64>,
    gluing_defect: f64,
    factorizations: usize,
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
    let bodies = solver.bodies(&state).unwrap();
    Outcome {
        normal: forces.normal,
        heights,
        displacement: bodies.iter().flat_map(|body| body.displacement.as_flattened().to_vec()).collect(),
        gluing_defect: bodies.iter().map(|body| body.gluing_defect).fold(0.0, f64::max),
        factorizations: work.factorizations,
    }
}

#[test]
fn two_processes_find_the_state_of_one() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        let scene = Scene { mesh: [4; 3], ..scene };
        let alone = solve(&scene, None);
        let threads = Rank::pair().map(|rank| {
            let scene = scene.clone();
            std::thread::spawn(move || {
                // A pool of its own: a rank that waits must not hold up the other's work.
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
                pool.install(|| solve(&scene, Some(rank)))
            })
        });
        let [first, second] = threads.map(|thread| thread.join().unwrap());
        assert_eq!(first.normal, second.normal);
        assert_eq!(first.heights, second.heights);
        assert!(relative_difference(&first.normal, &alone.normal) < 1e-9);
        assert!(relative_difference(&first.heights, &alone.heights) < 1e-8);
        // Whole bodies on both, though each has solved one half of the subdomains only.
        assert_eq!(first.displacement, second.displacement);
        assert_eq!(first.gluing_defect, second.gluing_defect);
        assert!(relative_difference(&first.displacement, &alone.displacement) < 1e-8);
        let size = alone.displacement.iter().fold(0.0, |size: f64, u| size.max(u.abs()));
        assert!(first.gluing_defect < 1e-9 * size && first.gluing_defect > 0.0);
        assert_eq!(first.factorizations + second.factorizations, alone.factorizations);
    }
}
