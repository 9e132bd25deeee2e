//! One shape of a problem before a contact solver works on it.

use crate::equilibrium::modes::{Motion, RigidScene};
use crate::equilibrium::{ContactPoint, ContactProblem, ContactRows, Stage};
use crate::error::ContactError;
use crate::shape::Positions;
use std::sync::Arc;

/// Rounding of a gap over the distance of its node from the origin, or over the gap: both are sums of a few products.
const GAP_ROUNDING: f64 = 32.0 * f64::EPSILON;

/// The undeformed configuration of a shape, checked to have an equilibrium as rigid bodies.
#[derive(Debug)]
pub struct Configuration {
    /// Positions of the nodes of all bodies, lower first, mm.
    pub positions: Positions,
    /// The contact rows. Without loads, overlaps that rounding explains are gaps of 0 where there is no other.
    pub rows: Arc<ContactRows>,
    /// The scene as the rigid body analysis takes it.
    pub rigid: RigidScene,
    /// Motions that nothing holds and that the load does not drive.
    pub grounded: Vec<Motion>,
    /// Largest component of a displacement that supports prescribe, mm.
    prescribed: f64,
}

impl Configuration {
    /// The configuration of given controls.
    ///
    /// # Errors
    /// [`ContactError::InvertedElement`], [`ContactError::NoFoot`], [`ContactError::NoEquilibrium`].
    pub fn new(problem: &ContactProblem, controls: &[f64]) -> Result<Self, ContactError> {
        Self::of(problem, problem.positions(controls)?)
    }

    /// The configuration of given positions.
    ///
    /// # Errors
    /// [`ContactError::NoFoot`], [`ContactError::NoEquilibrium`].
    pub fn of(problem: &ContactProblem, positions: Positions) -> Result<Self, ContactError> {
        Stage::Equilibrium.enter()?;
        let mut rows = problem.rows(&positions)?;
        let rigid = problem.rigid_scene(&positions, &rows);
        let grounded = rigid.analyse(&problem.boundary)?;
        let prescribed = problem.largest_prescribed();
        if rigid.total_load() == 0.0 && prescribed == 0.0 {
            let size = |point: &ContactPoint| {
                positions[point.body][point.node as usize].iter().fold(0.0, |size: f64, x| size.max(x.abs()))
            };
            let nodes = problem.boundary.points.iter().zip(&rows.nodes);
            let mut rounding = nodes.map(|(point, node)| -node.gap <= GAP_ROUNDING * size(point).max(node.gap.abs()));
            if rounding.all(|is_rounding| is_rounding) {
                // Bodies that just touch are at rest: rounding would press them together.
                rows.nodes.iter_mut().for_each(|node| node.gap = node.gap.max(0.0));
            }
        }
        Ok(Self { positions, rows: Arc::new(rows), rigid, grounded, prescribed })
    }

    /// Force that residuals are relative to, N: the loads, and what a contact stiffness (N/mm) makes of the penetration
    /// and of the largest displacement that supports prescribe. Zero for bodies at rest.
    pub fn load(&self, stiffness: f64) -> f64 {
        let penetration: f64 = self.rows.gaps().map(|gap| (-gap).max(0.0)).sum();
        self.rigid.total_load() + stiffness * (penetration + self.prescribed)
    }
}
