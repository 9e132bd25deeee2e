//! Where an iteration starts: the bonded problem, or the forces of a similar problem.
//!
//! ```text
//! bonded:    contact rows glued where c·gap is within reach of the load, solved roughly;   nodes beyond stay open
//! balanced:  given forces, changed as little as the resultants e ask for;   amplitudes by least squares on the held rows
//! ```

use crate::equilibrium::law::{Friction, Linearization, tangential_norm};
use crate::error::ContactError;
use crate::tfeti::dual::{Iterate, TornContact};
use crate::tfeti::newton::holding::holding_set;
use crate::tfeti::newton::linear_solve::LinearAccuracy;
use crate::tfeti::newton::linear_solve::linear_solve;
use crate::tfeti::newton::recycling::Recycled;
use crate::tfeti::torn::RowVector;

/// c·gap over load up to which a node may start closed.
const REACH: f64 = 100.0;
/// Relative distance to the slip bound below which a traction counts as sliding.
const ON_THE_CONE: f64 = 1e-9;

/// The iterate that a solve begins with: the forces of a similar problem (over all rows) where they hold this
/// shape, else the bonded problem.
pub(crate) fn first_iterate(
    contact: &TornContact<'_>,
    forces: Option<&[f64]>,
    max_products: usize,
    recycled: Option<&mut Recycled>,
) -> Result<Iterate, ContactError> {
    if let Some(forces) = forces {
        let forces = contact.operator.model.constraints.row_vector(forces)?;
        match balanced(contact, &forces, &slip_bounds(contact, forces.contact())) {
            // Forces that hold the old shape but not the new one are no start.
            Err(ContactError::Unheld { .. }) => {}
            balanced => return balanced,
        }
    }
    bonded(contact, LinearAccuracy::start(max_products), recycled)
}

/// The bonded problem: contact rows glued, solved roughly. A node that only forces out of all proportion to the
/// load could close starts open; where bodies have to travel to meet, the nodes that meet first start closed.
pub(crate) fn bonded(
    contact: &TornContact<'_>,
    accuracy: LinearAccuracy,
    recycled: Option<&mut Recycled>,
) -> Result<Iterate, ContactError> {
    let reach = REACH * contact.load / contact.stiffness;
    let nearest = contact.rows.gaps().fold(f64::INFINITY, f64::min);
    let within = |reach: f64| -> Vec<Linearization> {
        let close = |gap: f64| if gap <= reach { Linearization::Stick } else { Linearization::Open };
        contact.rows.gaps().map(close).collect()
    };
    let active = match contact.active_set(within(reach), Friction::Coulomb) {
        Err(ContactError::Unheld { .. }) => {
            holding_set(contact, within(nearest.max(0.0) + reach), || contact.rows.gaps().map(|gap| -gap).collect())?
        }
        active => active?,
    };
    linear_solve(contact, &active, &contact.zeros(), accuracy, recycled)
}

/// Ψ = 𝓕 max(0, λ_N) per contact node, of packed contact rows.
pub(crate) fn slip_bounds(contact: &TornContact<'_>, forces: &[f64]) -> Vec<f64> {
    contact.boundary.points.iter().map(|point| point.friction * forces[point.start].max(0.0)).collect()
}

/// Given multipliers, balanced, with their image, and amplitudes by least squares on the held rows; `bounds`: slip
/// bound per contact node.
///
/// # Errors
/// [`ContactError::Unheld`] when the nodes that carry forces leave a motion free.
pub(crate) fn balanced(
    contact: &TornContact<'_>,
    multipliers: &RowVector,
    bounds: &[f64],
) -> Result<Iterate, ContactError> {
    let statuses: Vec<Linearization> = (contact.boundary.points.iter().zip(bounds))
        .map(|(point, &bound)| suggested(&multipliers.contact()[point.rows()], bound))
        .collect();
    let glued = |status| if status == Linearization::Open { status } else { Linearization::Stick };
    let closed = contact.active_set(statuses.iter().copied().map(glued).collect(), Friction::Tresca)?;
    let mut unknowns = closed.rows.unknowns_of(multipliers);
    closed.enforce(&mut unknowns, contact.space.resultants());
    let multipliers = closed.rows.trial(&unknowns);
    let image = contact.operator.apply(&multipliers);
    let held = contact.active_set(statuses, Friction::Tresca)?;
    let amplitudes = held.amplitudes(&held.rows.test_transposed(&contact.rest(&image)));
    Ok(contact.iterate(multipliers, image, amplitudes))
}

/// The derivative that the forces of a node suggest: open without force, slip at the bound, else stick.
fn suggested(forces: &[f64], bound: f64) -> Linearization {
    if forces[0] <= 0.0 {
        return Linearization::Open;
    }
    let traction = tangential_norm(forces);
    if forces.len() == 1 || traction < (1.0 - ON_THE_CONE) * bound {
        return Linearization::Stick;
    }
    let second = if forces.len() > 2 { forces[2] / traction } else { 0.0 };
    Linearization::Slip { direction: [forces[1] / traction, second], ratio: 0.0 }
}
