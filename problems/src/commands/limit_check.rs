//! The limits of a scene in a certificate, computed again.

use contact::cost::LimitSide;
use contact::equilibrium::ContactProblem;
use contact::load_cases::{Bound, CasesCost};
use nonsmooth::{Certificate, CompositeProof, ConstraintKind, Vector};
use serde::Serialize;
use std::ops::Range;

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
    /// The case in which it holds; none for all, or the only one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    /// The value of the constraint, in the unit of the quantity: recorded, and computed from the pressures behind the
    /// composite proof, where there is one, or from the mesh. None for quantities that only states have.
    pub excess: Option<Number>,
    pub multiplier: f64,
    /// Largest difference of the linearizations at the point from rows of the Jacobian of the pressures, or from the
    /// derivative of the volume, relative to their sizes. None for quantities that only states have.
    pub cuts: Option<f64>,
    pub agrees: bool,
}

impl LimitCheck {
    /// The limits in the certificate; none if it does not hold these.
    pub fn all(
        certificate: &Certificate,
        (cost, bounds, problems): (&CasesCost, &[Bound], &[ContactProblem]),
    ) -> Option<Vec<Self>> {
        let kinds: Vec<ConstraintKind> = bounds.iter().map(Bound::kind).collect();
        let proof = certificate.constraints.as_ref().filter(|proof| proof.kinds == kinds)?;
        let multipliers = proof.multipliers();
        let composite = certificate.composite.as_ref();
        let check = |(index, bound): (usize, &Bound)| {
            let limit = &bound.limit;
            let own = bound.of_shape(&problems[bound.case], &certificate.point);
            let range = cost.pressure_range(bound.case);
            let is_peak = limit.quantity.is_peak() && limit.side == LimitSide::AtMost;
            let pressures = composite.filter(|_| is_peak);
            let peak = |composite: &CompositeProof| {
                let pressures = composite.outputs.iter().skip(range.start).take(range.len());
                pressures.copied().fold(f64::NEG_INFINITY, f64::max) - limit.bound
            };
            let recomputed = own.as_ref().map(|(value, _)| *value).or_else(|| pressures.map(peak));
            let rounding = MAX_ROUNDING * limit.scale();
            let excess = recomputed.map(|recomputed| Number::new(proof.values[index], recomputed, rounding));
            let at_point = proof.cuts.iter().filter(|cut| cut.constraint == index && cut.point == certificate.point);
            let difference = |cut: &nonsmooth::ConstraintCut| match (&own, pressures) {
                (Some((_, slope)), _) => Some((slope - &cut.subgradient).norm() / slope.norm().max(f64::MIN_POSITIVE)),
                (None, Some(composite)) => {
                    Some(nearest_row((cut.value, &cut.subgradient), composite, range.clone(), limit.bound))
                }
                (None, None) => None,
            };
            let known = own.is_some() || pressures.is_some();
            let cuts = known.then(|| at_point.filter_map(difference).fold(0.0, f64::max));
            let agrees = excess.as_ref().is_none_or(|excess| excess.agrees);
            let agrees = agrees && cuts.is_none_or(|cuts| cuts <= MAX_ROUNDING);
            let (quantity, case) = (limit.quantity.name(), limit.case.clone());
            Self { quantity, case, excess, multiplier: multipliers[index], cuts, agrees }
        };
        Some(bounds.iter().enumerate().map(check).collect())
    }

    /// The quantity with its case.
    pub fn name(&self) -> String {
        let case = self.case.as_ref().map_or_else(String::new, |case| format!(" in case \"{case}\""));
        format!("{}{case}", self.quantity)
    }
}

/// The relative difference of a linearization at the point from that of the node that is nearest to it; the pressures
/// are the outputs of a range.
fn nearest_row(
    (value, subgradient): (f64, &Vector),
    composite: &CompositeProof,
    range: Range<usize>,
    limit: f64,
) -> f64 {
    let size = subgradient.norm().max(f64::MIN_POSITIVE);
    let rows = composite.outputs.iter().zip(composite.jacobian.row_iter()).skip(range.start).take(range.len());
    rows.map(|(pressure, row)| {
        let slope = (row.transpose() - subgradient).norm() / size;
        slope.max((pressure - limit - value).abs() / limit)
    })
    .fold(f64::INFINITY, f64::min)
}
