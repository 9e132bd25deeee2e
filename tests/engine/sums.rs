//! Sums of a smooth function and a convex one: total variation, hinge losses, the lasso, the group lasso.

use crate::common::is_study;
use nonsmooth::composite::{
    ConeFunction, Epigraph, EuclideanNorm, FnOuter, GroupNorms, Maximum, OuterFunction, PositiveParts, SmoothPlus,
    SumOfPowers,
};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{BundleTrust, BundleTrustConfig, CompositeFunction, Convexity, Matrix, Report, Vector};
use std::cell::RefCell;

/// s(x) + μ h(G x + c), with s = |A x − b|²/2.
struct Sum {
    name: &'static str,
    weight: f64,
    outer: Box<dyn OuterFunction>,
    squares: (Matrix, Vector),
    outputs: (Matrix, Vector),
}

impl Sum {
    fn new<H: OuterFunction + 'static>(
        (name, weight, outer): (&'static str, f64, H),
        squares: (Matrix, Vector),
        outputs: (Matrix, Vector),
    ) -> Self {
        Self { name, weight, outer: Box::new(SmoothPlus { weight, outer }), squares, outputs }
    }

    fn answer(&self, x: &Vector) -> (Vector, Matrix) {
        let ((a, b), (g, c)) = (&self.squares, &self.outputs);
        let residual = a * x - b;
        SmoothPlus::stack((0.5 * residual.norm_squared(), &a.tr_mul(&residual)), (&(g * x + c), g))
    }

    fn minimize(&self, outer: &dyn OuterFunction) -> Report {
        self.minimize_counted(outer).0
    }

    /// The report, and the number of evaluations up to a value that lies at most 1e-8 above the last one.
    fn minimize_counted(&self, outer: &dyn OuterFunction) -> (Report, usize) {
        let n = self.squares.0.ncols();
        let values = RefCell::new(vec![]);
        let theta = CompositeFunction::new(n, outer, |x: &Vector| {
            let (outputs, jacobian) = self.answer(x);
            values.borrow_mut().push(outer.value(&outputs));
            (outputs, jacobian)
        });
        let config = BundleTrustConfig {
            max_evaluations: 200,
            tolerance: 1e-8,
            convexity: Convexity::Convex,
            ..BundleTrustConfig::default()
        };
        let report = BundleTrust::new(config).unwrap().minimize(&theta, Vector::zeros(n)).unwrap();
        let reached = |value: &f64| value - report.value <= 1e-8 * report.value.abs();
        let count = 1 + values.borrow().iter().position(reached).unwrap();
        (report, count)
    }
}

fn data(rows: usize, columns: usize, seed: u64) -> Matrix {
    let size = (columns as f64).sqrt();
    let row = |i: usize| (seeded_direction(columns, seed + i as u64) * size).transpose();
    Matrix::from_rows(&(0..rows).map(row).collect::<Vec<_>>())
}

/// Five steps with noise.
fn total_variation(n: usize) -> Sum {
    let steps = Vector::from_fn(n, |i, _| if (5 * i / n).is_multiple_of(2) { 1.0 } else { 3.0 });
    let noisy = steps + seeded_direction(n, 1) * (0.3 * (n as f64).sqrt());
    let differences = Matrix::from_fn(n - 1, n, |i, j| f64::from(u8::from(j == i + 1)) - f64::from(u8::from(j == i)));
    let outer = SumOfPowers { exponent: 1.0 };
    Sum::new(("total variation", 2.0, outer), (Matrix::identity(n, n), noisy), (differences, Vector::zeros(n - 1)))
}

fn hinges(n: usize) -> Sum {
    let points = data(5 * n / 2, n, 100);
    let noise = seeded_direction(points.nrows(), 2) * (5.0 * (n as f64).sqrt());
    let labels = (&points * seeded_direction(n, 3) * (n as f64).sqrt() + noise).map(f64::signum);
    let margins = -Matrix::from_diagonal(&labels) * &points;
    let (weight, count) = (1.0 / labels.len() as f64, labels.len());
    let squares = (Matrix::identity(n, n) * 0.1_f64.sqrt(), Vector::zeros(n));
    Sum::new(("hinges", weight, PositiveParts), squares, (margins, Vector::from_element(count, 1.0)))
}

fn sparse_fit<H: OuterFunction + 'static>(name: &'static str, n: usize, outer: H) -> Sum {
    let a = data(2 * n / 3, n, 500) / (n as f64).sqrt();
    let wanted = Vector::from_fn(n, |i, _| if i % 20 < 5 { (3 * i) as f64 - n as f64 } else { 0.0 }) / n as f64;
    let b = &a * wanted + seeded_direction(a.nrows(), 4) * 0.05;
    let weight = 0.1 * a.tr_mul(&b).amax();
    Sum::new((name, weight, outer), (a, b), (Matrix::identity(n, n), Vector::zeros(n)))
}

/// |x − b|²/2 and a function of x itself.
fn proximal<H: OuterFunction + 'static>(name: &'static str, n: usize, outer: H) -> Sum {
    let squares = (Matrix::identity(n, n), seeded_direction(n, 5) * 3.0);
    Sum::new((name, 0.5, outer), squares, (Matrix::identity(n, n), Vector::zeros(n)))
}

/// A function of a user: half the sum of absolute values of the first third of the outputs, the positive parts of the
/// next, and the norm of the rest.
struct Mixed;

impl Mixed {
    fn thirds(outputs: usize) -> [usize; 3] {
        [outputs / 3, outputs / 3, outputs - 2 * (outputs / 3)]
    }

    fn parts(outputs: &Vector) -> [(Vector, f64, Box<dyn OuterFunction>); 3] {
        let [first, second, third] = Self::thirds(outputs.len());
        let part = |from: usize, count: usize| outputs.rows(from, count).into_owned();
        [
            (part(0, first), 0.5, Box::new(SumOfPowers { exponent: 1.0 })),
            (part(first, second), 1.0, Box::new(PositiveParts)),
            (part(first + second, third), 1.0, Box::new(EuclideanNorm)),
        ]
    }
}

impl OuterFunction for Mixed {
    fn value(&self, outputs: &Vector) -> f64 {
        Self::parts(outputs).iter().map(|(own, weight, function)| weight * function.value(own)).sum()
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        let slopes = Self::parts(outputs).map(|(own, weight, function)| function.subgradient(&own) * weight);
        Vector::from_iterator(outputs.len(), slopes.iter().flat_map(|slope| slope.iter().copied()))
    }

    fn epigraph(&self, outputs: usize) -> Option<Epigraph> {
        let [first, second, third] = Self::thirds(outputs);
        let absolute = Epigraph::default().and(ConeFunction::AbsoluteValues, 0.5, first);
        Some(absolute.and(ConeFunction::PositiveParts, 1.0, second).and(ConeFunction::Norm, 1.0, third))
    }
}

fn sums(n: usize) -> [Sum; 6] {
    [
        total_variation(n),
        hinges(n),
        sparse_fit("lasso", n, SumOfPowers { exponent: 1.0 }),
        sparse_fit("group lasso", n, GroupNorms { sizes: vec![5; n / 5] }),
        proximal("largest entry", n, Maximum),
        proximal("terms of a user", n, Mixed),
    ]
}

#[test]
fn sums_reach_eight_digits_within_thirty_evaluations_and_end_confirmed() {
    let sizes = if is_study() { vec![80, 200, 1000] } else { vec![80] };
    for sum in sizes.into_iter().flat_map(sums) {
        let begun = std::time::Instant::now();
        let (report, reached) = sum.minimize_counted(&*sum.outer);
        let (evaluations, seconds) = (report.counts.evaluations, begun.elapsed().as_secs_f64());
        let per_evaluation = seconds / evaluations as f64;
        let n = report.solution.len();
        let course = format!("1e-8 after {reached} of {evaluations} evaluations, {per_evaluation:.3} s each");
        println!("{} n = {n}: {course}; {}", sum.name, report.termination);
        assert!(report.termination.is_confirmed(), "{}: {report}", sum.name);
        assert!(reached <= 30, "{}: {reached}, {report}", sum.name);
        let certificate = report.certificate.as_ref().unwrap();
        // A proof may come from the cuts as well.
        let Some(proof) = &certificate.composite else { continue };
        assert!(proof.recheck(certificate, &*sum.outer).unwrap().largest() < 1e-9, "{}", sum.name);
    }
}

/// As closures, the sums are solved by cuts: a second path to their minima.
#[test]
fn cones_and_cuts_lead_to_the_same_minimum() {
    for sum in sums(10) {
        let by_cones = sum.minimize(&*sum.outer);
        let closure = FnOuter::new(|c: &Vector| (sum.outer.value(c), sum.outer.subgradient(c)));
        let by_cuts = sum.minimize(&closure);
        let difference = (by_cones.value - by_cuts.value).abs();
        assert!(difference <= 1e-7 * by_cuts.value.abs(), "{}: {by_cones}\n{by_cuts}", sum.name);
        assert!(by_cones.value <= by_cuts.value + 1e-9 * by_cuts.value.abs(), "{}", sum.name);
    }
}

/// Where entries vanish, the slopes of the squares lie between −μ and μ; elsewhere they are −μ times the sign.
#[test]
fn the_lasso_fulfils_its_conditions_of_optimality() {
    let sum = sparse_fit("lasso", 200, SumOfPowers { exponent: 1.0 });
    let report = sum.minimize(&*sum.outer);
    let (a, b) = &sum.squares;
    let slopes = a.tr_mul(&(a * &report.solution - b)) / sum.weight;
    let missed = |(x, slope): (&f64, &f64)| match x.abs() > 1e-6 {
        true => (slope + x.signum()).abs(),
        false => (slope.abs() - 1.0).max(0.0),
    };
    let largest = report.solution.iter().zip(slopes.iter()).map(missed).fold(0.0, f64::max);
    assert!(largest <= 1e-4, "{largest:e}, {report}");
    assert!(report.solution.iter().filter(|x| x.abs() <= 1e-6).count() > 50, "{report}");
}

/// Chained Mifflin 2: Σ −x_i + 2 c_i + 1.75 |c_i| with c_i = x_i² + x_{i+1}² − 1, whose kinks are as many as the
/// variables.
#[test]
fn many_kinks_take_few_evaluations_where_the_outputs_are_given() {
    // Values of the literature.
    let known = [(50, -34.795), (200, -140.86), (1000, -706.55)];
    for (n, value) in known.into_iter().take(if is_study() { 3 } else { 1 }) {
        let outer = SmoothPlus { weight: 1.75, outer: SumOfPowers { exponent: 1.0 } };
        let theta = CompositeFunction::new(n, &outer, |x: &Vector| {
            let circles = Vector::from_fn(n - 1, |i, _| x[i] * x[i] + x[i + 1] * x[i + 1] - 1.0);
            let rows = Matrix::from_fn(n - 1, n, |i, j| if j == i || j == i + 1 { 2.0 * x[j] } else { 0.0 });
            let kept = Vector::from_fn(n, |i, _| f64::from(u8::from(i < n - 1)));
            let smooth = 2.0 * circles.sum() - kept.dot(x);
            SmoothPlus::stack((smooth, &(rows.row_sum().transpose() * 2.0 - kept)), (&circles, &rows))
        });
        let config = BundleTrustConfig { convexity: Convexity::Convex, ..BundleTrustConfig::default() };
        let report = BundleTrust::new(config).unwrap().minimize(&theta, Vector::from_element(n, -1.0)).unwrap();
        println!("chained Mifflin 2, n = {n}: {} evaluations, {}", report.counts.evaluations, report.value);
        assert!(report.termination.is_confirmed() && report.counts.evaluations <= 20, "n = {n}: {report}");
        assert!((report.value - value).abs() <= 0.005, "n = {n}: {report}");
    }
}
