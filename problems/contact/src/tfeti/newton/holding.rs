//! Active sets that hold every rigid motion, and the start of the iteration.
//!
//! ```text
//! an active set may leave a motion free on the way:   slip → stick, then the open nodes nearest to contact are closed,
//!                                                     3, 6, 12, …, until G_T Gqᵀ is regular
//! start: bonded where c·gap is within reach of the load;   nodes beyond it stay open
//! ```
//! Only directions of search are affected: the residual, and with it the certificate, knows nothing of the closed nodes.

use crate::equilibrium::law::Linearization;
use crate::error::ContactError;
use crate::tfeti::ReducedRows;
use crate::tfeti::dual::coarse_space::CoarseProblem;
use crate::tfeti::newton::iteration::{Iterate, TornContact, TornSolution};
use crate::tfeti::newton::linear_solve::LinearAccuracy;
use crate::tfeti::newton::recycling::Recycled;

/// c·gap over load up to which a node may start closed.
const REACH: f64 = 100.0;
/// Nodes closed first when an active set leaves a motion free.
const FIRST_CLOSED: usize = 3;

impl TornContact<'_> {
    /// Rows and coarse problem of an active set, enlarged until it holds every motion; open nodes of largest `priority` are
    /// closed first.
    ///
    /// # Errors
    /// [`ContactError::Unheld`] when even all nodes closed leave a motion free.
    pub(crate) fn held(
        &self,
        linearizations: Vec<Linearization>,
        priority: impl Fn() -> Vec<f64>,
    ) -> Result<(ReducedRows<'_>, CoarseProblem<'_>), ContactError> {
        let rows = self.reduced(linearizations);
        let mut failure = match self.coarse(&rows, true) {
            Ok(coarse) => return Ok((rows, coarse)),
            Err(failure @ ContactError::Unheld { .. }) => failure,
            Err(other) => return Err(other),
        };
        let mut enlarged = rows.linearizations;
        let mut changed = false;
        for linearization in enlarged.iter_mut().filter(|l| matches!(l, Linearization::Slip { .. })) {
            *linearization = Linearization::Stick;
            changed = true;
        }
        let priority = priority();
        let mut order: Vec<usize> = (0..enlarged.len()).filter(|&node| enlarged[node] == Linearization::Open).collect();
        order.sort_by(|&a, &b| priority[b].total_cmp(&priority[a]));
        let mut closed = 0;
        loop {
            if changed {
                let rows = self.reduced(enlarged.clone());
                match self.coarse(&rows, true) {
                    Ok(coarse) => return Ok((rows, coarse)),
                    Err(other) => failure = other,
                }
            }
            if closed == order.len() {
                return Err(failure);
            }
            closed = (2 * closed).max(FIRST_CLOSED).min(order.len());
            order[..closed].iter().for_each(|&node| enlarged[node] = Linearization::Stick);
            changed = true;
        }
    }

    /// Rows and coarse problem of the active set of an iterate.
    pub(crate) fn held_at(&self, iterate: &Iterate) -> Result<(ReducedRows<'_>, CoarseProblem<'_>), ContactError> {
        self.held(self.linearize(iterate), || {
            let arguments = self.arguments(iterate);
            self.boundary.points.iter().map(|point| arguments[point.start]).collect()
        })
    }

    /// The state of bodies that nothing loads and nothing penetrates: no forces, no displacements.
    pub(crate) fn at_rest(&self) -> TornSolution {
        let zero = vec![0.0; self.operator.model.constraints.row_count()];
        let iterate = self.iterate(zero.clone(), zero, vec![0.0; self.space.resultants.len()]);
        let linearizations = self.linearize(&iterate);
        let residual = self.residual(&iterate);
        TornSolution { iterate, linearizations, residual, steps: 0 }
    }

    /// The start that Newton converges from: contact rows glued, solved roughly. Nodes that only forces beyond all
    /// proportion to the load could close start open; where bodies have to travel to meet, the first to meet start closed.
    pub(crate) fn bonded(
        &self,
        accuracy: LinearAccuracy,
        pairs: Option<&mut Recycled>,
    ) -> Result<Iterate, ContactError> {
        let reach = REACH * self.load / self.stiffness;
        let nearest = self.gaps.iter().copied().fold(f64::INFINITY, f64::min);
        let within = |reach: f64| -> Vec<Linearization> {
            let close = |gap: &f64| if *gap <= reach { Linearization::Stick } else { Linearization::Open };
            self.gaps.iter().map(close).collect()
        };
        let start = within(reach);
        let rows = self.reduced(start.clone());
        let start = match self.coarse(&rows, true) {
            Err(ContactError::Unheld { .. }) => within(nearest.max(0.0) + reach),
            _ => start,
        };
        let (rows, coarse) = self.held(start, || self.gaps.iter().map(|gap| -gap).collect())?;
        let zero = vec![0.0; self.operator.model.constraints.row_count()];
        self.linear_solve(&rows, &coarse, &zero, accuracy, pairs)
    }
}
