//! Kinks of the outputs: where they are met, the model gives way to the cuts.
//!
//! ```text
//! G, G' the Jacobians at x and x + d:    share = Σ ω_i |c'_i − c_i − (½(G + G')d)_i| / Σ ω_i |c'_i − c_i − (G d)_i|,   ω = |w| + |w'|
//! ```
//! Where c is smooth, the trapezoidal rule leaves a departure of third order in d only; it does not remove that of a
//! kink. A step that does not pay and leaves a share has met kinks. From here the model would go on in steps so short
//! that they stay within a piece, each of them serious and none of them worth its evaluation, so that the model falls
//! silent at once. The evaluations that the cuts then ask for tell, at no cost, when the outputs follow their
//! linearization again.

use super::base::Base;
use crate::Vector;
use crate::composite::{Linearization, OuterFunction};
use crate::panics::without_panic;

/// Beyond this share, a departure counts as that of kinks.
const LEAST_SHARE: f64 = 0.2;
/// Departures that are at most this share of the outputs are their rounding.
const ROUNDING: f64 = 1e-11;
/// After so many steps in a row that have paid, one that does not is forgiven.
const FORGIVING: usize = 3;

/// What the steps of the model have told about kinks.
#[derive(Debug, Default)]
pub(super) struct Kinks {
    /// The largest decrease promised by steps that have met kinks, since a step last paid.
    promised: f64,
    /// Steps in a row that have paid.
    paid: usize,
    /// Whether the model is silent because of kinks.
    silent: bool,
}

/// A point at which Θ was evaluated, as seen from the point where the model is built.
pub(super) struct Seen<'a> {
    pub outer: &'a dyn OuterFunction,
    pub base: &'a Base,
    pub point: &'a Vector,
    /// Θ(x + d) − Θ(x).
    pub change: f64,
    /// Outputs and Jacobian at the point, if they are known.
    pub end: Option<&'a Linearization>,
}

impl Seen<'_> {
    /// The share of the departure that the trapezoidal rule leaves; 0 where the Jacobian at the point is not known.
    fn share(&self) -> f64 {
        let (start, Some(end)) = (&self.base.linearization, self.end) else { return 0.0 };
        if start.jacobian.shape() != end.jacobian.shape() {
            return 0.0;
        }
        let weights = |outputs| without_panic(|| self.outer.subgradient(outputs)).unwrap_or_default();
        let (first, last) = (weights(&start.outputs), weights(&end.outputs));
        if [first.len(), last.len()] != [start.outputs.len(); 2] {
            return 0.0;
        }
        let step = self.point - &self.base.point;
        let (ahead, behind) = (&start.jacobian * &step, &end.jacobian * &step);
        let (change, weights) = (&end.outputs - &start.outputs, first.abs() + last.abs());
        let linear = weights.dot(&(&change - &ahead).abs());
        let trapezoidal = weights.dot(&(&change - (&ahead + behind) * 0.5).abs());
        // The departure of outputs that are linear is rounding, which no rule removes.
        let sizes = weights.dot(&(start.outputs.abs() + end.outputs.abs()));
        if linear > ROUNDING * sizes { trapezoidal / linear } else { 0.0 }
    }

    /// Whether the model predicts the change of Θ to a tenth: the outputs follow their linearization.
    fn is_predicted(&self) -> bool {
        let Base { point, value, linearization } = self.base;
        let outputs = &linearization.outputs + &linearization.jacobian * (self.point - point);
        let model = without_panic(|| self.outer.value(&outputs)).unwrap_or(f64::NAN) - value;
        10.0 * (self.change - model).abs() <= self.change.abs()
    }
}

impl Kinks {
    /// Learns from a step of the model itself that promised a decrease and has brought one, if it was serious: of the
    /// merit, where there are constraints. It pays if it brings half of the largest decrease promised since a step last
    /// paid. Returns whether the model should fall silent because of kinks.
    pub(super) fn met(&mut self, seen: &Seen<'_>, promised: f64, brought: Option<f64>) -> bool {
        let promised = promised.max(self.promised);
        if brought.is_some_and(|decrease| decrease >= 0.5 * promised) {
            *self = Self { paid: self.paid + 1, ..Self::default() };
            return false;
        }
        if seen.share() <= LEAST_SHARE {
            return false;
        }
        let forgiven = self.paid >= FORGIVING;
        *self = Self { promised, paid: 0, silent: self.silent || !forgiven };
        !forgiven
    }

    /// Whether a point that the cuts asked for shows that the model had better remain silent.
    pub(super) fn remain(&self, seen: &Seen<'_>) -> bool {
        self.silent && !seen.is_predicted()
    }
}
