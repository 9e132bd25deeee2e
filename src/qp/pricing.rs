//! Pricing: the violated side farthest from the current step.

use super::sides::Member;
use super::working_set::{Side, WorkingSet};

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

impl Violation {
    /// The violated side of largest distance among those not skipped.
    pub(super) fn largest(set: &WorkingSet<'_>, skipped: &[Member]) -> Option<Self> {
        let (sides, mut largest) = (&set.sides, None);
        let mut consider = |member: Member, norm: f64| {
            let (value, (lower, upper)) = (set.value(member), sides.interval(member));
            let (excess, side, bound) =
                if value > upper { (value - upper, Side::Upper, upper) } else { (lower - value, Side::Lower, lower) };
            let is_less = |known: Self| excess <= known.distance * norm;
            if excess <= 0.0 || largest.is_some_and(is_less) || skipped.contains(&member) {
                return;
            }
            let own_size = set.size(member, bound);
            let size = if member.is_cut() { own_size.min(set.smallest_cut_size) } else { own_size };
            let satisfied = (SATISFIED * size).max(ROUNDING * set.terms(member, bound));
            let relative = excess / set.data_size(member, bound);
            if excess > satisfied && !set.is_held(member) {
                let side = if lower == upper { Side::Both } else { side };
                largest = Some(Self { member, side, relative, distance: excess / norm });
            }
        };
        for member in (0..sides.qp.slopes.len()).map(Member::Cut) {
            consider(member, sides.norm(member).hypot(sides.cut_entry));
        }
        for member in (0..sides.qp.rows.nrows()).map(Member::Row) {
            consider(member, sides.norm(member).max(f64::MIN_POSITIVE));
        }
        for member in (0..sides.qp.dimension()).map(Member::Bound) {
            consider(member, sides.norm(member));
        }
        largest
    }
}
