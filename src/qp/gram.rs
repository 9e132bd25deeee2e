//! Dual active-set method in the space of the multipliers, for cuts whose inner products are known.
//!
//! ```text
//! min over π   ½ πᵀG π / u + eᵀπ,   π ≥ 0,  Σ π = 1         G = ⟨g_i, W⁻¹ g_j⟩,  H = u W
//! d = −Σ π_j W⁻¹ g_j / u,    w_j = e_j − g_jᵀd = −(value of cut j),    at the solution  w_j = −v where π_j > 0,  w_j ≥ −v elsewhere
//! ```
//! With m cuts of which k are held, a pivot costs O(k² + m k) and no pass over the n variables; the working set and its
//! factor R, RᵀR = G + s 𝟏𝟏ᵀ on the cuts held, stay from one problem to the next. Each round forms d and the values of
//! all cuts in the variables themselves, and repeats the pivots from there, so that the answer has the accuracy of the
//! data and not that of G. What this method cannot finish goes to the method that works with orthogonal factors.
//! Reference: \[Kiwiel1986\].

use super::certificate::LENGTH_SHARE;
use super::kernels::{add_all_scaled, dot, dot_terms, dots, weighted_squares};
use super::problem::{EpigraphQp, QpMethod, QpSolution};
use super::triangular::Triangular;
use crate::Vector;
use crate::linalg::upper_median;
use std::borrow::Cow;

/// Inner products of the slopes of a QP in the metric W, and the weight u of H = u W.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gram<'a> {
    /// The inner products ⟨g_i, W⁻¹ g_j⟩, by the slots of both cuts.
    pub rows: &'a [Vec<f64>],
    /// The slot of each cut.
    pub slots: &'a [usize],
    /// The weight u.
    pub weight: f64,
    /// Whether cuts with identities known from the call before have the inner products they had then.
    pub lasting: bool,
}

/// The working set and its factor after a call.
#[derive(Debug, Clone, Default)]
pub(super) struct GramMemory {
    held: Vec<u64>,
    multipliers: Vec<f64>,
    factor: Triangular,
    shift: f64,
    lasting: bool,
}

/// A squared distance from the span of the cuts held up to this share of the squared length is rounding.
const DEPENDENT: f64 = 1e-13;
/// A rate of an exchanged multiplier up to this is rounding.
const LEAST_RATE: f64 = 1e-11;
/// An excess of a cut up to this share of its terms is rounding.
const ROUNDING: f64 = 1e-14;
/// Largest number of rounds; each forms the values of all cuts anew.
const ROUNDS: usize = 4;

/// A problem under way.
struct Dual<'a> {
    qp: &'a EpigraphQp<'a>,
    gram: Gram<'a>,
    factor: &'a mut Triangular,
    /// The shift s of RᵀR = G + s 𝟏𝟏ᵀ.
    shift: f64,
    held: Vec<usize>,
    multipliers: Vec<f64>,
    /// What the multipliers have changed since d was formed, by cuts: finer than the multipliers, whose last bit moves
    /// w_j by as much as ‖g‖²/u times the machine precision.
    moved: Vec<f64>,
    /// w_j, by slots.
    gradient: Vec<f64>,
    is_held: Vec<bool>,
    /// Cuts that are violated by rounding alone and are not taken in again.
    skipped: Vec<usize>,
    /// A length: its product with ‖g_j‖ and the machine precision is the size of the rounding of w_j.
    drift: f64,
    pivots: usize,
    /// ‖g_j‖ in the dual norm of W.
    norms: Vec<f64>,
    /// The diagonal of H.
    diagonal: Cow<'a, [f64]>,
}

impl GramMemory {
    /// The answer, if its relative KKT residual is at most `wanted` and it violates no row or bound at all.
    pub(super) fn solve(&mut self, qp: &EpigraphQp<'_>, gram: Gram<'_>, wanted: f64) -> Option<QpSolution> {
        let mut factor = std::mem::take(&mut self.factor);
        let mut dual = Dual::new(qp, gram, &mut factor, self.shift);
        if self.lasting && gram.lasting && !self.held.is_empty() {
            dual.resume(&self.held, &self.multipliers);
        } else {
            dual.rebuild(&self.held, &self.multipliers);
        }
        let solution = dual.run(wanted).filter(|solution| satisfies_sides(qp, &solution.step));
        self.held = dual.held.iter().map(|&j| qp.cut_ids[j]).collect();
        self.multipliers = std::mem::take(&mut dual.multipliers);
        (self.shift, self.lasting) = (dual.shift, gram.lasting);
        self.factor = factor;
        if solution.is_none() {
            *self = Self::default();
        }
        solution
    }
}

impl<'a> Dual<'a> {
    fn new(qp: &'a EpigraphQp<'a>, gram: Gram<'a>, factor: &'a mut Triangular, shift: f64) -> Self {
        Self {
            qp,
            gram,
            factor,
            shift,
            held: vec![],
            multipliers: vec![],
            moved: vec![0.0; qp.slopes.len()],
            gradient: vec![],
            is_held: vec![false; qp.slopes.len()],
            skipped: vec![],
            drift: 0.0,
            pivots: 0,
            diagonal: qp.metric.diagonal(qp.dimension()),
            norms: gram.slots.iter().map(|&slot| gram.rows[slot][slot].sqrt()).collect(),
        }
    }

    fn product(&self, i: usize, j: usize) -> f64 {
        self.gram.rows[self.gram.slots[i]][self.gram.slots[j]]
    }

    /// Goes on with the working set of the last call, without the cuts that are no longer in the problem.
    fn resume(&mut self, ids: &[u64], multipliers: &[f64]) {
        let mut removed = 0;
        for (k, (id, &multiplier)) in ids.iter().zip(multipliers).enumerate() {
            if let Some(j) = self.qp.cut_ids.iter().position(|known| known == id) {
                self.held.push(j);
                self.multipliers.push(multiplier);
                self.is_held[j] = true;
            } else {
                self.factor.remove(k - removed, |_, _| {});
                removed += 1;
            }
        }
        self.normalise();
    }

    /// Factorises the working set of the last call anew.
    fn rebuild(&mut self, ids: &[u64], multipliers: &[f64]) {
        self.factor.clear();
        let mut lengths: Vec<f64> = (0..self.qp.slopes.len()).map(|j| self.product(j, j)).collect();
        lengths.retain(|length| *length > 0.0);
        self.shift = upper_median(&mut lengths).unwrap_or(1.0);
        for (id, &multiplier) in ids.iter().zip(multipliers) {
            if let Some(j) = self.qp.cut_ids.iter().position(|known| known == id)
                && let Ok((column, diagonal)) = self.column(j)
            {
                self.hold(j, multiplier, column, diagonal);
            }
        }
        self.normalise();
    }

    /// Makes the multipliers sum up to one; without any, the cut of largest dual value is held.
    fn normalise(&mut self) {
        let sum: f64 = self.multipliers.iter().sum();
        if sum > 0.0 {
            self.multipliers.iter_mut().for_each(|multiplier| *multiplier /= sum);
            return;
        }
        let value = |j: usize| 0.5 * self.product(j, j) / self.gram.weight + self.qp.offsets[j];
        let best = (0..self.qp.slopes.len()).min_by(|&i, &j| value(i).total_cmp(&value(j)));
        self.factor.clear();
        self.held.iter().for_each(|&j| self.is_held[j] = false);
        self.held.clear();
        self.multipliers.clear();
        if let Some(best) = best
            && let Ok((column, diagonal)) = self.column(best)
        {
            self.hold(best, 1.0, column, diagonal);
        }
    }

    /// The column that a cut adds to R; where the cut depends on those held, its coefficients.
    fn column(&self, j: usize) -> Result<(Vec<f64>, f64), Vec<f64>> {
        let mut column: Vec<f64> = self.held.iter().map(|&i| self.product(i, j) + self.shift).collect();
        self.factor.solve_transposed(&mut column);
        let squared = self.product(j, j) + self.shift;
        let rest = squared - dot(&column, &column);
        if rest > DEPENDENT * squared {
            return Ok((column, rest.sqrt()));
        }
        self.factor.solve(&mut column);
        Err(column)
    }

    fn hold(&mut self, j: usize, multiplier: f64, column: Vec<f64>, diagonal: f64) {
        self.factor.push(column, diagonal);
        self.held.push(j);
        self.multipliers.push(multiplier);
        self.is_held[j] = true;
        self.pivots += 1;
    }

    fn release(&mut self, position: usize) {
        self.factor.remove(position, |_, _| {});
        let j = self.held.remove(position);
        self.multipliers.remove(position);
        self.is_held[j] = false;
        self.pivots += 1;
    }

    /// Adds to w and to what d lacks the changes of multipliers, given by the cuts.
    fn shift_gradient(&mut self, changes: &[(usize, f64)]) {
        let (gram, weight) = (self.gram, self.gram.weight);
        for &(j, change) in changes {
            self.moved[j] += change;
            self.drift += change.abs() * self.norms[j] / weight;
        }
        let rows = changes.iter().map(|&(j, change)| (change / weight, gram.rows[gram.slots[j]].as_slice()));
        add_all_scaled(&mut self.gradient, &rows.collect::<Vec<_>>());
    }

    /// Adds changes to the multipliers of the cuts held.
    fn shift_multipliers(&mut self, factor: f64, changes: &[f64]) {
        let shifts: Vec<(usize, f64)> =
            self.held.iter().zip(changes).map(|(&j, change)| (j, factor * change)).collect();
        self.multipliers.iter_mut().zip(&shifts).for_each(|(multiplier, (_, shift))| *multiplier += shift);
        self.shift_gradient(&shifts);
    }

    /// Takes the multiplier of a cut held away, and the cut out of the working set.
    fn drop_held(&mut self, position: usize) {
        self.shift_gradient(&[(self.held[position], -self.multipliers[position])]);
        self.release(position);
    }

    /// w_j of the cuts held.
    fn held_gradient(&self) -> Vec<f64> {
        self.held.iter().map(|&j| self.gradient[self.gram.slots[j]]).collect()
    }

    /// Runs rounds of pivots until the answer is accurate.
    fn run(&mut self, wanted: f64) -> Option<QpSolution> {
        self.gradient = vec![0.0; self.gram.rows.len()];
        for (&slot, offset) in self.gram.slots.iter().zip(self.qp.offsets) {
            self.gradient[slot] = *offset;
        }
        let held: Vec<(usize, f64)> = self.held.iter().copied().zip(self.multipliers.iter().copied()).collect();
        self.shift_gradient(&held);
        let mut step = Vector::zeros(self.qp.dimension());
        for _ in 0..ROUNDS {
            self.pivot()?;
            self.place(&mut step);
            let values = self.values(&step);
            let epigraph = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let residual = self.residual(&step, &values, epigraph);
            if residual <= wanted {
                return Some(self.answer(step, epigraph, residual));
            }
            for (&slot, value) in self.gram.slots.iter().zip(&values) {
                self.gradient[slot] = -value;
            }
            self.drift = self.length(&step);
            self.skipped.clear();
        }
        None
    }

    /// Moves d by what the multipliers have changed since the last call.
    fn place(&mut self, step: &mut Vector) {
        let changes = self.moved.iter().zip(self.qp.slopes).filter(|(change, _)| **change != 0.0);
        let moved: Vec<(f64, &[f64])> = changes.map(|(change, slope)| (*change, slope.as_slice())).collect();
        let mut sum = vec![0.0; step.len()];
        add_all_scaled(&mut sum, &moved);
        self.moved.fill(0.0);
        for ((step, sum), diagonal) in step.as_mut_slice().iter_mut().zip(sum).zip(&*self.diagonal) {
            *step -= sum / diagonal;
        }
    }

    /// The values of all cuts at d.
    fn values(&self, step: &Vector) -> Vec<f64> {
        let mut values = dots(self.qp.slopes.iter().map(Vector::as_slice), step.as_slice());
        values.iter_mut().zip(self.qp.offsets).for_each(|(value, offset)| *value -= offset);
        values
    }

    /// ‖d‖ in the norm of W.
    fn length(&self, step: &Vector) -> f64 {
        (weighted_squares(&self.diagonal, step.as_slice()) / self.gram.weight).sqrt()
    }

    /// The parts of the KKT residual that do not hold by construction: Σ π = 1 and complementarity. The size of
    /// a cut's terms is formed only where it can decide.
    fn residual(&self, step: &Vector, values: &[f64], epigraph: f64) -> f64 {
        let steepest = self.norms.iter().copied().fold(0.0, f64::max);
        let share = LENGTH_SHARE * (self.length(step) + steepest / self.gram.weight);
        let mut worst = (self.multipliers.iter().sum::<f64>() - 1.0).abs();
        for (&j, &multiplier) in self.held.iter().zip(&self.multipliers) {
            let gap = multiplier.abs().min(1.0) * (epigraph - values[j]);
            let known = self.qp.offsets[j].abs() + epigraph.abs() + share * self.norms[j];
            if gap > worst * known {
                worst = worst.max(gap / (known + dot_terms(self.qp.slopes[j].as_slice(), step.as_slice())));
            }
            worst = worst.max(-multiplier);
        }
        if worst.is_nan() || !epigraph.is_finite() { f64::INFINITY } else { worst }
    }

    fn answer(&self, step: Vector, epigraph: f64, kkt_residual: f64) -> QpSolution {
        let mut cut_multipliers = vec![0.0; self.qp.slopes.len()];
        self.held.iter().zip(&self.multipliers).for_each(|(&j, multiplier)| cut_multipliers[j] = multiplier.max(0.0));
        QpSolution {
            epigraph,
            cut_multipliers,
            row_multipliers: vec![0.0; self.qp.rows.nrows()],
            bound_multipliers: vec![0.0; step.len()],
            step,
            kkt_residual,
            pivots: self.pivots,
            method: QpMethod::ActiveSet,
        }
    }

    /// Pivots until every cut is satisfied; none if the pivots do not come to an end.
    fn pivot(&mut self) -> Option<()> {
        let limit = self.pivots + 100 + 5 * self.qp.slopes.len();
        loop {
            let level = self.solve_equalities();
            if self.pivots > limit || !level.is_finite() {
                return None;
            }
            let Some(j) = self.most_violated(level) else { return Some(()) };
            self.enter(j)?;
            if !self.is_held[j] {
                self.skipped.push(j);
            }
        }
    }

    /// Moves to the equality solution of the cuts held; multipliers that would change sign leave. Returns −v.
    fn solve_equalities(&mut self) -> f64 {
        loop {
            let mut ones = vec![1.0; self.held.len()];
            let mut change = self.held_gradient();
            self.factor.solve_transposed(&mut ones);
            self.factor.solve_transposed(&mut change);
            let level = dot(&ones, &change) / dot(&ones, &ones);
            change.iter_mut().zip(&ones).for_each(|(y, h)| *y = (level * h - *y) * self.gram.weight);
            self.factor.solve(&mut change);
            let blocks = change.iter().zip(&self.multipliers).enumerate();
            let shares = blocks.filter(|(_, (d, l))| *l + *d < 0.0).map(|(k, (d, l))| ((l / -d).clamp(0.0, 1.0), k));
            let first = shares.reduce(|a, b| if b.0 < a.0 { b } else { a });
            let share = first.map_or(1.0, |(share, _)| share);
            self.shift_multipliers(share, &change);
            match first {
                Some((_, position)) => self.drop_held(position),
                None => return level,
            }
        }
    }

    /// The cut farthest below the level −v.
    fn most_violated(&self, level: f64) -> Option<usize> {
        let mut worst: Option<(f64, usize)> = None;
        for j in (0..self.qp.slopes.len()).filter(|&j| !self.is_held[j]) {
            let excess = level - self.gradient[self.gram.slots[j]];
            let rounding =
                ROUNDING * (level.abs() + self.qp.offsets[j].abs()) + 4.0 * f64::EPSILON * self.norms[j] * self.drift;
            if excess > rounding && !self.skipped.contains(&j) {
                let distance = excess / (self.product(j, j) + self.shift).sqrt();
                if worst.is_none_or(|(largest, _)| distance > largest) {
                    worst = Some((distance, j));
                }
            }
        }
        worst.map(|(_, j)| j)
    }

    /// Takes in a cut j. As long as it depends on the cuts held, one of them leaves in exchange; none if nothing can be
    /// exchanged.
    fn enter(&mut self, j: usize) -> Option<()> {
        let mut multiplier = 0.0;
        loop {
            let rates = match self.column(j) {
                Ok((column, diagonal)) => {
                    self.hold(j, multiplier, column, diagonal);
                    return Some(());
                }
                Err(rates) => rates,
            };
            let falling = rates.iter().zip(&self.multipliers).enumerate().filter(|(_, (x, _))| **x > LEAST_RATE);
            let lengths = falling.map(|(k, (x, l))| (l / x, k));
            let (length, position) = lengths.reduce(|a, b| if b.0 < a.0 { b } else { a })?;
            self.shift_multipliers(-length, &rates);
            multiplier += length;
            self.shift_gradient(&[(j, length)]);
            self.drop_held(position);
        }
    }
}

/// Whether a step satisfies all rows and bounds.
fn satisfies_sides(qp: &EpigraphQp<'_>, step: &Vector) -> bool {
    let inside = |values: &Vector, lower: &Vector, upper: &Vector| {
        let sides = lower.as_slice().iter().zip(upper.as_slice());
        values.as_slice().iter().zip(sides).all(|(value, (lower, upper))| value >= lower && value <= upper)
    };
    inside(step, qp.lower, qp.upper) && inside(&(qp.rows * step), qp.row_lower, qp.row_upper)
}
