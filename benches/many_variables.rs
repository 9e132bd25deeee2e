//! The method's own time per evaluation with many variables, beside that of one product of the slopes of its bundle
//! with a vector.
//!
//! A run goes to 1e-6 several times. The time between two calls of the objective is that of one evaluation, and the
//! least of the same evaluation in all runs counts, so that other work of the machine does not. The product is that of
//! the slopes, each in a vector of its own, with a vector that stays in the cache: of as many slopes as the bundle
//! holds at the evaluation, and of those of the last bundle.

use std::cell::{Cell, RefCell};
use std::hint::black_box;
use std::time::{Duration, Instant};

use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Report, Vector};
use testset::Scalable;

/// How often everything is timed.
const REPETITIONS: usize = 9;

/// xᵀy with eight independent sums, as the compiler vectorises it.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    for (x, y) in x.as_chunks::<8>().0.iter().zip(y.as_chunks::<8>().0) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum()
}

/// A run to 1e-6 (1 + |f*|), and the time of the method before every call of the objective.
fn run(problem: &Scalable) -> (Report, Vec<Duration>) {
    let (times, returned, solved) = (RefCell::new(vec![]), Cell::new(Instant::now()), Cell::new(false));
    let level = problem.optimal_value + 1e-6 * (1.0 + problem.optimal_value.abs());
    let theta = FnObjective::new(problem.start.len(), |x: &Vector| {
        times.borrow_mut().push(returned.get().elapsed());
        let (value, gradient) = problem.evaluate(x.as_slice());
        solved.set(solved.get() || value <= level);
        let answer = (value, Vector::from_vec(gradient));
        returned.set(Instant::now());
        answer
    });
    let mut method = BundleTrust::new(BundleTrustConfig::default()).expect("the defaults are valid");
    returned.set(Instant::now());
    let mut run = method.start(&theta, Vector::from_vec(problem.start.clone())).expect("the start has a value");
    while !solved.get() && run.step().is_continue() {}
    let report = run.finish();
    (report, times.take())
}

/// The time of the product of a vector with the first of the slopes.
fn product(slopes: &[Vector], vector: &Vector, count: usize) -> Duration {
    let form = || slopes.iter().take(count).map(|slope| dot(slope.as_slice(), vector.as_slice())).sum::<f64>();
    let timed = || {
        let clock = Instant::now();
        black_box(form());
        clock.elapsed()
    };
    (0..REPETITIONS).map(|_| timed()).min().unwrap_or_default()
}

fn main() {
    println!("times in µs; ratios of the method to one product");
    println!(
        "{:14} {:>6} {:>12} {:>8} {:>9} {:>6} {:>13} {:>6}",
        "problem", "n", "evaluations", "method", "product", "ratio", "last product", "ratio"
    );
    for problem in [Scalable::chained_lq(1000), Scalable::chained_lq(400), Scalable::chained_cb3_ii(1000)] {
        let (report, mut own) = run(&problem);
        for _ in 1..REPETITIONS {
            own.iter_mut().zip(run(&problem).1).for_each(|(least, time)| *least = time.min(*least));
        }
        let cuts = report.certificate.iter().flat_map(|certificate| &certificate.cuts);
        let slopes: Vec<Vector> = cuts.map(|cut| cut.subgradient.clone()).collect();
        let products = report.history.iter().map(|record| product(&slopes, &report.solution, record.cuts));
        let each = |time: Duration| time.as_secs_f64() * 1e6 / report.counts.evaluations as f64;
        let (own, matched) = (each(own.iter().sum()), each(products.sum()));
        let last = product(&slopes, &report.solution, slopes.len()).as_secs_f64() * 1e6;
        println!(
            "{:14} {:6} {:12} {own:8.1} {matched:9.1} {:6.1} {last:13.1} {:6.1}",
            problem.name,
            problem.start.len(),
            report.counts.evaluations,
            own / matched,
            own / last
        );
    }
}
