//! Random quadratic programs of all kinds, from a seed.

use nonsmooth::qp::{EpigraphQp, Metric};
use nonsmooth::{Matrix, Vector};
use testset::kit::Random;

/// Entries uniform in [−1, 1).
pub fn vector(random: &mut Random, size: usize) -> Vector {
    Vector::from_fn(size, |_, _| random.signed())
}

#[derive(Clone, Debug)]
pub enum OwnedMetric {
    ScaledIdentity(f64),
    Diagonal(Vector),
    Dense(Matrix),
}

/// A QP that owns its data.
#[derive(Clone, Debug)]
pub struct OwnedQp {
    pub metric: OwnedMetric,
    pub slopes: Vec<Vector>,
    pub offsets: Vec<f64>,
    pub cut_ids: Vec<u64>,
    pub rows: Matrix,
    pub row_lower: Vector,
    pub row_upper: Vector,
    pub lower: Vector,
    pub upper: Vector,
}

impl OwnedQp {
    pub fn view(&self) -> EpigraphQp<'_> {
        EpigraphQp {
            metric: match &self.metric {
                OwnedMetric::ScaledIdentity(weight) => Metric::ScaledIdentity(*weight),
                OwnedMetric::Diagonal(diagonal) => Metric::Diagonal(diagonal),
                OwnedMetric::Dense(matrix) => Metric::Dense(matrix),
            },
            slopes: &self.slopes,
            offsets: &self.offsets,
            cut_ids: &self.cut_ids,
            rows: &self.rows,
            row_lower: &self.row_lower,
            row_upper: &self.row_upper,
            lower: &self.lower,
            upper: &self.upper,
        }
    }

    /// Cuts only: no rows, no bounds.
    pub fn free(weight: f64, slopes: Vec<Vector>, offsets: Vec<f64>) -> Self {
        let n = slopes[0].len();
        Self {
            metric: OwnedMetric::ScaledIdentity(weight),
            cut_ids: (0..slopes.len() as u64).collect(),
            slopes,
            offsets,
            rows: Matrix::zeros(0, n),
            row_lower: Vector::zeros(0),
            row_upper: Vector::zeros(0),
            lower: Vector::from_element(n, f64::NEG_INFINITY),
            upper: Vector::from_element(n, f64::INFINITY),
        }
    }
}

/// Sizes of a random QP.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    pub dimension: usize,
    pub cuts: usize,
    pub rows: usize,
}

/// A random QP whose rows and box contain a known point near 0 (not always 0 itself).
pub fn random_qp(seed: u64, shape: Shape) -> OwnedQp {
    let mut random = Random(seed);
    let Shape { dimension: n, cuts, rows: p } = shape;
    let inside = if random.below(3) == 0 { vector(&mut random, n) * 0.5 } else { Vector::zeros(n) };
    let (slopes, offsets) = random_cuts(&mut random, n, cuts);
    let (rows, row_lower, row_upper) = random_rows(&mut random, &inside, p);
    let (lower, upper) = random_box(&mut random, &inside);
    OwnedQp {
        metric: random_metric(&mut random, n),
        cut_ids: (0..cuts as u64).map(|id| 1000 + 7 * id).collect(),
        slopes,
        offsets,
        rows,
        row_lower,
        row_upper,
        lower,
        upper,
    }
}

fn random_metric(random: &mut Random, n: usize) -> OwnedMetric {
    let weight = 10f64.powf(3.0 * random.signed());
    match random.below(3) {
        0 => OwnedMetric::ScaledIdentity(weight),
        1 => OwnedMetric::Diagonal(Vector::from_fn(n, |_, _| weight * 10f64.powf(2.0 * random.signed()))),
        _ => {
            let root = Matrix::from_fn(n, n, |_, _| random.signed());
            let mut matrix = &root * root.transpose() * weight;
            for i in 0..n {
                matrix[(i, i)] += 0.01 * weight;
            }
            OwnedMetric::Dense(matrix)
        }
    }
}

/// Fresh cuts mixed with duplicates, near duplicates (1e-8), and convex combinations of others.
fn random_cuts(random: &mut Random, n: usize, cuts: usize) -> (Vec<Vector>, Vec<f64>) {
    let (mut slopes, mut offsets): (Vec<Vector>, Vec<f64>) = (Vec::new(), Vec::new());
    let degenerate = random.below(2) == 0;
    for j in 0..cuts {
        let kind = if j < 2 || !degenerate { 9 } else { random.below(6) };
        let (i, k) = (random.below(j.max(1)), random.below(j.max(1)));
        let (slope, offset) = match kind {
            0 => (slopes[i].clone(), offsets[i]),
            1 => (&slopes[i] + vector(random, n) * 1e-8, offsets[i] + 1e-8 * random.signed()),
            2 => ((&slopes[i] + &slopes[k]) * 0.5, 0.5 * (offsets[i] + offsets[k])),
            3 => (&slopes[i] + vector(random, n) * 1e-4, offsets[i]),
            _ => (vector(random, n), 0.3 * random.signed()),
        };
        slopes.push(slope);
        offsets.push(offset);
    }
    (slopes, offsets)
}

fn random_rows(random: &mut Random, inside: &Vector, p: usize) -> (Matrix, Vector, Vector) {
    let n = inside.len();
    let (mut rows, mut low, mut high) = (Matrix::zeros(p, n), Vector::zeros(p), Vector::zeros(p));
    for i in 0..p {
        if i > 0 && random.below(4) == 0 {
            // A repetition of an earlier row, perhaps scaled: redundant rows, repeated equalities.
            let (k, factor) = (random.below(i), if random.below(2) == 0 { 1.0 } else { 2.0 });
            for j in 0..n {
                rows[(i, j)] = factor * rows[(k, j)];
            }
            (low[i], high[i]) = (factor * low[k], factor * high[k]);
            continue;
        }
        for _ in 0..3 {
            let j = random.below(n);
            rows[(i, j)] = random.signed();
        }
        let value = rows.row(i).transpose().dot(inside);
        (low[i], high[i]) = match random.below(6) {
            0 if i < n / 3 => (value, value),
            1 => (f64::NEG_INFINITY, value + 0.3 * random.unit()),
            2 => (value - 0.3 * random.unit(), f64::INFINITY),
            3 => (value, value + 0.2 * random.unit()),
            _ => (value - 0.2 * random.unit(), value + 0.2 * random.unit()),
        };
    }
    (rows, low, high)
}

fn random_box(random: &mut Random, inside: &Vector) -> (Vector, Vector) {
    let (mut lower, mut upper) = (inside.clone(), inside.clone());
    for k in 0..inside.len() {
        match random.below(8) {
            0 => {}
            1 | 2 => (lower[k], upper[k]) = (f64::NEG_INFINITY, f64::INFINITY),
            3 => lower[k] = f64::NEG_INFINITY,
            _ => (lower[k], upper[k]) = (lower[k] - 0.5 * random.unit(), upper[k] + 0.5 * random.unit()),
        }
    }
    (lower, upper)
}

/// Sizes of a synthetic bundle run.
#[derive(Clone, Copy, Debug)]
pub struct BundleSequence {
    pub dimension: usize,
    /// Quadratic pieces of the function.
    pub pieces: usize,
    /// Capacity of the bundle.
    pub cuts: usize,
    pub rows: usize,
    pub solves: usize,
}

/// max_k ½ c_k |x − z_k|² + b_kᵀ x.
struct MaxOfQuadratics(Vec<(f64, Vector, Vector)>);

impl MaxOfQuadratics {
    fn value_and_subgradient(&self, x: &Vector) -> (f64, Vector) {
        let one = |(c, z, b): &(f64, Vector, Vector)| (0.5 * c * (x - z).norm_squared() + b.dot(x), (x - z) * *c + b);
        let all = self.0.iter().map(one);
        all.max_by(|a, b| a.0.total_cmp(&b.0)).expect("at least one piece")
    }
}

impl BundleSequence {
    /// The QPs of a proximal bundle loop with weight control.
    pub fn record(&self, seed: u64) -> Vec<OwnedQp> {
        let mut random = Random(seed);
        let n = self.dimension;
        let pieces = (0..self.pieces).map(|_| (random.unit(), vector(&mut random, n), vector(&mut random, n)));
        let function = MaxOfQuadratics(pieces.collect());
        let mut rows = Matrix::zeros(self.rows, n);
        for i in 0..self.rows {
            (0..3).for_each(|_| rows[(i, random.below(n))] = random.signed());
        }
        let (low, high) = (Vector::from_element(self.rows, -0.3), Vector::from_element(self.rows, 0.3));
        let mut center = Vector::zeros(n);
        let (mut value, slope) = function.value_and_subgradient(&center);
        let mut weight = slope.norm();
        let mut bundle: Vec<(u64, Vector, f64, Vector)> = vec![(0, center.clone(), value, slope)];
        let (mut record, mut solver) = (Vec::new(), nonsmooth::qp::EpigraphQpSolver::new());
        for solve in 0..self.solves {
            let shift = &rows * &center;
            let qp = OwnedQp {
                metric: OwnedMetric::ScaledIdentity(weight),
                slopes: bundle.iter().map(|cut| cut.3.clone()).collect(),
                offsets: bundle.iter().map(|cut| (value - cut.2 - cut.3.dot(&(&center - &cut.1))).max(0.0)).collect(),
                cut_ids: bundle.iter().map(|cut| cut.0).collect(),
                rows: rows.clone(),
                row_lower: &low - &shift,
                row_upper: &high - &shift,
                lower: Vector::from_element(n, -0.5) - &center,
                upper: Vector::from_element(n, 0.5) - &center,
            };
            let solution = solver.solve(&qp.view()).expect("the center is admissible");
            record.push(qp);
            let trial = &center + &solution.step;
            let (trial_value, slope) = function.value_and_subgradient(&trial);
            if bundle.len() >= self.cuts {
                let unused = (0..bundle.len()).find(|&j| solution.cut_multipliers[j] == 0.0).unwrap_or(0);
                bundle.remove(unused);
            }
            bundle.push((solve as u64 + 1, trial.clone(), trial_value, slope));
            if trial_value - value <= 0.1 * solution.epigraph {
                (center, value) = (trial, trial_value);
                weight *= if random.below(2) == 0 { 0.4 } else { 1.0 };
            } else if random.below(6) == 0 {
                weight *= 2.0;
            }
        }
        record
    }
}
