//! Small objectives and sets that several tests share.

use nonsmooth::{
    Answer, BundleTrust, BundleTrustConfig, Evaluation, FnObjective, Matrix, NonsmoothObjective, OracleError,
    Polyhedron, Report, Request, Vector,
};
use testset::Problem;
use testset::kit::{jitter, jitters};

/// A vector from its entries.
pub fn v(entries: &[f64]) -> Vector {
    Vector::from_column_slice(entries)
}

/// Starts x₀ (1 + 1e-13 jitter), x₀ itself first: a single count hangs on the last bit, the median over them does not.
pub fn nearby_starts(problem: &Problem, count: u64) -> impl Iterator<Item = Vector> {
    let start = v(&problem.start);
    (0..count).map(move |seed| {
        let size = if seed == 0 { 0.0 } else { 1e-13 };
        let factors = jitters(start.as_slice(), seed).map(|entry| 1.0 + size * entry);
        Vector::from_iterator(start.len(), start.iter().zip(factors).map(|(x, factor)| x * factor))
    })
}

/// A problem above a shift, with values off by up to `error`, of which `promised` is told.
pub struct Inaccurate<'p> {
    pub problem: &'p Problem,
    pub shift: f64,
    pub error: f64,
    pub promised: f64,
}

impl NonsmoothObjective for Inaccurate<'_> {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.problem.dimension
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let (value, slope) = self.problem.evaluate(request.point.as_slice());
        let value = value + self.shift + self.error * jitter(request.point.as_slice(), 0);
        let evaluation = Evaluation::exact(value, Vector::from_vec(slope), ());
        Ok(Answer::Accurate(Evaluation { error_bound: self.promised, ..evaluation }))
    }
}

/// The median of an odd number of values.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Σ |x_i − target_i|.
pub fn distance_1(target: Vector) -> FnObjective<impl Fn(&Vector) -> (f64, Vector)> {
    FnObjective::new(target.len(), move |x: &Vector| {
        let d = x - &target;
        (d.abs().sum(), d.map(|entry| if entry == 0.0 { 0.0 } else { entry.signum() }))
    })
}

/// max over pieces x ↦ (value, gradient), the first of equals.
pub fn maximum(pieces: Vec<(f64, Vector)>) -> (f64, Vector) {
    pieces.into_iter().reduce(|best, piece| if piece.0 > best.0 { piece } else { best }).unwrap()
}

/// CB3, a convex minimax function with minimum 2 at (1, 1).
pub fn cb3() -> FnObjective<impl Fn(&Vector) -> (f64, Vector)> {
    FnObjective::new(2, |x: &Vector| {
        let (a, b) = (x[0], x[1]);
        let e = 2.0 * (b - a).exp();
        maximum(vec![
            (a.powi(4) + b * b, v(&[4.0 * a.powi(3), 2.0 * b])),
            ((2.0 - a).powi(2) + (2.0 - b).powi(2), v(&[2.0 * a - 4.0, 2.0 * b - 4.0])),
            (e, v(&[-e, e])),
        ])
    })
}

/// The nonconvex, nonsmooth Rosenbrock function |10 (x₂ − x₁²)| + |1 − x₁| with minimum 0 at (1, 1).
pub fn crescent() -> FnObjective<impl Fn(&Vector) -> (f64, Vector)> {
    FnObjective::new(2, |x: &Vector| {
        let (r, s) = (10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]);
        let (dr, ds) = (r.signum(), s.signum());
        (r.abs() + s.abs(), v(&[-20.0 * x[0] * dr - ds, 10.0 * dr]))
    })
}

/// Runs with the default settings.
pub fn minimize<O: NonsmoothObjective>(objective: &O, set: Option<Polyhedron>, start: &[f64]) -> Report {
    let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap();
    if let Some(set) = set {
        method = method.constraints(set);
    }
    method.minimize(objective, v(start)).unwrap()
}

/// {x : a·x = b} and a box.
pub fn plane(normal: &[f64], side: f64, half_width: f64) -> Polyhedron {
    let n = normal.len();
    Polyhedron::boxed(Vector::from_element(n, -half_width), Vector::from_element(n, half_width))
        .unwrap()
        .with_rows(&Matrix::from_row_slice(1, n, normal), &v(&[side]), &v(&[side]))
        .unwrap()
}

/// Whether the tests of peers run at the sizes of the study: STUDY=full.
pub fn is_study() -> bool {
    std::env::var("STUDY").is_ok_and(|value| value == "full")
}
