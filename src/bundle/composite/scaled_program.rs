//! The subproblem of an outer function built from cones, in units in which its numbers are of order one.
//!
//! ```text
//! d = D d̂,  c = σ ĉ,  t = σ^p t̂,   σ = max|c_i|,  τ = max μ σ^p,   D_kk = min(σ/max_i|G_ik|, (τ/(B + u W)_kk)^(1/2))
//! ```

use super::model::CompositeModel;
use crate::bundle::proposers::subproblem::Room;
use crate::composite::{ConeFunction, Epigraph, EpigraphTerm};
use crate::qp::interior_point::{ScaledSide, push_set};
use crate::{Matrix, Vector};

/// The last iterate of the method, of any quality: the caller checks it by weak duality.
pub(super) struct ConeAnswer {
    pub step: Vector,
    /// The weights w of the outputs.
    pub weights: Vector,
    /// Multipliers of the rows and of the bounds, > 0 at an upper side and < 0 at a lower one.
    pub sides: (Vector, Vector),
}

/// The units of the program: of d, of the outputs and of h.
pub(super) struct Units {
    /// The diagonal of D.
    pub steps: Vector,
    /// σ.
    pub outputs: f64,
    /// τ.
    pub value: f64,
}

/// The sides of U around the base, in units of the steps.
pub(super) fn sides_of(model: &CompositeModel<'_>, units: &Units) -> Vec<ScaledSide> {
    let (room, rows) = (Room::around(model.set, model.base), model.set.rows());
    let mut sides = vec![];
    let (of_rows, bounds) = ((&room.rows.0, &room.rows.1), (&room.bounds.0, &room.bounds.1));
    push_set(&mut sides, rows, of_rows, bounds, |entry, k| entry * units.steps[k]);
    sides
}

/// The slopes of the pull to the origin and of the linear terms of h, in the units of the program.
pub(super) fn linear_part(model: &CompositeModel<'_>, epigraph: &Epigraph, units: &Units) -> Vector {
    let mut slope = model.pull_to_origin();
    for term in epigraph.terms().iter().filter(|term| term.function == ConeFunction::Linear && term.weight != 0.0) {
        for output in term.outputs.clone() {
            slope.axpy(term.weight, &model.linearization.jacobian.row(output).transpose(), 1.0);
        }
    }
    slope.component_mul(&units.steps) / units.value
}

/// The multipliers of the rows and of the bounds.
pub(super) fn multipliers(
    sides: &[ScaledSide],
    z: &[f64],
    model: &CompositeModel<'_>,
    units: &Units,
) -> (Vector, Vector) {
    let mut multipliers = (Vector::zeros(model.set.rows().nrows()), Vector::zeros(model.base.len()));
    for (side, &z) in sides.iter().zip(z) {
        side.add_multiplier(z, units.value, &mut multipliers);
    }
    multipliers
}

impl ConeAnswer {
    pub(super) fn finite(step: Vector, weights: Vector, sides: (Vector, Vector)) -> Option<Self> {
        let mut entries = step.iter().chain(weights.iter()).chain(sides.0.iter()).chain(sides.1.iter());
        entries.all(|entry| entry.is_finite()).then_some(Self { step, weights, sides })
    }
}

impl Units {
    /// The units of terms, linear ones left out.
    pub(super) fn of_terms(outputs: &Vector, jacobian: &Matrix, metric: &Matrix, epigraph: &Epigraph) -> Self {
        let terms = || epigraph.terms().iter().filter(|term| term.function != ConeFunction::Linear);
        let rows: Vec<usize> = terms().flat_map(|term| term.outputs.clone()).collect();
        let size = unit(rows.iter().map(|&i| outputs[i].abs()));
        let value = terms().map(|term| term.weight * size.powf(exponent(term))).fold(0.0, f64::max);
        let largest = |k: usize| rows.iter().map(|&i| jacobian[(i, k)].abs()).fold(0.0, f64::max);
        Self::new(size, value, metric, largest)
    }

    /// The units for sizes of outputs and of h, and the largest derivative of an output along every variable.
    pub(super) fn new(outputs: f64, value: f64, metric: &Matrix, largest: impl Fn(usize) -> f64) -> Self {
        let step = |k: usize| (outputs / largest(k)).min((value / metric[(k, k)]).sqrt());
        Self { steps: Vector::from_fn(metric.nrows(), |k, _| step(k)), outputs, value }
    }
}

/// The largest size; where all vanish, the unit is free.
pub(super) fn unit(sizes: impl Iterator<Item = f64>) -> f64 {
    let largest = sizes.fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// p: by which power of the outputs a term grows.
pub(super) fn exponent(term: &EpigraphTerm) -> f64 {
    if let ConeFunction::Powers { exponent } = term.function { exponent } else { 1.0 }
}
