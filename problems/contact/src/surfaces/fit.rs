//! The surface of least squares through points with given parameters, on nets that are refined until it is near enough.

use super::net::{SplineNet, weights};
use crate::linear::FactorizationError;
use crate::linear::cholesky::{NumericFactor, SymbolicFactor};
use crate::linear::symmetric::LowerPattern;
use crate::mortar::vector::{length, plus};
use crate::shape::bending_line;
use nonsmooth::Matrix;
use std::sync::Arc;

/// λ, the weight of the bending.
const BENDING: f64 = 1e-6;
/// Corrections on one net.
const CORRECTIONS: usize = 6;
/// Control points per point up to which the net is refined.
const MOST_PER_POINT: usize = 4;
/// Halving one side alone is enough where it divides the largest residual by this.
const ENOUGH: f64 = 4.0;

/// Points with their parameters.
pub(super) struct Samples<'a> {
    /// Parameters in [0, 1]².
    pub places: &'a [[f64; 2]],
    /// Points, mm.
    pub points: &'a [[f64; 3]],
    /// Lengths of both sides of the parameters, mm.
    pub sides: [f64; 2],
}

/// A surface with the largest |S(s_k, t_k) − x_k|, mm.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    pub net: SplineNet,
    pub residual: f64,
}

impl Samples<'_> {
    /// The surface on the coarsest net whose residual is at most `goal`, or the nearest one.
    pub(super) fn fit(&self, goal: f64) -> Result<Fit, FactorizationError> {
        let centre = self.points.iter().fold([0.0; 3], |sum, x| plus(sum, 1.0 / self.points.len() as f64, *x));
        let mut best = self.improved(SplineNet::at_one_place(centre, [1, 1]))?;
        let most = MOST_PER_POINT * self.points.len();
        let is_small = |along: [bool; 2], net: &SplineNet| {
            let counts = net.counts();
            (0..2).map(|axis| if along[axis] { 2 * counts[axis] - 3 } else { counts[axis] }).product::<usize>() <= most
        };
        let mut current = best.clone();
        while best.residual > goal {
            let mut next: Option<Fit> = None;
            for along in [[true, false], [false, true], [true, true]] {
                if !is_small(along, &current.net) {
                    continue;
                }
                let is_enough = |fit: &Fit| fit.residual <= goal || ENOUGH * fit.residual <= current.residual;
                if along == [true, true] && next.as_ref().is_some_and(is_enough) {
                    continue;
                }
                let fit = self.improved(current.net.halved(along))?;
                // A finer net has to earn its control points.
                let is_better = |other: &Fit| fit.residual < other.residual;
                if next.as_ref().is_none_or(is_better) {
                    next = Some(fit);
                }
            }
            let Some(fit) = next else { break };
            if fit.residual < best.residual {
                best = fit.clone();
            }
            current = fit;
        }
        Ok(best)
    }

    /// A net whose correction bends least.
    fn improved(&self, net: SplineNet) -> Result<Fit, FactorizationError> {
        let (factor, rows) = self.factored(&net)?;
        let mut best = Fit { residual: self.residual(&net, &rows).1, net };
        for _ in 0..CORRECTIONS {
            let (rest, _) = self.residual(&best.net, &rows);
            let right = |axis: usize| {
                let mut right = vec![0.0; best.net.points().len()];
                for (row, rest) in rows.iter().zip(&rest) {
                    row.iter().for_each(|(point, weight)| right[*point] += weight * rest[axis] / rest_count(&rows));
                }
                factor.solve_in_place(&mut right);
                right
            };
            let change = [right(0), right(1), right(2)];
            let mut net = best.net.clone();
            net.add(|point| [0, 1, 2].map(|axis| change[axis][point]));
            let (_, residual) = self.residual(&net, &rows);
            if residual.is_nan() || residual >= best.residual {
                break;
            }
            let still = residual > 0.5 * best.residual;
            best = Fit { net, residual };
            if still {
                break;
            }
        }
        Ok(best)
    }

    /// From the surface to the points at their parameters, and the largest distance.
    fn residual(&self, net: &SplineNet, rows: &[Vec<(usize, f64)>]) -> (Vec<[f64; 3]>, f64) {
        let rest = |(row, x): (&Vec<(usize, f64)>, &[f64; 3])| {
            row.iter().fold(*x, |rest, (point, weight)| plus(rest, -weight, net.points()[*point]))
        };
        let rests: Vec<[f64; 3]> = rows.iter().zip(self.points).map(rest).collect();
        let largest = rests.iter().map(|rest| length(*rest)).fold(0.0, f64::max);
        (rests, largest)
    }

    /// The factored normal equations of a net, and the weights of its control points at all points.
    fn factored(&self, net: &SplineNet) -> Result<(NumericFactor, Vec<Vec<(usize, f64)>>), FactorizationError> {
        let [n1, n2] = net.counts();
        let index = |i: usize, j: usize| if n1 < n2 { (i * n2 + j, j * n1 + i) } else { (i * n2 + j, i * n2 + j) };
        let near = |center: usize, count: usize| center.saturating_sub(3)..(center + 4).min(count);
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
        let rows: Vec<Vec<(usize, f64)>> = self.places.iter().map(|place| self.row(net, *place)).collect();
        let share = 1.0 / rest_count(&rows);
        for row in &rows {
            for &(first, a) in row {
                row.iter().filter(|(second, _)| *second <= first).for_each(|(second, b)| add(first, *second, share * a * b));
            }
        }
        let area = self.sides[0] * self.sides[1];
        // λ h⁴/A with h² = A/n.
        let weight = BENDING * area * share * share;
        let [along, across] = [0, 1].map(|axis| {
            let places: Vec<f64> = net.bases()[axis].greville().into_iter().map(|t| self.sides[axis] * t).collect();
            bending_line(&places, self.sides[axis]).map(|rows| rows.tr_mul(&rows))
        });
        for (i, j) in (0..n1).flat_map(|i| (0..n2).map(move |j| (i, j))) {
            for (k, l) in near(i, n1).flat_map(|k| near(j, n2).map(move |l| (k, l))).filter(|(k, l)| k * n2 + l <= i * n2 + j) {
                let product = |first: &Matrix, second: &Matrix| first[(i, k)] * second[(j, l)];
                let own = product(&along[2], &across[0])
                    + 2.0 * product(&along[1], &across[1])
                    + product(&along[0], &across[2]);
                add(i * n2 + j, k * n2 + l, weight * own);
            }
        }
        Ok((Arc::new(SymbolicFactor::new(pattern, order)?).factorize(&values)?, rows))
    }

    fn row(&self, net: &SplineNet, place: [f64; 2]) -> Vec<(usize, f64)> {
        let [first, second] = [0, 1].map(|axis| weights(&net.bases()[axis], place[axis]).collect::<Vec<_>>());
        let count = net.counts()[1];
        let all = first.iter().flat_map(|(i, a)| second.iter().map(move |(j, b)| (i * count + j, a * b)));
        all.filter(|(_, weight)| *weight != 0.0).collect()
    }
}

fn rest_count(rows: &[Vec<(usize, f64)>]) -> f64 {
    rows.len() as f64
}
