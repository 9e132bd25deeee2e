//! How often a measurement is repeated, to which tolerance, and how it fails.

use crate::scaling::solve::Sample;
use contact::error::ContactError;
use problems::commands::Failure;

/// Tolerance of the timed states and of all subgradients.
pub const TIMED: f64 = 1e-8;
/// Repetitions of what takes less than [`LONG_RUN`].
const REPETITIONS: usize = 3;
/// Seconds from which one repetition is enough.
const LONG_RUN: f64 = 5.0;

/// The repetition of median time; one alone when it takes long.
pub fn median(mut run: impl FnMut() -> Result<Sample, ContactError>) -> Result<Sample, ContactError> {
    let mut samples = vec![run()?];
    while samples.len() < REPETITIONS && samples[0].seconds() < LONG_RUN {
        samples.push(run()?);
    }
    samples.sort_by(|a, b| a.seconds().total_cmp(&b.seconds()));
    Ok(samples.swap_remove(samples.len() / 2))
}

/// A solver's reason as a failed command.
pub fn failure(error: ContactError) -> Failure {
    match error {
        ContactError::InvertedElement { .. } | ContactError::NoEquilibrium { .. } => Failure::Input(error.to_string()),
        _ => Failure::Computation(error.to_string()),
    }
}
