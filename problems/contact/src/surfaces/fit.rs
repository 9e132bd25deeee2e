//! The surface of least squares through points with given parameters, on nets that are refined until it is near enough.

use super::net::{SplineNet, ends, interval, weights};
use crate::linear::FactorizationError;
use crate::linear::cholesky::{NumericFactor, SymbolicFactor};
use crate::linear::symmetric::LowerPattern;
use crate::mortar::vector::{length, plus};
use crate::shape::bending_line;
use nonsmooth::Matrix;
use std::sync::Arc;

/// λ, the weights of the bending.
const BENDINGS: [f64; 7] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// Corrections on one net.
const CORRECTIONS: usize = 6;
/// Control points per point up to which the net is refined.
const MOST_PER_POINT: usize = 2;
/// Points per control point with which the points determine a net, between them too.
const DETERMINED: usize = 3;
/// Distance, as a part of the mean one of the points, up to which points lie in one row: a knot between them would tear
/// the surface.
const ONE_ROW: f64 = 0.05;
/// Halving intervals along one side alone is enough where it divides the largest residual by this.
const ENOUGH: f64 = 4.0;

/// The control points that act at a point, with their weights.
type PointWeights = Vec<(usize, f64)>;

/// Points with their parameters.
pub(super) struct Samples<'a> {
    /// Parameters in [0, 1]².
    pub places: &'a [[f64; 2]],
    /// Points, mm.
    pub points: &'a [[f64; 3]],
    /// Lengths of both sides of the parameters, mm.
    pub sides: [f64; 2],
    /// Whether a surface has waves between the points.
    pub has_waves: &'a dyn Fn(&SplineNet) -> bool,
}

/// A surface with x_k − S(s_k, t_k) and the distances of the points from the surface, mm.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    pub net: SplineNet,
    rests: Vec<[f64; 3]>,
    pub distances: Vec<f64>,
}

impl Fit {
    /// The largest distance.
    fn worst(&self) -> f64 {
        self.distances.iter().copied().fold(0.0, f64::max)
    }

    /// The largest difference at the parameters of a point.
    fn residual(&self) -> f64 {
        self.rests.iter().map(|rest| length(*rest)).fold(0.0, f64::max)
    }
}

impl Samples<'_> {
    /// The surface on a net with so many equal intervals.
    pub(super) fn on_net(&self, intervals: [usize; 2]) -> Result<SplineNet, FactorizationError> {
        let centre = self.points.iter().fold([0.0; 3], |sum, x| plus(sum, 1.0 / self.points.len() as f64, *x));
        Ok(self.improved(SplineNet::at_one_place(intervals, centre), 0.0)?.net)
    }

    /// The surface on the coarsest net, from that of a first surface on, of which no point is farther off than `goal`,
    /// or the nearest one.
    pub(super) fn fit(&self, first: SplineNet, goal: f64) -> Result<Fit, FactorizationError> {
        let mut best = self.improved(first, goal)?;
        let (mut current, mut reference) = (best.clone(), best.net.clone());
        while best.worst() > goal {
            let Some(finer) = self.finer(&current, &reference, goal)? else { break };
            if finer.worst() < best.worst() {
                best = finer.clone();
            }
            // What points determine between them is what finer nets bend away from.
            if DETERMINED * finer.net.points().len() <= self.points.len() {
                reference = finer.net.clone();
            }
            current = finer;
        }
        Ok(best)
    }

    /// The better of two fits with the intervals halved along one parameter in which points are off by more than the
    /// goal or, where neither is much better, that along both; none where finer nets have too few points.
    fn finer(&self, fit: &Fit, reference: &SplineNet, goal: f64) -> Result<Option<Fit>, FactorizationError> {
        let middles = [0, 1].map(|axis| self.middles(fit, axis, goal));
        let mut best: Option<Fit> = None;
        for along in [[true, false], [false, true], [true, true]] {
            let knots = [0, 1].map(|axis| if along[axis] { &middles[axis][..] } else { &[] });
            let counts = fit.net.surface().counts();
            let size = (counts[0] + knots[0].len()) * (counts[1] + knots[1].len());
            let is_enough = |found: &Fit| found.worst() <= goal || ENOUGH * found.worst() <= fit.worst();
            let has_ended = along == [true, true] && best.as_ref().is_some_and(is_enough);
            let has_none = (0..2).any(|axis| along[axis] && knots[axis].is_empty());
            if has_ended || has_none || size > MOST_PER_POINT * self.points.len() {
                continue;
            }
            let further = [0, 1].map(|axis| {
                let known = ends(&reference.bases()[axis]);
                let all = ends(&fit.net.bases()[axis]).iter().chain(knots[axis]).copied();
                let mut further: Vec<f64> = all.filter(|knot| !known.contains(knot)).collect();
                further.sort_unstable_by(f64::total_cmp);
                further
            });
            let found = self.improved(reference.refined(further.each_ref().map(Vec::as_slice)), goal)?;
            if best.as_ref().is_none_or(|best| found.worst() < best.worst()) {
                best = Some(found);
            }
        }
        Ok(best)
    }

    /// The knots that halve the intervals along a parameter in which a point is farther off than the goal: as many rows
    /// of points on one side as on the other, so that every interval has a row. Intervals of one row stay.
    fn middles(&self, fit: &Fit, axis: usize, goal: f64) -> Vec<f64> {
        let basis = &fit.net.bases()[axis];
        let count = ends(basis).len() - 1;
        let (mut is_off, mut rows) = (vec![false; count], vec![Vec::new(); count]);
        for (place, distance) in self.places.iter().zip(&fit.distances) {
            let own = interval(basis, place[axis]);
            is_off[own] |= *distance > goal;
            rows[own].push(place[axis]);
        }
        let mean = (self.sides[0] * self.sides[1] / self.points.len() as f64).sqrt();
        let one_row = ONE_ROW * mean / self.sides[axis];
        let middle = |(rows, is_off): (&mut Vec<f64>, bool)| {
            rows.sort_unstable_by(f64::total_cmp);
            rows.dedup_by(|next, before| *next - *before < one_row);
            let half = rows.len() / 2;
            (is_off && half > 0).then(|| 0.5 * (rows[half - 1] + rows[half]))
        };
        rows.iter_mut().zip(is_off).filter_map(middle).collect()
    }

    /// A net with corrections that bend little, then more, until no point is farther off than `goal`, or as long as no
    /// waves come between the points: a net that cannot reach the points would pay for small gains there with waves
    /// where there are none.
    fn improved(&self, net: SplineNet, goal: f64) -> Result<Fit, FactorizationError> {
        let rows: Vec<PointWeights> = self.places.iter().map(|place| self.row(&net, *place)).collect();
        let mut best = self.measured(net, &rows);
        for bending in BENDINGS {
            if best.residual() <= goal {
                break;
            }
            let found = self.corrected(&best, bending, &rows)?;
            if (self.has_waves)(&found.net) {
                break;
            }
            best = found;
        }
        let points = self.points.iter().zip(self.places);
        best.distances = points.map(|(x, place)| best.net.distance(*x, *place)).collect();
        Ok(best)
    }

    /// A fit with corrections as long as each halves what is left.
    fn corrected(&self, fit: &Fit, bending: f64, rows: &[PointWeights]) -> Result<Fit, FactorizationError> {
        let factor = self.factored(&fit.net, bending, rows)?;
        let mut best = fit.clone();
        for _ in 0..CORRECTIONS {
            let change = [0, 1, 2].map(|axis| {
                let mut right = vec![0.0; best.net.points().len()];
                for (row, rest) in rows.iter().zip(&best.rests) {
                    row.iter().for_each(|(point, weight)| right[*point] += weight * rest[axis] / rows.len() as f64);
                }
                factor.solve_in_place(&mut right);
                right
            });
            let mut net = best.net.clone();
            net.add(|point| [0, 1, 2].map(|axis| change[axis][point]));
            let found = self.measured(net, rows);
            let (before, after) = (best.residual(), found.residual());
            if after.is_nan() || after >= before {
                break;
            }
            best = found;
            if after > 0.5 * before {
                break;
            }
        }
        Ok(best)
    }

    /// A net with what is left at the points.
    fn measured(&self, net: SplineNet, rows: &[PointWeights]) -> Fit {
        let rest = |(row, x): (&PointWeights, &[f64; 3])| {
            row.iter().fold(*x, |rest, (point, weight)| plus(rest, -weight, net.points()[*point]))
        };
        let rests = rows.iter().zip(self.points).map(rest).collect();
        Fit { net, rests, distances: Vec::new() }
    }

    /// The factored normal equations of a net.
    fn factored(
        &self,
        net: &SplineNet,
        bending: f64,
        rows: &[PointWeights],
    ) -> Result<NumericFactor, FactorizationError> {
        let [n1, n2] = net.surface().counts();
        let index = |i: usize, j: usize| if n1 < n2 { (i * n2 + j, j * n1 + i) } else { (i * n2 + j, i * n2 + j) };
        let mut columns = vec![Vec::new(); n1 * n2];
        let mut order = vec![0; n1 * n2];
        for (i, j) in (0..n1).flat_map(|i| (0..n2).map(move |j| (i, j))) {
            let (own, place) = index(i, j);
            order[place] = own;
            columns[own] = near(i, n1).flat_map(|k| near(j, n2).map(move |l| k * n2 + l)).collect();
        }
        let pattern = Arc::new(LowerPattern::from_columns(columns));
        let mut values = vec![0.0; pattern.entry_count()];
        let mut add = |row: usize, column: usize, value: f64| {
            if let Some(position) = pattern.position(row, column) {
                values[position] += value;
            }
        };
        let share = 1.0 / rows.len() as f64;
        for row in rows {
            for &(first, a) in row {
                row.iter()
                    .filter(|(second, _)| *second <= first)
                    .for_each(|(second, b)| add(first, *second, share * a * b));
            }
        }
        self.bending(net, bending * share * share, &mut add);
        Arc::new(SymbolicFactor::new(pattern, order)?).factorize(&values)
    }

    /// Adds the lower entries of the bending, times λ h⁴/A with h² = A/n; `factor`: λ/n².
    fn bending(&self, net: &SplineNet, factor: f64, add: &mut dyn FnMut(usize, usize, f64)) {
        let [n1, n2] = net.surface().counts();
        let weight = self.sides[0] * self.sides[1] * factor;
        let [along, across] = [0, 1].map(|axis| {
            let places: Vec<f64> = net.bases()[axis].greville().into_iter().map(|t| self.sides[axis] * t).collect();
            bending_line(&places, self.sides[axis]).map(|rows| rows.tr_mul(&rows))
        });
        for (i, k) in (0..n1).flat_map(|i| near(i, n1).map(move |k| (i, k))) {
            for (j, l) in (0..n2).flat_map(|j| near(j, n2).map(move |l| (j, l))) {
                let (row, column) = (i * n2 + j, k * n2 + l);
                if column <= row {
                    let product = |first: &Matrix, second: &Matrix| first[(i, k)] * second[(j, l)];
                    let ends = product(&along[2], &across[0]) + product(&along[0], &across[2]);
                    add(row, column, weight * (ends + 2.0 * product(&along[1], &across[1])));
                }
            }
        }
    }

    fn row(&self, net: &SplineNet, place: [f64; 2]) -> PointWeights {
        let [first, second] = [0, 1].map(|axis| weights(&net.bases()[axis], place[axis]).collect::<Vec<_>>());
        let count = net.surface().counts()[1];
        let all = first.iter().flat_map(|(i, a)| second.iter().map(move |(j, b)| (i * count + j, a * b)));
        all.filter(|(_, weight)| *weight != 0.0).collect()
    }
}

/// The functions along a parameter that overlap one of them.
fn near(function: usize, count: usize) -> std::ops::Range<usize> {
    function.saturating_sub(3)..(function + 4).min(count)
}
