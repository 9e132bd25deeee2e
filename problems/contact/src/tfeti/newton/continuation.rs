//! The state by way of problems whose contact nodes yield.
//!
//! ```text
//! compliance δ/c of every contact node:   δ = 1, 10² or 10⁴, brought down to 0;   the state of every δ is the start of the next
//! ```
//! With a compliance of its own every node yields, and the forces spread over more nodes than hold the bodies in the
//! end: Newton's method converges from the bonded guess where few nodes hold the bodies.

use crate::error::ContactError;
use crate::tfeti::dual::{Iterate, TornContact};
use crate::tfeti::newton::linear_solve::LinearAccuracy;
use crate::tfeti::newton::settings::NewtonSettings;
use crate::tfeti::newton::start::bonded;
use crate::tfeti::newton::steps::newton_steps;

/// Compliances that the first problem is tried with, one after the other until Newton's method converges.
const FIRST_COMPLIANCES: [f64; 3] = [1.0, 1e2, 1e4];
/// Compliance below which the next one is 0.
const LAST_COMPLIANCE: f64 = 1e-6;
/// Factor of the compliance in the first step that lowers it.
const SHRINKAGE: f64 = 0.25;
/// Smallest factor of the compliance in one step.
const SMALLEST_FACTOR: f64 = 1e-4;
/// Factor of the compliance above which a step is no progress any more.
const LARGEST_FACTOR: f64 = 0.99;
/// Residual of the states on the way: starts and no results.
const ON_THE_WAY: f64 = 1e-6;

/// An iterate near the state without compliances; none where the way breaks off. Appends to the history.
pub(super) fn by_continuation(
    contact: &TornContact<'_>,
    settings: &NewtonSettings,
    history: &mut Vec<f64>,
) -> Result<Option<Iterate>, ContactError> {
    let products_left = || settings.products_left(contact.operator.applications());
    let to = |target| LinearAccuracy::to(target, settings.max_krylov, products_left());
    let rough = NewtonSettings { tolerance: settings.tolerance.max(ON_THE_WAY), ..*settings };
    for first in FIRST_COMPLIANCES {
        if products_left() == 0 {
            return Ok(None);
        }
        let yielding = contact.yielding(first);
        let start = bonded(&yielding, LinearAccuracy::start(products_left()), None)?;
        let Some(mut iterate) = converged(&yielding, start, &rough, to, history)? else { continue };
        let (mut delta, mut factor) = (first, SHRINKAGE);
        while factor <= LARGEST_FACTOR && products_left() > 0 {
            let next = if factor * delta < LAST_COMPLIANCE { 0.0 } else { factor * delta };
            let problem = contact.yielding(next);
            let start = at(&problem, &iterate);
            let found = match next > 0.0 {
                true => converged(&problem, start, &rough, to, history)?,
                // Where contact hardly holds the bodies, steps of little accuracy circle around the state.
                false => converged(&problem, start, settings, |_| LinearAccuracy::exact(products_left()), history)?,
            };
            match found {
                Some(found) if next == 0.0 => return Ok(Some(found)),
                Some(found) => {
                    (delta, iterate) = (next, found);
                    factor = (factor * factor).max(SMALLEST_FACTOR);
                }
                None => factor = factor.sqrt(),
            }
        }
    }
    Ok(None)
}

/// Newton's steps from an iterate, if they converge; `accuracy`: of their linear solves.
fn converged(
    problem: &TornContact<'_>,
    start: Iterate,
    settings: &NewtonSettings,
    accuracy: impl Fn(f64) -> LinearAccuracy,
    history: &mut Vec<f64>,
) -> Result<Option<Iterate>, ContactError> {
    let residual = problem.residual(&start);
    history.push(residual);
    let found = match newton_steps(problem, start, residual, accuracy, settings, history) {
        Err(ContactError::Unheld { .. } | ContactError::NotFinite { .. }) => return Ok(None),
        found => found?,
    };
    let allowed = settings.tolerance.max(settings.acceptable);
    Ok(Some(found).filter(|found| problem.residual(found) <= allowed))
}

/// The iterate of the same forces and amplitudes in a problem of another compliance.
fn at(problem: &TornContact<'_>, iterate: &Iterate) -> Iterate {
    let multipliers = iterate.multipliers.clone();
    let image = problem.apply(&multipliers);
    problem.iterate(multipliers, image, iterate.amplitudes.clone())
}
