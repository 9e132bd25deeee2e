//! Pricing: the violated side farthest from the current step.

use super::kernels::dot;
use super::working_set::{Member, Side, WorkingSet};

/// A side counts as satisfied if its excess is below this share of its size.
const SATISFIED: f64 = 2e-14;

/// An excess below this share of the terms of a side cannot be told from rounding.
const ROUNDING: f64 = 2e-15;

/// A violated side of a cut, row or bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Violation {
    pub(super) member: Member,
    pub(super) side: Side,
    /// Excess relative to the size of its terms and of the sides of the problem.
    pub(super) relative: f64,
    /// Excess over the norm of the normal: a distance.
    distance: f64,
}

impl WorkingSet<'_> {
    /// The violated side of largest distance among those not skipped.
    pub(super) fn most_violated(&self, skipped: &[Member]) -> Option<Violation> {
        let mut worst: Option<Violation> = None;
        let mut consider = |member: Member, value: f64, norm: f64| {
            let (lower, upper) = self.interval(member);
            let (excess, side) =
                if value > upper { (value - upper, Side::Upper) } else { (lower - value, Side::Lower) };
            if excess <= 0.0 || worst.is_some_and(|worst| excess <= worst.distance * norm) || skipped.contains(&member)
            {
                return;
            }
            let bound = if side == Side::Upper { upper } else { lower };
            let own_size = self.size(member, bound);
            let size = if matches!(member, Member::Cut(_)) { own_size.min(self.smallest_cut_size) } else { own_size };
            let satisfied = (SATISFIED * size).max(ROUNDING * self.terms(member, bound));
            let relative = excess / self.data_size(member, bound);
            if excess > satisfied && !self.is_held(member) {
                let side = if lower == upper { Side::Both } else { side };
                worst = Some(Violation { member, side, relative, distance: excess / norm });
            }
        };
        let cuts = self.qp.slopes.len();
        for (j, slope) in self.qp.slopes.iter().enumerate() {
            let value = dot(slope.as_slice(), self.step.as_slice()) - self.epigraph;
            consider(Member::Cut(j), value, self.norms[j].hypot(self.cut_entry));
        }
        for i in 0..self.qp.rows.nrows() {
            let norm = self.norms[cuts + i].max(f64::MIN_POSITIVE);
            consider(Member::Row(i), self.value(Member::Row(i)), norm);
        }
        for k in 0..self.qp.dimension() {
            consider(Member::Bound(k), self.step[k], self.qp.metric.diagonal_entry(k).sqrt().recip());
        }
        worst
    }
}
