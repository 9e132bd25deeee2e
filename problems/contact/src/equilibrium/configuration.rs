//! One shape of a problem before a contact solver works on it.

use crate::equilibrium::certificate::law_residuals;
use crate::equilibrium::modes::{Motion, RigidScene};
use crate::equilibrium::{ContactBoundary, ContactPoint, ContactProblem, ContactRows, Residuals, Stage};
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

    /// The residuals of packed contact forces, N, and jumps, mm, whatever solver found them; without the residual of
    /// its own iteration. `bound`: the mean stiffness of a contact node, N/mm, where bodies bend and resist less than
    /// E*√A.
    pub(crate) fn residuals(&self, problem: &ContactProblem, forces: &[f64], jumps: &[f64], bound: f64) -> Residuals {
        let nodes = problem.contact_moduli.iter().zip(&self.rows.nodes);
        let stiffness = nodes.map(|(modulus, node)| bound.min(modulus * node.area.max(0.0).sqrt()));
        let stiffness: Vec<f64> = stiffness.collect();
        let unit = self.unit(stiffness.iter().sum::<f64>() / stiffness.len() as f64).of(&problem.boundary, forces);
        let imbalance = self.rigid.imbalance(&problem.boundary, forces);
        let equilibrium = if unit > 0.0 { imbalance / unit } else { 0.0 };
        Residuals { equilibrium, ..law_residuals(&problem.boundary, forces, jumps, &stiffness, unit) }
    }

    /// What forces are measured by, for the mean stiffness of a contact node, N/mm. Zero for bodies at rest.
    pub(crate) fn unit(&self, stiffness: f64) -> ForceUnit {
        let penetration: f64 = self.rows.gaps().map(|gap| (-gap).max(0.0)).sum();
        ForceUnit { loads: self.rigid.total_load(), approach: stiffness * (penetration + self.prescribed) }
    }
}

/// What residuals are relative to, N.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForceUnit {
    /// Σ|f| over the loads.
    loads: f64,
    /// What a contact stiffness makes of the penetration, and of the largest displacement that supports prescribe.
    approach: f64,
}

/// Share of the loads that contact forces amount to at least: fewer are few digits of them.
const LEAST_OF_LOADS: f64 = 1e-4;
/// Share of what the approach of the bodies would press out of them at rest that contact forces amount to at least.
const LEAST_OF_APPROACH: f64 = 1e-7;

impl ForceUnit {
    /// The unit before any contact force is known: an upper bound, since motions may take an approach away.
    pub(crate) fn first(self) -> f64 {
        self.loads + self.approach
    }

    /// The unit of packed contact forces, N: their normal parts together.
    pub(crate) fn of(self, boundary: &ContactBoundary, forces: &[f64]) -> f64 {
        let normal: f64 = boundary.points.iter().map(|point| forces[point.start].abs()).sum();
        normal.max(LEAST_OF_LOADS * self.loads).max(LEAST_OF_APPROACH * self.approach)
    }

    /// The unit of the forces found in a larger one, where it is so much smaller that they have to be found anew.
    pub(crate) fn finer(self, boundary: &ContactBoundary, forces: &[f64], unit: f64) -> Option<f64> {
        Some(self.of(boundary, forces)).filter(|finer| *finer < COARSE * unit)
    }
}

/// Share of a unit of which a smaller one differs in no digit that matters.
const COARSE: f64 = 0.3;
