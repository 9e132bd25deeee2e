//! Newton's iteration: descent with recycled directions, then steps with a linear solve of their own.

use crate::error::ContactError;
use crate::linear::vector::add_scaled;
use crate::tfeti::dual::{Precision, TornContact, TornSolution};
use crate::tfeti::newton::continuation::by_continuation;
use crate::tfeti::newton::descent::{descend, replace_image};
use crate::tfeti::newton::linear_solve::LinearAccuracy;
use crate::tfeti::newton::recycling::Recycled;
use crate::tfeti::newton::rounding::not_converged;
use crate::tfeti::newton::settings::NewtonSettings;
use crate::tfeti::newton::start::{bonded, first_iterate};
use crate::tfeti::newton::steps::newton_steps;

/// Solves from given multipliers (over all rows) of a similar problem, or from the bonded problem. Where inexact
/// steps do not converge, a second run takes the way over problems whose contact nodes yield, and a third one solves
/// every linear system as accurately as rounding allows. The residual that decides, and that certifies the state, comes
/// from a fresh product with F.
///
/// # Errors
/// [`ContactError::NotConverged`] with the residual history, [`ContactError::BeyondPrecision`],
/// [`ContactError::NotFinite`], [`ContactError::Unheld`] when an active set leaves a motion free.
pub fn solve(
    contact: &TornContact<'_>,
    start: Option<&[f64]>,
    settings: &NewtonSettings,
) -> Result<TornSolution, ContactError> {
    let mut recycled = settings.recycling.pays(contact.space.contact_amplitude_count()).then(Recycled::default);
    let mut iterate = first_iterate(contact, start, settings.max_products, recycled.as_mut())?;
    let mut residual = contact.residual(&iterate);
    let mut history = vec![residual];
    if let Some(mut recycled) = recycled {
        residual = descend(contact, &mut iterate, &mut recycled, residual, settings, &mut history)?;
    }
    if residual > settings.tolerance || contact.precision == Precision::Double {
        let deserved = |target| {
            LinearAccuracy::to(target, settings.max_krylov, settings.products_left(contact.operator.applications()))
        };
        iterate = newton_steps(contact, iterate, residual, deserved, settings, &mut history)?;
        residual = replace_image(contact, &mut iterate);
    }
    if (residual.is_nan() || residual > settings.acceptable)
        && let Some(found) = by_continuation(contact, settings, &mut history)?
    {
        iterate = found;
        residual = replace_image(contact, &mut iterate);
    }
    let left = settings.products_left(contact.operator.applications());
    if (residual.is_nan() || residual > settings.acceptable) && left > 0 {
        // Bricks of extreme shape need linear systems that are solved as accurately as rounding allows.
        let exact = bonded(contact, LinearAccuracy::exact(left), None)?;
        let start = contact.residual(&exact);
        history.push(start);
        let accuracy = |_| LinearAccuracy::exact(settings.products_left(contact.operator.applications()));
        iterate = newton_steps(contact, exact, start, accuracy, settings, &mut history)?;
        residual = replace_image(contact, &mut iterate);
    }
    if residual.is_nan() || residual > settings.acceptable {
        return Err(not_converged(contact, residual, settings, history));
    }
    // Motions of the bodies have taken an approach away that the unit of forces counts.
    if let Some((finer, moved)) = contact.finer(&iterate) {
        let exact = |_| LinearAccuracy::exact(settings.products_left(contact.operator.applications()));
        let start = finer.iterate(iterate.multipliers, iterate.image, vec![0.0; moved.len()]);
        let first = finer.residual(&start);
        iterate = newton_steps(&finer, start, first, exact, settings, &mut history)?;
        residual = replace_image(&finer, &mut iterate);
        add_scaled(&mut iterate.amplitudes, 1.0, &moved);
    }
    Ok(contact.solution(iterate, residual, history.len() - 1))
}
