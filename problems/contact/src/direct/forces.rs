//! The contact forces of a condensed state in physical units, with what certifies them.

use crate::direct::solver::DirectState;
use crate::equilibrium::certificate::law_residuals;
use crate::equilibrium::law::Linearization;
use crate::equilibrium::{ContactForces, Kink, Residuals};
use crate::linear::vector::norm;

impl DirectState {
    /// The contact forces with status, residuals and kinks.
    pub(super) fn forces(&self) -> ContactForces {
        let (contact, solution) = (&self.contact, &self.solution);
        let boundary = &contact.problem.boundary;
        let (residual, arguments) = contact.residual(&solution.unknowns, 0.0);
        let status = boundary.points.iter().zip(&solution.linearizations);
        let status = status.map(|(point, linearization)| linearization.status(point)).collect();
        let length = contact.unit * contact.load;
        let jumps: Vec<f64> = contact.jumps(&solution.unknowns, 0.0).iter().map(|jump| jump * length).collect();
        let imbalance = contact.bodies.iter().map(|body| body.imbalance(&solution.forces)).fold(0.0, f64::hypot);
        let residuals = Residuals {
            equilibrium: imbalance / contact.load,
            newton: norm(&residual),
            ..law_residuals(boundary, &solution.forces, &jumps, 1.0 / contact.unit, contact.load)
        };
        let mut forces = solution.forces.clone();
        for (point, linearization) in boundary.points.iter().zip(&solution.linearizations) {
            if *linearization == Linearization::Open {
                forces[point.rows()].fill(0.0);
            }
        }
        ContactForces::unpack(
            boundary,
            &contact.rows,
            &forces,
            &jumps,
            status,
            residuals,
            Kink::of(boundary, &arguments),
        )
    }
}
