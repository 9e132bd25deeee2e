//! The same state and subgradient with one, two and four threads: times, and whether the numbers agree in every bit.

use crate::scaling::cases::Variant;
use crate::scaling::repeat::{TIMED, failure, median};
use crate::scaling::solve::Sample;
use crate::scaling::timing;
use contact::contact_shape::ContactWarmStart;
use contact::equilibrium::{ContactProblem, SolverState};
use problems::commands::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Thread scaling of one case.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Threads {
    /// Timed cold states with subgradients.
    pub samples: Vec<ThreadSample>,
    /// Whether forces and sensitivities were bitwise equal for 1, 2 and 4 threads.
    pub bitwise_equal: bool,
}

/// A cold state with its subgradient on a number of threads.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ThreadSample {
    /// Threads of the pool.
    pub threads: usize,
    /// The repetition of median time.
    #[serde(flatten)]
    pub sample: Sample,
}

/// Numbers of threads that are timed.
pub const TIMED_THREADS: [usize; 2] = [1, 2];
/// Number of threads that is only compared.
const COMPARED: usize = 4;

/// Times a case with one and two threads, and compares the results with those of four.
///
/// # Errors
/// [`Failure::Computation`] from the solver or the system's threads.
pub fn measure(problem: &Arc<ContactProblem>, variant: Variant, controls: &[f64]) -> Result<Threads, Failure> {
    let mut results: Vec<Vec<u64>> = Vec::new();
    let mut samples = Vec::new();
    for threads in TIMED_THREADS.into_iter().chain([COMPARED]) {
        let sample = pool(threads)?.install(|| {
            let mut run = || {
                let solver = variant.solver(problem)?;
                let (state, solve) = timing::solve(&*solver, controls, None, TIMED)?;
                let (heights, adjoint) = timing::adjoint(&*solver, &state, TIMED)?;
                let (ContactWarmStart::Multipliers(found) | ContactWarmStart::Displacements(found)) =
                    state.solution.warm_start();
                results.push(found.iter().chain(&heights).map(|value| value.to_bits()).collect());
                Ok(Sample { state: solve, adjoint })
            };
            if threads == COMPARED { run() } else { median(run) }
        });
        let sample = sample.map_err(failure)?;
        if threads != COMPARED {
            samples.push(ThreadSample { threads, sample });
        }
    }
    Ok(Threads { samples, bitwise_equal: results.windows(2).all(|pair| pair[0] == pair[1]) })
}

/// A pool of its own.
///
/// # Errors
/// [`Failure::Computation`] with the system's reason.
pub fn pool(threads: usize) -> Result<ThreadPool, Failure> {
    ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| Failure::Computation(error.to_string()))
}
