//! Seconds per product with F and with its preconditioner, and the share of the memory bandwidth that F reaches.
//!
//! Both triangular sweeps of every subdomain read all values of its factor: bytes = 2 · 8 · values · subdomains. A sweep may
//! find the values of the one before it in a cache, so that the share can exceed what memory alone delivers; vectors, rows
//! and indices are not counted.

use crate::scaling::repeat::failure;
use crate::scaling::threads::{TIMED_THREADS, pool};
use contact::equilibrium::ContactProblem;
use contact::linear::cholesky::SymbolicFactor;
use contact::tfeti::{DualOperator, Preconditioner, PreconditionerKind, RowVector, TornModel, TornSolver, TornSystem};
use problems::commands::Failure;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// Speed of the dual operator with a number of threads.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Bandwidth {
    /// Threads.
    pub threads: usize,
    /// Seconds per product with F, median.
    pub application_seconds: f64,
    /// Seconds per product with the preconditioner, median.
    pub preconditioner_seconds: f64,
    /// Bytes of factor values, each counted once.
    pub factor_bytes: f64,
    /// Bytes of factor values read per product with F (two sweeps) per second.
    pub operator_bytes_per_second: f64,
    /// Bytes per second of a triad a = b + s·c over arrays much larger than the caches (24 bytes per entry), best of all.
    pub triad_bytes_per_second: f64,
    /// The former over the latter.
    pub fraction: f64,
}

/// Entries of each of the three arrays of the triad: 128 MiB.
const TRIAD: usize = 1 << 24;
/// Entries that one task of the triad works on.
const CHUNK: usize = 1 << 16;
/// Repetitions of the triad.
const TRIAD_REPETITIONS: usize = 8;
/// Least products timed.
const PRODUCTS: usize = 7;
/// Seconds for which products are repeated at least.
const LONG_ENOUGH: f64 = 0.3;

/// Measures the operator of one shape with one and two threads.
///
/// # Errors
/// [`Failure`] from the factorisation.
pub fn measure(
    problem: &Arc<ContactProblem>,
    preconditioner: PreconditionerKind,
    controls: &[f64],
) -> Result<Vec<Bandwidth>, Failure> {
    let solver = TornSolver::new(Arc::clone(problem), preconditioner).map_err(failure)?;
    let model = solver.model();
    let blocks = problem.blocks(controls).map_err(failure)?;
    let system = model.factorize(&blocks).map_err(failure)?;
    let factor_bytes = factor_bytes(model, &system)?;
    let operator = DualOperator::new(model, &system);
    let preconditioner = Preconditioner::new(model, &system, preconditioner, 1.0);
    let mut input = model.constraints.zeros();
    input.iter_mut().enumerate().for_each(|(row, entry)| *entry = ((row % 17) as f64 - 8.0) / 8.0);
    TIMED_THREADS
        .into_iter()
        .map(|threads| {
            pool(threads)?.install(|| {
                let triad_bytes_per_second = triad();
                let application_seconds = seconds_per_call(|| operator.apply(&input));
                let preconditioner_seconds = seconds_per_call(|| preconditioner.apply(&input));
                let operator_bytes_per_second = 2.0 * factor_bytes / application_seconds;
                Ok(Bandwidth {
                    threads,
                    application_seconds,
                    preconditioner_seconds,
                    factor_bytes,
                    operator_bytes_per_second,
                    triad_bytes_per_second,
                    fraction: operator_bytes_per_second / triad_bytes_per_second,
                })
            })
        })
        .collect()
}

/// Bytes of the values of all factors of K⁺; the analysis is repeated, because a factor does not tell its size.
fn factor_bytes(model: &TornModel, system: &TornSystem) -> Result<f64, Failure> {
    let Some(factors) = system.parts.first().and_then(|part| part.factors.as_ref()) else { return Ok(0.0) };
    let symbolic = SymbolicFactor::new(Arc::clone(&model.pattern.pattern), factors.inverse.order().to_vec());
    let values = symbolic.map_err(|error| failure(error.into()))?.value_count();
    Ok((values * size_of::<f64>() * system.parts.len()) as f64)
}

/// Median seconds of a call.
fn seconds_per_call(call: impl Fn() -> RowVector) -> f64 {
    black_box(call());
    let whole = Instant::now();
    let mut seconds = Vec::new();
    while seconds.len() < PRODUCTS || whole.elapsed().as_secs_f64() < LONG_ENOUGH {
        let clock = Instant::now();
        black_box(call());
        seconds.push(clock.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

/// Bytes per second of a = b + s·c on the threads of the pool.
fn triad() -> f64 {
    let (b, c) = (vec![1.0_f64; TRIAD], vec![2.0_f64; TRIAD]);
    let mut a = vec![0.5_f64; TRIAD];
    let mut best = f64::INFINITY;
    for repetition in 0..TRIAD_REPETITIONS {
        let factor = repetition as f64;
        let clock = Instant::now();
        a.par_chunks_mut(CHUNK).zip(b.par_chunks(CHUNK)).zip(c.par_chunks(CHUNK)).for_each(|((a, b), c)| {
            for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                *a = b + factor * c;
            }
        });
        best = best.min(clock.elapsed().as_secs_f64());
        black_box(&a);
    }
    (3 * size_of::<f64>() * TRIAD) as f64 / best
}
