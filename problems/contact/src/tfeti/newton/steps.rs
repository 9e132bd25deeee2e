//! Newton's steps with a linear solve of their own.
//!
//! Every step solves the system of its active set by projected GMRES, as accurately as the outer residual deserves
//! (Eisenstat–Walker). One product with F gives the particular part, one each Krylov vector; F is linear, so that step
//! lengths and the new residual are free.

use crate::equilibrium::Stage;
use crate::error::ContactError;
use crate::tfeti::dual::{Iterate, TornContact};
use crate::tfeti::newton::holding::holding_set_at;
use crate::tfeti::newton::linear_solve::LinearAccuracy;
use crate::tfeti::newton::linear_solve::linear_solve;
use crate::tfeti::newton::settings::NewtonSettings;
use crate::tfeti::newton::stagnation::{circles, stagnates};

/// First and largest forcing term.
const FIRST_FORCING: f64 = 0.3;
/// Forcing term after a shortened step.
const SHORTENED_FORCING: f64 = 0.01;
/// Lengths of a step that are tried, each half of the one before.
const MAX_HALVINGS: usize = 6;
/// Relative decrease of the residual asked of a step of length one.
const SUFFICIENT_DECREASE: f64 = 1e-4;

/// Newton steps until the residual is small, rounding stops them, or they lead nowhere. `accuracy`: of the linear
/// solves, for the residual (mm) that the outer residual deserves.
pub(super) fn newton_steps(
    contact: &TornContact<'_>,
    mut iterate: Iterate,
    mut residual: f64,
    accuracy: impl Fn(f64) -> LinearAccuracy,
    settings: &NewtonSettings,
    history: &mut Vec<f64>,
) -> Result<Iterate, ContactError> {
    let first = history.len() - 1;
    let mut forcing = FIRST_FORCING;
    while residual > settings.tolerance && history.len() - first <= settings.max_steps {
        if (residual <= settings.acceptable && stagnates(history, 1))
            || circles(&history[first..])
            || settings.products_left(contact.operator.applications()) == 0
        {
            break;
        }
        let target = forcing.max(0.3 * settings.tolerance / residual) * residual * contact.load / contact.stiffness;
        let active = holding_set_at(contact, &iterate)?;
        let candidate = linear_solve(contact, &active, &iterate.multipliers, accuracy(target), None)?;
        let (next, length) = search(contact, iterate, candidate, residual);
        iterate = next;
        let previous = residual;
        residual = contact.residual(&iterate);
        if !residual.is_finite() {
            return Err(ContactError::NotFinite { what: "contact residual" });
        }
        history.push(residual);
        Stage::Contact.reached(history.len() - 1, residual)?;
        forcing = eisenstat_walker(residual, previous, length);
    }
    Ok(iterate)
}

/// Halves the step until the residual falls; takes the full step when no length helps (a change of many statuses).
fn search(contact: &TornContact<'_>, from: Iterate, to: Iterate, residual: f64) -> (Iterate, f64) {
    let mut length = 1.0;
    for _halving in 0..MAX_HALVINGS {
        let trial = if length == 1.0 { to.clone() } else { from.towards(&to, length) };
        if contact.residual(&trial) <= (1.0 - SUFFICIENT_DECREASE * length) * residual {
            return (trial, length);
        }
        length *= 0.5;
    }
    (to, 1.0)
}

/// Forcing term of the next step.
fn eisenstat_walker(residual: f64, previous: f64, length: f64) -> f64 {
    let forcing = FIRST_FORCING.min((0.5 * (residual / previous).powf(1.5)).max(1e-4));
    if length < 1.0 { forcing.min(SHORTENED_FORCING) } else { forcing }
}
