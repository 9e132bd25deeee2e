//! Where an iteration starts: the bonded problem, or the forces of a similar problem.
//!
//! ```text
//! bonded:    contact rows glued where c·gap is within reach of the load, solved roughly;   nodes beyond stay open
//! balanced:  given forces, changed as little as the resultants e ask for;   amplitudes by least squares on the held rows
//! ```

use crate::equilibrium::law::{Friction, Linearization, tangential_norm};
use crate::error::ContactError;
use crate::tfeti::dual::{Iterate, TornContact};
use crate::tfeti::newton::linear_solve::LinearAccuracy;
use crate::tfeti::newton::recycling::Recycled;
use crate::tfeti::torn::RowVector;

/// c·gap over load up to which a node may start closed.
const REACH: f64 = 100.0;
/// Relative distance to the slip bound below which a traction counts as sliding.
const ON_THE_CONE: f64 = 1e-9;

impl TornContact<'_> {
    /// The iterate that a solve begins with: the forces of a similar problem (over all rows) where they hold this
    /// shape, else the bonded problem.
    pub(crate) fn start(
        &self,
        forces: Option<&[f64]>,
        max_products: usize,
        recycled: Option<&mut Recycled>,
    ) -> Result<Iterate, ContactError> {
        if let Some(forces) = forces {
            let forces = self.operator.model.constraints.row_vector(forces)?;
            match self.balanced(&forces, &self.slip_bounds(forces.contact())) {
                // Forces that hold the old shape but not the new one are no start.
                Err(ContactError::Unheld { .. }) => {}
                balanced => return balanced,
            }
        }
        self.bonded(LinearAccuracy::start(max_products), recycled)
    }

    /// The bonded problem: contact rows glued, solved roughly. A node that only forces out of all proportion to the
    /// load could close starts open; where bodies have to travel to meet, the nodes that meet first start closed.
    pub(crate) fn bonded(
        &self,
        accuracy: LinearAccuracy,
        recycled: Option<&mut Recycled>,
    ) -> Result<Iterate, ContactError> {
        let reach = REACH * self.load / self.stiffness;
        let nearest = self.rows.gaps().fold(f64::INFINITY, f64::min);
        let within = |reach: f64| -> Vec<Linearization> {
            let close = |gap: f64| if gap <= reach { Linearization::Stick } else { Linearization::Open };
            self.rows.gaps().map(close).collect()
        };
        let active = match self.active_set(within(reach), Friction::Coulomb) {
            Err(ContactError::Unheld { .. }) => {
                self.held(within(nearest.max(0.0) + reach), || self.rows.gaps().map(|gap| -gap).collect())?
            }
            active => active?,
        };
        self.linear_solve(&active, &self.zeros(), accuracy, recycled)
    }

    /// Ψ = 𝓕 max(0, λ_N) per contact node, of packed contact rows.
    pub(crate) fn slip_bounds(&self, forces: &[f64]) -> Vec<f64> {
        self.boundary.points.iter().map(|point| point.friction * forces[point.start].max(0.0)).collect()
    }

    /// Given multipliers, balanced, with their image, and amplitudes by least squares on the held rows; `bounds`: slip
    /// bound per contact node.
    ///
    /// # Errors
    /// [`ContactError::Unheld`] when the nodes that carry forces leave a motion free.
    pub(crate) fn balanced(&self, multipliers: &RowVector, bounds: &[f64]) -> Result<Iterate, ContactError> {
        let statuses: Vec<Linearization> = (self.boundary.points.iter().zip(bounds))
            .map(|(point, &bound)| suggested(&multipliers.contact()[point.rows()], bound))
            .collect();
        let glued = |status| if status == Linearization::Open { status } else { Linearization::Stick };
        let closed = self.active_set(statuses.iter().copied().map(glued).collect(), Friction::Tresca)?;
        let mut unknowns = closed.rows.unknowns_of(multipliers);
        closed.enforce(&mut unknowns, self.space.resultants());
        let multipliers = closed.rows.trial(&unknowns);
        let image = self.operator.apply(&multipliers);
        let held = self.active_set(statuses, Friction::Tresca)?;
        let amplitudes = held.amplitudes(&held.rows.test_transposed(&self.rest(&image)));
        Ok(self.iterate(multipliers, image, amplitudes))
    }
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
