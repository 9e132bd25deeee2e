//! The contact forces of a condensed state in physical units, with what certifies them.

use crate::direct::compliant_contact::CompliantContact;
use crate::equilibrium::law::Linearization;
use crate::equilibrium::{Configuration, ContactForces, Kink, Residuals};
use crate::linear::vector::norm;

/// The solution in physical units.
#[derive(Debug)]
pub(super) struct CondensedSolution {
    /// Forces and amplitudes, dimensionless.
    pub(super) unknowns: Vec<f64>,
    /// Contact displacements of all bodies less the prescribed ones, mm.
    pub(super) displacement: Vec<f64>,
    pub(super) forces: Vec<f64>,
    pub(super) linearizations: Vec<Linearization>,
}

/// The contact forces of a solution with status, residuals and kinks.
pub(super) fn forces(
    contact: &CompliantContact,
    solution: &CondensedSolution,
    configuration: &Configuration,
) -> ContactForces {
    let problem = &contact.problem;
    let boundary = &problem.boundary;
    let (residual, arguments) = contact.residual(&solution.unknowns, 0.0);
    let status = boundary.points.iter().zip(&solution.linearizations);
    let status = status.map(|(point, linearization)| linearization.status(point)).collect();
    let length = contact.unit * contact.load;
    let jumps: Vec<f64> = contact.jumps(&solution.unknowns, 0.0).iter().map(|jump| jump * length).collect();
    let mut forces = solution.forces.clone();
    for (point, linearization) in boundary.points.iter().zip(&solution.linearizations) {
        if *linearization == Linearization::Open {
            forces[point.rows()].fill(0.0);
        }
    }
    let residuals = Residuals {
        newton: norm(&residual),
        ..configuration.residuals(problem, &forces, &jumps, contact.unit.recip())
    };
    ContactForces::unpack(boundary, &contact.rows, &forces, &jumps, status, residuals, Kink::of(boundary, &arguments))
}
