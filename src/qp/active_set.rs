//! Dual active-set method on the multipliers.
//!
//! ```text
//! repeat:  solve (equality solution of the working set, wrong signs leave)
//!          price  (violated side of largest distance; none: solved)
//!          enter  (take it in; if its normal depends on those held, exchange it against one of them)
//! ```
//! Every round raises the dual objective, so no working set returns; rounding is met by a cap on the pivots.
//! Reference: \[GoldfarbIdnani1983\], \[Kiwiel1986\] (epigraph form).

use super::equality_step::solve_equalities;
use super::exchange::ExchangeRates;
use super::pricing::Violation;
use super::sides::Member;
use super::working_set::{Active, Place, Side, WorkingSet};
use crate::interruption::interrupted;

/// How a run of the active-set method ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ActiveSetEnd {
    /// Every side is satisfied.
    Solved,
    /// A side cannot be satisfied together with those held.
    Infeasible {
        /// Relative violation of that side.
        violation: f64,
    },
    /// The cap on the pivots was reached, v is no longer finite, or nobody waits for the answer any more.
    Stalled,
}

/// Relative violation above which a contradiction means an empty set; a smaller one is rounding of the data.
const CONTRADICTION: f64 = 1e-9;

enum Entry {
    Held,
    Refused,
}

impl WorkingSet<'_> {
    /// Holds the equalities, the given members and at least one cut; the multipliers of the cuts sum up to one.
    pub(super) fn start(&mut self, warm: &[Active]) {
        for k in 0..self.sides.qp.dimension() {
            self.hold_equality(Member::Bound(k));
        }
        for i in 0..self.sides.qp.rows.nrows() {
            self.hold_equality(Member::Row(i));
        }
        for &active in warm {
            self.hold_remembered(active);
        }
        let sum = self.cut_sum();
        if sum > 0.0 {
            for active in self.general.iter_mut().filter(|active| active.member.is_cut()) {
                active.multiplier /= sum;
            }
        } else {
            self.hold_best_cut();
        }
        self.place_step();
        self.pivots = 0;
    }

    fn hold_equality(&mut self, member: Member) {
        let (lower, upper) = self.sides.interval(member);
        if lower == upper {
            self.try_hold(Active { member, side: Side::Both, multiplier: 0.0 });
        }
    }

    fn hold_remembered(&mut self, active: Active) {
        let (lower, upper) = self.sides.interval(active.member);
        let side = if active.multiplier < 0.0 { Side::Lower } else { Side::Upper };
        let bound = if side == Side::Lower { lower } else { upper };
        if lower == upper {
            let known = self.general.iter_mut().chain(self.fixed.iter_mut().flatten());
            known.filter(|held| held.member == active.member).for_each(|held| held.multiplier = active.multiplier);
        } else if bound.is_finite() {
            self.try_hold(Active { side, ..active });
        }
    }

    /// Starts from the single cut of largest dual value −½ |ã|² − e, where |ã| takes the diagonal of a dense metric
    /// alone.
    fn hold_best_cut(&mut self) {
        let norm = |j: usize| self.sides.norm(Member::Cut(j));
        let value = |j: usize| -0.5 * norm(j) * norm(j) - self.sides.qp.offsets[j];
        let best = (0..self.sides.qp.slopes.len()).max_by(|&i, &j| value(i).total_cmp(&value(j)));
        let Some(best) = best else { return };
        if let Some(held) = self.general.iter_mut().find(|held| held.member == Member::Cut(best)) {
            held.multiplier = 1.0;
            return;
        }
        let active = Active { member: Member::Cut(best), side: Side::Upper, multiplier: 1.0 };
        while !self.try_hold(active) && !self.general.is_empty() {
            self.release(Place::Column(self.general.len() - 1));
        }
    }

    /// Runs to the end.
    pub(super) fn run(&mut self) -> ActiveSetEnd {
        let limit = 100 + 5 * (self.sides.qp.slopes.len() + self.sides.qp.rows.nrows() + self.sides.qp.dimension());
        let mut skipped = Vec::new();
        solve_equalities(self);
        loop {
            if !self.epigraph.is_finite() || self.pivots > limit || interrupted() {
                return ActiveSetEnd::Stalled;
            }
            let Some(violation) = Violation::largest(self, &skipped) else { return ActiveSetEnd::Solved };
            match self.enter(&violation) {
                Entry::Held => solve_equalities(self),
                Entry::Refused if violation.relative > CONTRADICTION && !violation.member.is_cut() => {
                    return ActiveSetEnd::Infeasible { violation: violation.relative };
                }
                Entry::Refused => {}
            }
            if !self.is_held(violation.member) {
                // Rounding, not the problem, asked for this side: do not ask again.
                skipped.push(violation.member);
            }
        }
    }

    /// Takes in a violated side, exchanging held members as long as its normal depends on them.
    fn enter(&mut self, violation: &Violation) -> Entry {
        let mut active = Active { member: violation.member, side: violation.side, multiplier: 0.0 };
        let column = self.column(active.member);
        let below = self.sides.interval(active.member).0 > self.value(active.member);
        let sign = if below { -1.0 } else { 1.0 };
        let unit = self.coordinate(active.member).and_then(|k| self.coordinates.axis_length(k)).unwrap_or(1.0);
        loop {
            let split = self.factor.split(&column);
            if !split.is_dependent() {
                self.hold(active, column, split);
                return Entry::Held;
            }
            let mut rates = ExchangeRates::new(self, &column, &split.coefficients, sign);
            rates.keep_sum(self, if active.member.is_cut() { -1.0 } else { 0.0 });
            let Some((length, place)) = rates.first_block(self) else { return Entry::Refused };
            rates.apply(self, length);
            active.multiplier += sign * length * unit;
            self.release(place);
        }
    }
}
