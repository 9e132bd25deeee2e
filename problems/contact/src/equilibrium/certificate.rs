//! Residual certificates of a contact state and its distance to the nearest kink.

use crate::equilibrium::law::tangential_norm;
use crate::equilibrium::{ContactBoundary, ContactPoint};
use crate::error::ContactError;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Factor by which other residuals of an iterate, in other norms, may exceed its Newton residual.
const OTHER_NORMS: f64 = 10.0;

/// Largest residual of a state that any solver returns, unless a coarser one is asked for.
pub const MAX_RESIDUAL: f64 = 1e-8;

/// Relative residuals of (3.1)–(3.3), recomputed from the final state; dimensionless. Forces are relative to the
/// contact forces, displacements of a contact node are times its stiffness c = E*√A, with the plane modulus E* of the
/// bodies in series and the area A of the node, or the mean stiffness of the nodes where that is smaller.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Residuals {
    /// Resultant of loads and contact forces along the motions that supports leave free, over the total load.
    pub equilibrium: f64,
    /// Largest of |min(λ_N, c·(remaining gap))| over the total load.
    pub complementarity: f64,
    /// Largest excess of |λ_T| over 𝓕λ_N, over the total load.
    pub friction_cone: f64,
    /// Largest defect of the dissipation, c·|𝓕λ_N|slip| − λ_T·slip| over the square of the load: zero in stick (no
    /// slip) and in aligned slip.
    pub dissipation: f64,
    /// |(c (B_E u − c_E), λ − Π(λ + c(B u − g)))|₂ over the load with the solver's own c: what its iteration drives to
    /// zero.
    pub newton: f64,
}

impl Residuals {
    /// The largest of all residuals; NaN if one is not a number.
    pub fn largest(&self) -> f64 {
        [self.equilibrium, self.complementarity, self.friction_cone, self.dissipation, self.newton].into_iter().fold(
            0.0,
            |largest: f64, value| if value.is_nan() || largest.is_nan() { f64::NAN } else { largest.max(value) },
        )
    }

    /// Refuses a state whose largest residual is above both [`MAX_RESIDUAL`] and ten times `allowed`, the Newton
    /// residual asked for: the other residuals are measured in other norms.
    ///
    /// # Errors
    /// [`ContactError::Inaccurate`] with the residuals.
    pub fn check(&self, allowed: f64) -> Result<(), ContactError> {
        self.within((OTHER_NORMS * allowed).max(MAX_RESIDUAL))
    }

    /// Refuses residuals above what is allowed.
    ///
    /// # Errors
    /// [`ContactError::Inaccurate`] with the residuals.
    pub(crate) fn within(&self, allowed: f64) -> Result<(), ContactError> {
        if self.largest() <= allowed {
            return Ok(());
        }
        Err(ContactError::Inaccurate { residuals: self.to_string(), largest: self.largest(), allowed })
    }
}

impl fmt::Display for Residuals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "equilibrium {:.1e}, complementarity {:.1e}, friction cone {:.1e}, dissipation {:.1e}, Newton {:.1e}",
            self.equilibrium, self.complementarity, self.friction_cone, self.dissipation, self.newton
        )
    }
}

/// How far the state is from the nearest point where S is not differentiable.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Kink {
    /// Smallest over all nodes of |x_N|/max|x_N| and, for closed nodes with friction, ||x_T| − 𝓕x_N|/max(|x_T|, 𝓕x_N),
    /// with x = λ + c(B u − g).
    pub smallest_margin: f64,
    /// Nodes whose margin is at most [`WEAKLY_ACTIVE`]; their derivative is a selection.
    pub weakly_active: usize,
}

/// Relative margin up to which a node counts as weakly active.
pub const WEAKLY_ACTIVE: f64 = 1e-6;

impl Kink {
    /// From the packed projection arguments x of all nodes.
    pub fn of(boundary: &ContactBoundary, arguments: &[f64]) -> Self {
        let largest = boundary.points.iter().map(|point| arguments[point.start].abs()).fold(0.0, f64::max);
        let mut kink = Self { smallest_margin: f64::INFINITY, weakly_active: 0 };
        for point in boundary.points.iter().filter(|point| !point.is_tied) {
            let x = &arguments[point.rows()];
            let mut margin = if largest > 0.0 { x[0].abs() / largest } else { 0.0 };
            if x[0] > 0.0 && x.len() > 1 {
                let (radius, length) = (point.friction * x[0], tangential_norm(x));
                margin = margin.min((length - radius).abs() / length.max(radius));
            }
            kink.smallest_margin = kink.smallest_margin.min(margin);
            kink.weakly_active += usize::from(margin <= WEAKLY_ACTIVE);
        }
        kink
    }
}

/// λ − Π(λ + c w) entry by entry, for packed multipliers λ and jumps w = B u − g; `stiffness` is c.
pub fn projection_residual(boundary: &ContactBoundary, forces: &[f64], jumps: &[f64], stiffness: f64) -> Vec<f64> {
    let mut residual = vec![0.0; boundary.row_count];
    for point in &boundary.points {
        let range = point.rows();
        let x: Vec<f64> = range.clone().map(|row| forces[row] + stiffness * jumps[row]).collect();
        point.project(&x, &mut residual[range.clone()]);
        for row in range {
            residual[row] = forces[row] - residual[row];
        }
    }
    residual
}

/// 𝓕|w_T| + w_N of every contact node, in the unit of the jumps, for the packed jumps w = B u − g of a state in which
/// no node is closed. Any other equilibrium λ satisfies λᵀCλ ≤ Σ λ_N (𝓕|w_T| + w_N), method.md (4.12): only nodes where
/// this is positive can wedge a body in.
pub(crate) fn wedging(boundary: &ContactBoundary, jumps: &[f64]) -> Vec<f64> {
    let of_node = |friction: f64, jump: &[f64]| friction * tangential_norm(jump) + jump[0];
    let of_point = |point: &ContactPoint| match point.is_tied {
        true => 0.0,
        false => of_node(point.friction, &jumps[point.rows()]),
    };
    boundary.points.iter().map(of_point).collect()
}

/// Complementarity, cone and dissipation residuals of packed multipliers, N, and jumps, mm, relative to `load`;
/// `stiffness`: c per contact node, N/mm.
pub(super) fn law_residuals(
    boundary: &ContactBoundary,
    forces: &[f64],
    jumps: &[f64],
    stiffness: &[f64],
    load: f64,
) -> Residuals {
    let mut residuals = Residuals::default();
    for (point, &stiffness) in boundary.points.iter().zip(stiffness) {
        let range = point.rows();
        let (force, jump) = (&forces[range.clone()], &jumps[range]);
        if point.is_tied {
            let largest = jump.iter().fold(0.0, |largest: f64, jump| largest.max(jump.abs()));
            residuals.complementarity = residuals.complementarity.max(stiffness * largest);
            continue;
        }
        let opening = -stiffness * jump[0];
        residuals.complementarity = residuals.complementarity.max(force[0].min(opening).abs());
        if force.len() > 1 {
            let (traction, slip) = (tangential_norm(force), stiffness * tangential_norm(jump));
            let bound = point.friction * force[0].max(0.0);
            residuals.friction_cone = residuals.friction_cone.max(traction - bound);
            if force[0] > 0.0 {
                let power: f64 = force[1..].iter().zip(&jump[1..]).map(|(f, j)| f * j * stiffness).sum();
                // In contact λ_T·s = 𝓕λ_N|s|; both stick (s = 0) and slip (aligned) satisfy it.
                residuals.dissipation = residuals.dissipation.max((bound * slip - power).abs());
            }
        }
    }
    if load > 0.0 {
        residuals.complementarity /= load;
        residuals.friction_cone /= load;
        residuals.dissipation /= load * load;
    }
    residuals
}
