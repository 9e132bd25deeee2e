//! Dual active-set method on the multipliers.
//!
//! ```text
//! repeat:  solve (equality solution of the working set, wrong signs leave)
//!          price  (violated side of largest distance; none: solved)
//!          enter  (take it in; if its normal depends on those held, exchange it against one of them)
//! ```
//! Every round raises the dual objective, so no working set returns; rounding is met by a cap on the pivots.
//! Reference: \[GoldfarbIdnani1983\], \[Kiwiel1986\] (epigraph form).

use super::kernels::{add_scaled, norm};
use super::pricing::Violation;
use super::working_set::{Active, Member, Place, Side, WorkingSet};
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

/// Share of the largest rate of an exchange, in the metric's coordinates, up to which a rate is rounding.
const NOISE: f64 = 1e-10;

enum Entry {
    Held,
    Refused,
}

impl WorkingSet<'_> {
    /// Holds the equalities, the given members and at least one cut; the multipliers of the cuts sum up to one.
    pub(super) fn start(&mut self, warm: &[Active]) {
        for k in 0..self.qp.dimension() {
            self.hold_equality(Member::Bound(k));
        }
        for i in 0..self.qp.rows.nrows() {
            self.hold_equality(Member::Row(i));
        }
        for &active in warm {
            self.hold_remembered(active);
        }
        let sum = self.cut_sum();
        if sum > 0.0 {
            for active in self.general.iter_mut().filter(|active| matches!(active.member, Member::Cut(_))) {
                active.multiplier /= sum;
            }
        } else {
            self.hold_best_cut();
        }
        self.place_step();
        self.pivots = 0;
    }

    fn hold_equality(&mut self, member: Member) {
        let (lower, upper) = self.interval(member);
        if lower == upper {
            self.try_hold(Active { member, side: Side::Both, multiplier: 0.0 });
        }
    }

    fn hold_remembered(&mut self, active: Active) {
        let (lower, upper) = self.interval(active.member);
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
        let value = |j: usize| -0.5 * self.norms[j] * self.norms[j] - self.qp.offsets[j];
        let best = (0..self.qp.slopes.len()).max_by(|&i, &j| value(i).total_cmp(&value(j)));
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
        let limit = 100 + 5 * (self.qp.slopes.len() + self.qp.rows.nrows() + self.qp.dimension());
        let mut skipped = Vec::new();
        self.solve_equalities();
        loop {
            if !self.epigraph.is_finite() || self.pivots > limit || interrupted() {
                return ActiveSetEnd::Stalled;
            }
            let Some(violation) = self.most_violated(&skipped) else { return ActiveSetEnd::Solved };
            match self.enter(&violation) {
                Entry::Held => self.solve_equalities(),
                Entry::Refused if violation.relative > CONTRADICTION && !matches!(violation.member, Member::Cut(_)) => {
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
        let below = self.interval(active.member).0 > self.value(active.member);
        let sign = if below { -1.0 } else { 1.0 };
        let unit = self.coordinate(active.member).and_then(|k| self.coordinates.axis_length(k)).unwrap_or(1.0);
        loop {
            let split = self.factor.split(&column);
            if !split.is_dependent() {
                self.hold(active, column, split);
                return Entry::Held;
            }
            let mut rates = self.exchange_rates(&column, &split.coefficients, sign);
            self.keep_sum(&mut rates, if matches!(active.member, Member::Cut(_)) { -1.0 } else { 0.0 });
            let Some((length, place)) = self.exchange_block(&rates) else { return Entry::Refused };
            self.exchange(&rates, length);
            active.multiplier += sign * length * unit;
            self.release(place);
        }
    }

    /// Changes of the held multipliers per unit of a dependent side's multiplier, in the metric's coordinates:
    /// R x = −Qᵀ ã gives them for the columns, what remains of the normal gives them for the fixed coordinates.
    fn exchange_rates(&self, column: &[f64], coefficients: &[f64], sign: f64) -> ExchangeRates {
        let mut columns: Vec<f64> = coefficients.iter().map(|entry| -sign * entry).collect();
        self.factor.solve(&mut columns);
        let mut total: Vec<f64> = column.iter().map(|entry| sign * entry).collect();
        for (rate, normal) in columns.iter().zip(self.factor.columns()) {
            add_scaled(&mut total, *rate, normal);
        }
        let coordinates =
            (0..self.fixed.len()).map(|k| if self.fixed[k].is_some() { -total[k] } else { 0.0 }).collect();
        let sizes: Vec<f64> = self.factor.columns().iter().map(|normal| norm(normal)).collect();
        let scaled = columns.iter().zip(&sizes).map(|(rate, size)| (rate * size).abs());
        let noise = NOISE * scaled.fold(norm(column), f64::max);
        let column_noise = sizes.into_iter().map(|size| noise / size).collect();
        ExchangeRates { columns, column_noise, coordinates, noise }
    }

    /// The rates of the cuts have a known sum. It gives the rate of the flattest cut more accurately than that cut's
    /// own equation does: steeper cuts have smaller rates, and these have smaller rounding.
    fn keep_sum(&self, rates: &mut ExchangeRates, sum: f64) {
        let held = self.general.iter().enumerate().filter(|(_, active)| matches!(active.member, Member::Cut(_)));
        let cuts: Vec<usize> = held.map(|(position, _)| position).collect();
        let noise = &mut rates.column_noise;
        let flattest = cuts.iter().copied().max_by(|&i, &j| noise[i].total_cmp(&noise[j]));
        let Some(flattest) = flattest else { return };
        let others = || cuts.iter().copied().filter(|&position| position != flattest);
        let noise_of_sum = others().map(|position| noise[position]).sum();
        if noise_of_sum < noise[flattest] {
            noise[flattest] = noise_of_sum;
            rates.columns[flattest] = sum - others().map(|position| rates.columns[position]).sum::<f64>();
        }
    }

    /// The first held multiplier that reaches zero; rates that are rounding are passed over.
    fn exchange_block(&self, rates: &ExchangeRates) -> Option<(f64, Place)> {
        let mut first: Option<(f64, Place)> = None;
        let mut consider = |active: &Active, rate: f64, noise: f64, place: Place| {
            let falls = match active.side {
                Side::Upper => rate < 0.0,
                Side::Lower => rate > 0.0,
                Side::Both => false,
            };
            let length = (active.multiplier / rate).abs();
            if falls && rate.abs() > noise && first.is_none_or(|(shortest, _)| length < shortest) {
                first = Some((length, place));
            }
        };
        for (position, active) in self.general.iter().enumerate() {
            consider(active, rates.columns[position], rates.column_noise[position], Place::Column(position));
        }
        for (k, rate) in rates.coordinates.iter().enumerate() {
            if let (Some(active), Some(length)) = (&self.fixed[k], self.coordinates.axis_length(k)) {
                consider(active, rate * length, rates.noise * length, Place::Coordinate(k));
            }
        }
        first
    }

    fn exchange(&mut self, rates: &ExchangeRates, length: f64) {
        for (active, rate) in self.general.iter_mut().zip(&rates.columns) {
            active.multiplier += length * rate;
        }
        for (k, rate) in rates.coordinates.iter().enumerate() {
            if let (Some(active), Some(axis)) = (&mut self.fixed[k], self.coordinates.axis_length(k)) {
                active.multiplier += length * rate * axis;
            }
        }
    }
}

struct ExchangeRates {
    columns: Vec<f64>,
    /// Rates up to this are rounding.
    column_noise: Vec<f64>,
    /// In the metric's coordinates: the multiplier divided by √H_ii.
    coordinates: Vec<f64>,
    /// Rates below this size are rounding.
    noise: f64,
}
