//! Exchange of held members against a side whose normal depends on them: how their multipliers change with its own.

use super::kernels::{add_scaled, norm};
use super::working_set::{Active, FirstBlock, Place, Side, WorkingSet};

/// Share of the largest rate of an exchange, in the metric's coordinates, up to which a rate is rounding.
const NOISE: f64 = 1e-10;

/// Changes of the held multipliers per unit of a dependent side's multiplier.
pub(super) struct ExchangeRates {
    columns: Vec<f64>,
    /// Rates up to this are rounding.
    column_noise: Vec<f64>,
    /// In the metric's coordinates: the multiplier divided by √H_ii.
    coordinates: Vec<f64>,
    /// Rates below this size are rounding.
    noise: f64,
}

impl ExchangeRates {
    /// R x = −Qᵀ ã gives the rates of the columns, and what remains of the normal gives those of the fixed coordinates.
    pub(super) fn new(set: &WorkingSet<'_>, column: &[f64], coefficients: &[f64], sign: f64) -> Self {
        let mut columns: Vec<f64> = coefficients.iter().map(|entry| -sign * entry).collect();
        set.factor.solve(&mut columns);
        let mut total: Vec<f64> = column.iter().map(|entry| sign * entry).collect();
        for (rate, normal) in columns.iter().zip(set.factor.columns()) {
            add_scaled(&mut total, *rate, normal);
        }
        let of_coordinate = |(fixed, rest): (&Option<Active>, &f64)| if fixed.is_some() { -rest } else { 0.0 };
        let coordinates = set.fixed.iter().zip(&total).map(of_coordinate).collect();
        let sizes: Vec<f64> = set.factor.columns().iter().map(|normal| norm(normal)).collect();
        let scaled = columns.iter().zip(&sizes).map(|(rate, size)| (rate * size).abs());
        let noise = NOISE * scaled.fold(norm(column), f64::max);
        let column_noise = sizes.into_iter().map(|size| noise / size).collect();
        Self { columns, column_noise, coordinates, noise }
    }

    /// The rates of the cuts have a known sum. It gives the rate of the flattest cut more accurately than the equation
    /// of that cut does: steeper cuts have smaller rates, and these have smaller rounding.
    pub(super) fn keep_sum(&mut self, set: &WorkingSet<'_>, sum: f64) {
        let cuts = || (0..set.general.len()).filter(|&position| set.general[position].member.is_cut());
        let noise = &mut self.column_noise;
        let Some(flattest) = cuts().max_by(|&i, &j| noise[i].total_cmp(&noise[j])) else { return };
        let others = || cuts().filter(|&position| position != flattest);
        let noise_of_sum = others().map(|position| noise[position]).sum();
        if noise_of_sum < noise[flattest] {
            noise[flattest] = noise_of_sum;
            self.columns[flattest] = sum - others().map(|position| self.columns[position]).sum::<f64>();
        }
    }

    /// The first held multiplier that reaches zero; rates that are rounding are passed over.
    pub(super) fn first_block(&self, set: &WorkingSet<'_>) -> Option<(f64, Place)> {
        let length = |active: &Active, rate: f64, noise: f64| {
            let falls = match active.side {
                Side::Upper => rate < 0.0,
                Side::Lower => rate > 0.0,
                Side::Both => false,
            };
            (falls && rate.abs() > noise).then(|| (active.multiplier / rate).abs())
        };
        let mut first = FirstBlock::default();
        for (position, active) in set.general.iter().enumerate() {
            let length = length(active, self.columns[position], self.column_noise[position]);
            first.consider(length, Place::Column(position));
        }
        for (k, rate) in self.coordinates.iter().enumerate() {
            if let (Some(active), Some(axis)) = (&set.fixed[k], set.coordinates.axis_length(k)) {
                first.consider(length(active, rate * axis, self.noise * axis), Place::Coordinate(k));
            }
        }
        first.0
    }

    /// Changes the held multipliers by what a multiplier of the side of this length asks for.
    pub(super) fn apply(&self, set: &mut WorkingSet<'_>, length: f64) {
        for (active, rate) in set.general.iter_mut().zip(&self.columns) {
            active.multiplier += length * rate;
        }
        for (k, rate) in self.coordinates.iter().enumerate() {
            if let (Some(active), Some(axis)) = (&mut set.fixed[k], set.coordinates.axis_length(k)) {
                active.multiplier += length * rate * axis;
            }
        }
    }
}
