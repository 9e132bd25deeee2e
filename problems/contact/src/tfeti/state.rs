//! A shape solved by total FETI, with all that its derivative needs.

use crate::equilibrium::{ContactRows, ContactWarmStart};
use crate::shape::Positions;
use crate::tfeti::derivative::SolvedShape;
use crate::tfeti::dual::{CoarseSpace, TornSolution};
use crate::tfeti::torn::{Constraints, TornSystem, TornVector};
use std::sync::Arc;

/// A solved shape with all that its derivative needs.
#[derive(Debug)]
pub struct TornState {
    /// Positions of the nodes of all bodies.
    pub(crate) positions: Positions,
    pub(super) rows: Arc<ContactRows>,
    pub(super) system: TornSystem,
    pub(super) space: CoarseSpace,
    pub(super) constraints: Arc<Constraints>,
    pub(super) solution: TornSolution,
    pub(super) displacement: TornVector,
    pub(super) stiffness: f64,
    /// Force that residuals are relative to, N; zero for bodies at rest.
    pub(super) load: f64,
}

impl TornState {
    pub(super) fn shape(&self) -> SolvedShape<'_> {
        SolvedShape {
            positions: &self.positions,
            rows: &self.rows,
            displacement: &self.displacement,
            multipliers: &self.solution.iterate.multipliers,
        }
    }

    /// Displacements over the torn dofs of this process, then its ghosts, mm.
    pub fn displacement(&self) -> &[f64] {
        &self.displacement.0
    }

    /// λ over all rows, from which a similar shape can be solved. Where there are several processes, all of them call
    /// it.
    pub fn warm_start(&self) -> ContactWarmStart {
        ContactWarmStart::Multipliers(
            self.constraints.whole(&self.solution.iterate.multipliers, &self.space.distribution),
        )
    }
}
