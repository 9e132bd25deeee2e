//! The limits of a scene in a certificate, computed again.

use contact::cost::{Limit, VolumeLimits};
use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use nonsmooth::{Certificate, CompositeProof, ConstraintKind, Vector};
use serde::Serialize;

/// Largest difference of the norm, in norms of its subgradients, and of the error, in values of Θ, that is rounding.
pub const MAX_ROUNDING: f64 = 1e-8;

/// A number of the certificate, and the same number computed again.
#[derive(Debug, Serialize)]
pub struct Number {
    pub recorded: f64,
    pub recomputed: f64,
    /// Largest difference that counts as rounding.
    pub rounding: f64,
    pub agrees: bool,
}

impl Number {
    pub fn new(recorded: f64, recomputed: f64, rounding: f64) -> Self {
        Self { recorded, recomputed, rounding, agrees: (recorded - recomputed).abs() <= rounding }
    }
}

/// A limit in a certificate.
#[derive(Debug, Serialize)]
pub struct LimitCheck {
    /// The limited quantity.
    pub quantity: &'static str,
    /// The value of the constraint, in the unit of the quantity: recorded, and computed from the pressures behind the
    /// composite proof, where there is one, or from the mesh.
    pub excess: Number,
    pub multiplier: f64,
    /// Largest difference of the linearizations at the point from rows of the Jacobian of the pressures, or from the
    /// derivative of the volume, relative to their sizes.
    pub cuts: f64,
    pub agrees: bool,
}

impl LimitCheck {
    /// The limits in the certificate; none if it does not hold these.
    pub fn all(
        certificate: &Certificate,
        limits: &[Limit],
        problem: &ContactProblem,
    ) -> Result<Option<Vec<Self>>, SceneError> {
        let ordered = Limit::in_order(limits);
        let shape = VolumeLimits::new(&ordered, problem)?.constraints(problem, &certificate.point);
        let first = ordered.len() - shape.len();
        let kinds: Vec<ConstraintKind> = ordered.iter().map(Limit::kind).collect();
        let Some(proof) = certificate.constraints.as_ref().filter(|proof| proof.kinds == kinds) else {
            return Ok(None);
        };
        let multipliers = proof.multipliers();
        let check = |(index, limit): (usize, &Limit)| {
            let recorded = proof.values[index];
            let composite = certificate.composite.as_ref();
            let count = problem.boundary.points.len();
            let own = index.checked_sub(first).map(|index| &shape[index]);
            let peak = || {
                composite.map(|composite| {
                    composite.outputs.iter().rev().take(count).copied().fold(f64::NEG_INFINITY, f64::max) - limit.bound
                })
            };
            let recomputed = own.map(|(value, _)| *value).or_else(peak).unwrap_or(recorded);
            let excess = Number::new(recorded, recomputed, MAX_ROUNDING * limit.bound);
            let at_point = proof.cuts.iter().filter(|cut| cut.constraint == index && cut.point == certificate.point);
            let difference = |cut: &nonsmooth::report::ConstraintCut| match (own, composite) {
                (Some((_, slope)), _) => (slope - &cut.subgradient).norm() / slope.norm().max(f64::MIN_POSITIVE),
                (None, Some(composite)) => nearest_row((cut.value, &cut.subgradient), composite, count, limit.bound),
                (None, None) => 0.0,
            };
            let cuts = at_point.map(difference).fold(0.0, f64::max);
            let agrees = excess.agrees && cuts <= MAX_ROUNDING;
            Self { quantity: limit.quantity.name(), excess, multiplier: multipliers[index], cuts, agrees }
        };
        Ok(Some(ordered.iter().enumerate().map(check).collect()))
    }
}

/// The relative difference of a linearization at the point from that of the node that is nearest to it.
fn nearest_row((value, subgradient): (f64, &Vector), composite: &CompositeProof, count: usize, limit: f64) -> f64 {
    let size = subgradient.norm().max(f64::MIN_POSITIVE);
    // The pressures are the last outputs.
    let first = composite.outputs.len().saturating_sub(count);
    let rows = composite.outputs.iter().zip(composite.jacobian.row_iter()).skip(first);
    rows.map(|(pressure, row)| {
        let slope = (row.transpose() - subgradient).norm() / size;
        slope.max((pressure - limit - value).abs() / limit)
    })
    .fold(f64::INFINITY, f64::min)
}
