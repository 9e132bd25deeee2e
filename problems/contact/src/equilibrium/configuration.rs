//! One shape of a problem before a contact solver works on it.

use crate::body::mesh::Block;
use crate::equilibrium::modes::{Motion, RigidScene};
use crate::equilibrium::{ContactProblem, Stage};
use crate::error::ContactError;

/// Rounding of a gap over the larger height of its node: both heights are sums of a few products.
const GAP_ROUNDING: f64 = 32.0 * f64::EPSILON;

/// The undeformed configuration of a shape, checked to have an equilibrium as rigid bodies.
#[derive(Debug)]
pub struct Configuration {
    /// The bodies, lower first.
    pub blocks: Vec<Block>,
    /// The scene as the rigid body analysis takes it.
    pub rigid: RigidScene,
    /// Motions that nothing holds and that the load does not drive.
    pub grounded: Vec<Motion>,
    /// Initial gap per contact node, mm. Without loads, overlaps that rounding explains are 0 where there is no other.
    pub gaps: Vec<f64>,
}

impl Configuration {
    /// The configuration of given controls.
    ///
    /// # Errors
    /// [`ContactError::InvertedElement`], [`ContactError::NoEquilibrium`].
    pub fn new(problem: &ContactProblem, controls: &[f64]) -> Result<Self, ContactError> {
        Self::of(problem, problem.blocks(controls)?)
    }

    /// The configuration of given bodies, lower first.
    ///
    /// # Errors
    /// [`ContactError::NoEquilibrium`].
    pub fn of(problem: &ContactProblem, blocks: Vec<Block>) -> Result<Self, ContactError> {
        Stage::Equilibrium.enter()?;
        let rigid = problem.rigid_scene(&blocks);
        let grounded = rigid.analyse(&problem.boundary)?;
        let mut gaps = problem.gaps(&blocks[0]);
        if rigid.total_load() == 0.0 {
            let rounding = |(gap, height): (&f64, &f64)| -gap <= GAP_ROUNDING * height.abs().max((height + gap).abs());
            if gaps.iter().zip(&blocks[0].upper).all(rounding) {
                // Bodies that just touch are at rest: rounding would press them together.
                gaps.iter_mut().for_each(|gap| *gap = gap.max(0.0));
            }
        }
        Ok(Self { blocks, rigid, grounded, gaps })
    }

    /// Force that residuals are relative to, N: the loads, and what a contact stiffness (N/mm) makes of the
    /// penetration. Zero for bodies at rest.
    pub fn load(&self, stiffness: f64) -> f64 {
        let penetration: f64 = self.gaps.iter().map(|gap| (-gap).max(0.0)).sum();
        self.rigid.total_load() + stiffness * penetration
    }
}
