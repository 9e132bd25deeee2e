//! The termination of a run is true, whatever the start, a shift, units, a wide side, failures and huge answers.
use crate::common::{Inaccurate, maximum, median, nearby_starts, v};
use nonsmooth::{
    Answer, BundleTrust, BundleTrustConfig, Convexity, Evaluation, FnObjective, NonsmoothObjective, OracleError,
    Polyhedron, Report, Request, Termination, Vector,
};
use std::cell::Cell;
use testset::{Family, Problem};

fn method(problem: &Problem) -> BundleTrust<'static> {
    let convexity = if problem.convex { Convexity::Convex } else { Convexity::Unknown };
    BundleTrust::new(BundleTrustConfig { convexity, max_evaluations: 1000, ..Default::default() }).unwrap()
}

/// Minimises a·f(x) + s from a multiple of the start.
fn run(problem: &Problem, (start, shift, factor): (f64, f64, f64), set: Option<Polyhedron>) -> Report {
    run_from(problem, v(&problem.start) * start, (shift, factor), set)
}

/// Minimises a·f(x) + s from a point.
fn run_from(problem: &Problem, start: Vector, (shift, factor): (f64, f64), set: Option<Polyhedron>) -> Report {
    let theta = FnObjective::new(problem.dimension, |x: &Vector| {
        let (value, gradient) = problem.evaluate(x.as_slice());
        (factor * value + shift, Vector::from_vec(gradient) * factor)
    });
    let method = method(problem);
    let mut method = if let Some(set) = set { method.constraints(set) } else { method };
    method.minimize(&theta, start).unwrap()
}

/// (value − a f* − s)/a relative to 1 + |f*|.
fn gap(problem: &Problem, report: &Report, (shift, factor): (f64, f64)) -> f64 {
    ((report.value - shift) / factor - problem.optimal_value) / (1.0 + problem.optimal_value.abs())
}

fn convex() -> Vec<Problem> {
    testset::all().into_iter().filter(|problem| problem.convex && problem.family == Family::Unconstrained).collect()
}

/// Evaluations are medians over starts that differ by 1e-13; the terminations are those from the start of the
/// collection.
#[test]
fn a_convex_function_is_confirmed_by_its_bound_without_restarts() {
    let (mut evaluations, mut needed) = (0.0, 0.0);
    for problem in convex() {
        let level = problem.optimal_value + 1e-6 * (1.0 + problem.optimal_value.abs());
        let (mut all, mut first) = (vec![], vec![]);
        for (index, start) in nearby_starts(&problem, 11).enumerate() {
            let report = run_from(&problem, start, (0.0, 1.0), None);
            if index == 0 {
                let Termination::Stationary { gap: Some(bound), .. } = report.termination else { panic!("{report}") };
                // The optimal values of the table have twelve digits.
                let above = report.value - problem.optimal_value - 1e-8 * (1.0 + problem.optimal_value.abs());
                assert!(above <= bound && report.counts.restarts == 0, "{}: {above:.1e} {report}", problem.name);
            }
            all.push(report.counts.evaluations as f64);
            first.push(report.history.iter().find(|r| r.center_value <= level).unwrap().evaluation as f64);
        }
        evaluations += median(all);
        needed += median(first);
    }
    println!("{evaluations} evaluations, {needed} to 1e-6, ratio {:.3}", evaluations / needed);
    // 1.16 where this was written.
    assert!(evaluations <= 1.18 * needed, "{evaluations} {needed}");
}

#[test]
fn start_shift_and_units_never_confirm_what_is_far_from_stationary() {
    for problem in convex().iter().filter(|problem| problem.dimension <= 10) {
        for start in [1e-12, 1e-8, 1e-4, 1e3] {
            for (shift, factor) in [(0.0, 1.0), (1e8, 1.0), (-1e8, 1.0), (0.0, 1e6), (1e8, 1e-6)] {
                let report = run(problem, (start, shift, factor), None);
                let above = gap(problem, &report, (shift, factor));
                let allowed = 1e-5 + 4.0 * f64::EPSILON * shift.abs() / factor;
                let name = format!("{} start × {start:e}, {factor:e} f + {shift:e}", problem.name);
                assert!(above <= allowed || !report.termination.is_confirmed(), "{name}: {above:.1e} {report}");
            }
        }
    }
}

#[test]
fn one_wide_side_confirms_nothing_false() {
    for problem in convex().iter().filter(|problem| problem.dimension <= 10) {
        let mut upper = Vector::from_element(problem.dimension, 100.0);
        upper[0] = 1e8;
        let set = Polyhedron::boxed(Vector::from_element(problem.dimension, -100.0), upper).unwrap();
        for start in [1.0, 1e-8] {
            let report = run(problem, (start, 0.0, 1.0), Some(set.clone()));
            let above = gap(problem, &report, (0.0, 1.0));
            assert!(above <= 1e-5 || !report.termination.is_confirmed(), "{}: {above:.1e} {report}", problem.name);
        }
    }
}

/// |x − 1| + |y| with the noise that it states.
struct Stated(f64);

impl NonsmoothObjective for Stated {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        2
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let x = request.point;
        let value = (x[0] - 1.0).abs() + x[1].abs() + self.0 * testset::kit::jitter(x.as_slice(), 0);
        let subgradient = v(&[(x[0] - 1.0).signum(), x[1].signum()]);
        Ok(Answer::Accurate(Evaluation { error_bound: self.0, ..Evaluation::exact(value, subgradient, ()) }))
    }
}

#[test]
fn stated_noise_ends_in_a_noise_limit_that_bounds_the_gap() {
    for noise in [1e-8, 1e-4] {
        for start in [[0.0, 0.0], [3.0, -2.0], [1e-9, 1e-9], [1e3, 1e3]] {
            for convexity in [Convexity::Convex, Convexity::Unknown] {
                let config = BundleTrustConfig { convexity, ..Default::default() };
                let report = BundleTrust::new(config).unwrap().minimize(&Stated(noise), v(&start)).unwrap();
                let Termination::NoiseLimit { estimate } = report.termination else { panic!("{noise}: {report}") };
                let exact = (report.solution[0] - 1.0).abs() + report.solution[1].abs();
                assert!(exact <= estimate && exact <= 10.0 * noise, "{convexity:?} {exact:.1e} {report}");
            }
        }
    }
}

/// An answer of a function that may have none.
type Wild = Result<(f64, Vector), String>;

/// Θ(x) = max(|x|, 10 |y|), whose calls fail or answer hugely where `wild` says so.
fn wild(wild: impl Fn(&Vector) -> bool, answer: fn() -> Wild) -> Report {
    let theta = FnObjective::new(2, |x: &Vector| {
        if wild(x) {
            return answer();
        }
        let pair = if x[0].abs() > 10.0 * x[1].abs() {
            (x[0].abs(), v(&[x[0].signum(), 0.0]))
        } else {
            (10.0 * x[1].abs(), v(&[0.0, 10.0 * x[1].signum()]))
        };
        Ok::<_, String>(pair)
    });
    BundleTrust::new(BundleTrustConfig::default()).unwrap().minimize(&theta, v(&[30.0, 4.0])).unwrap()
}

#[test]
fn huge_answers_count_as_failed_evaluations() {
    let answers: [fn() -> Wild; 3] =
        [|| Ok((1e200, v(&[1e200, 0.0]))), || Ok((1e40, v(&[1e40, -1e40]))), || Err("outside".to_owned())];
    for answer in answers {
        let calls = Cell::new(0);
        let report = wild(
            |x| {
                calls.set(calls.get() + 1);
                calls.get() > 1 && x[1] < -1.0 || calls.get() == 4
            },
            answer,
        );
        assert!(report.value < 1e-5 && report.counts.failed >= 1, "{report}");
    }
}

#[test]
fn repeated_failures_end_the_run_only_close_to_the_best_point() {
    // Nothing answers farther than 1e-12 from the start: the first steps are far too long.
    let start = v(&[30.0, 4.0]);
    let report = wild(|x| (x - &start).norm() > 1e-12, || Err("no answer".to_owned()));
    let Termination::OracleFailing { failures, last } = &report.termination else { panic!("{report}") };
    assert!(*failures >= 10 && last == "no answer", "{report}");
    let shortest = report.history.iter().skip(1).map(|record| record.step_length).fold(f64::INFINITY, f64::min);
    assert!(shortest <= 1e-6 * start.norm(), "{shortest:.1e}");
}

#[test]
fn a_report_prints_its_solution() {
    let report = wild(|_| false, || Err(String::new()));
    assert!(report.to_string().contains(&format!("solution:    [{:.6e}, ", report.solution[0])), "{report}");
    let theta = FnObjective::new(40, |x: &Vector| (x.norm_squared(), x * 2.0));
    let report =
        BundleTrust::new(BundleTrustConfig::default()).unwrap().minimize(&theta, Vector::from_element(40, 1.0));
    let text = report.unwrap().to_string();
    let line = text.lines().find(|line| line.starts_with("solution:")).unwrap();
    assert!(line.contains("…") && line.len() < 160, "{line}");
}

#[test]
fn a_valley_is_not_confirmed_because_its_start_lay_far_away() {
    // Slopes across are two hundred times those along; the starts lie 1e6 times as far away as the minimum, 1 at (0.5,
    // 0.125, …).
    let valley = FnObjective::new(4, |x: &Vector| {
        let (mut value, mut slope) = (1.0 + (x[0] - 0.5).abs(), Vector::zeros(4));
        slope[0] = (x[0] - 0.5).signum();
        for i in 0..3 {
            let across = x[i + 1] - 0.5 * x[i] * x[i];
            value += 100.0 * across.abs();
            slope[i + 1] += 100.0 * across.signum();
            slope[i] -= 100.0 * across.signum() * x[i];
        }
        (value, slope)
    });
    for seed in 0..12 {
        let start = Vector::from_fn(4, |i, _| 1e6 * ((i * 7 + seed * 3 + 1) as f64).sin());
        let config = BundleTrustConfig { max_evaluations: 2000, ..Default::default() };
        let report = BundleTrust::new(config).unwrap().minimize(&valley, start).unwrap();
        assert!(!report.termination.is_confirmed() || report.value - 1.0 <= 1e-5, "{seed}: {report}");
    }
}

#[test]
fn a_convex_bound_is_small_beside_more_than_a_far_start() {
    // The largest of n + 1 quadratics whose slopes at their common zero cancel: the minimum is 0. Starts lie 1e6 times
    // as far away as it.
    let above = (0..80).filter(|seed| {
        let n = 2 + seed % 3;
        let number = |index: usize| ((131 * seed + 17 * index + 1) as f64 * 0.618).sin();
        let vector = |first: usize| Vector::from_fn(n, |i, _| number(first + i));
        let mut slopes: Vec<Vector> =
            (0..n).map(|piece| vector(10 * piece) * 10f64.powf(2.0 * number(piece))).collect();
        let last = slopes.iter().fold(Vector::zeros(n), |sum, slope| sum - slope);
        slopes.push(last);
        let minimiser = vector(100);
        let theta = FnObjective::new(n, |x: &Vector| {
            let step = x - &minimiser;
            let piece = |(index, slope): (usize, &Vector)| {
                let (curvature, direction) = (2.5 * (1.0 + number(index)), vector(200 + 10 * index));
                let along = direction.dot(&step);
                let value = slope.dot(&step) + 0.5 * along * along + 0.5 * curvature * step.norm_squared();
                (value, slope + &direction * along + &step * curvature)
            };
            maximum(slopes.iter().enumerate().map(piece).collect())
        });
        let config = BundleTrustConfig { convexity: Convexity::Convex, max_evaluations: 1000, ..Default::default() };
        let report = BundleTrust::new(config).unwrap().minimize(&theta, vector(300) * 1e6).unwrap();
        report.termination.is_confirmed() && report.value > 1e-5
    });
    // 30 where the share was that of other functions. The one that is left starts at 6e12 and ends at 1.6e-5.
    assert!(above.count() <= 1);
}

/// exp(x) − 2x + |x − ½| from zero, scaled and shifted: the first step follows from Θ(0) and is 5e13, where the
/// function overflows.
#[test]
fn a_shift_does_not_end_a_run_from_zero_by_failures() {
    for shift in [1e8, -1e8] {
        let theta = FnObjective::new(1, |x: &Vector| {
            let (x, side) = (x[0], if x[0] >= 0.5 { 1.0 } else { -1.0 });
            let value = 1e-6 * (x.exp() - 2.0 * x + (x - 0.5).abs()) + shift;
            (value, v(&[1e-6 * (x.exp() - 2.0 + side)]))
        });
        let config = BundleTrustConfig { convexity: Convexity::Convex, max_evaluations: 1000, ..Default::default() };
        let report = BundleTrust::new(config).unwrap().minimize(&theta, v(&[0.0])).unwrap();
        let gap = (report.value - shift) / 1e-6 - (0.5_f64.exp() - 1.0);
        // Values are told to 1.5e-8, which is 0.015 of the unscaled function; the run may end where twelve such steps
        // are left.
        assert!(gap <= 0.18 && !matches!(report.termination, Termination::OracleFailing { .. }), "{gap:e} {report}");
    }
}

/// Σ w_i |x_i − m_i| + 1 with slopes and distances of very different size, from starts near zero: what a variable that
/// has hardly moved can still gain, its own value does not tell.
#[test]
fn a_variable_that_has_hardly_moved_is_not_at_its_minimum() {
    let ends = |weights: &[f64], minimiser: &[f64], start: Vector, side: f64| {
        let n = weights.len();
        let theta = FnObjective::new(n, |x: &Vector| {
            let steps = || x.iter().zip(minimiser).zip(weights);
            let value = 1.0 + steps().map(|((x, m), w)| w * (x - m).abs()).sum::<f64>();
            let slope = steps().map(|((x, m), w)| if x >= m { *w } else { -w });
            (value, Vector::from_iterator(n, slope))
        });
        let config = BundleTrustConfig { convexity: Convexity::Convex, max_evaluations: 1000, ..Default::default() };
        let set = Polyhedron::boxed(Vector::from_element(n, -side), Vector::from_element(n, side)).unwrap();
        let report = BundleTrust::new(config).unwrap().constraints(set).minimize(&theta, start).unwrap();
        let gap = match report.termination {
            Termination::Stationary { gap, .. } => gap.expect("a declared convex function has a bound"),
            _ => f64::INFINITY,
        };
        (gap, report.value - 1.0)
    };
    for (slope, start) in [(1e-3, [1.0, 0.0]), (3e-4, [0.0, 0.0]), (3e-4, [1e-3, 1e-3])] {
        for side in [200.0, 1e9] {
            let (bound, gap) = ends(&[1.0, slope], &[1.0, 100.0], v(&start), side);
            assert!(gap <= bound.max(1e-10), "slope {slope}, {start:?}: {gap:e} where at most {bound:e} was told");
        }
    }
    let below = (0..200).filter(|seed| {
        let number = |index: usize| ((131 * seed + 17 * index + 1) as f64 * 0.618).sin();
        let n = 2 + seed % 4;
        let weights: Vec<f64> = (0..n).map(|i| 10f64.powf(2.0 * number(i) - 2.0)).collect();
        let minimiser: Vec<f64> = (0..n).map(|i| number(10 + i) * 10f64.powf(1.0 + number(20 + i))).collect();
        let start = Vector::from_fn(n, |i, _| 1e-3 * number(30 + i));
        let (bound, gap) = ends(&weights, &minimiser, start, 1e9);
        gap > bound.max(1e-10)
    });
    assert_eq!(below.count(), 0);
}

/// Fails at every tenth point, the same points whenever they are asked for.
struct Riddled<'a>(&'a Problem);

impl NonsmoothObjective for Riddled<'_> {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.0.dimension
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let mix = |sum: u64, x: &f64| (sum ^ x.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        if request.point.iter().fold(7, mix) % 10 == 0 {
            return Err(OracleError::OutsideDomain { reason: "no answer here".to_owned() });
        }
        let (value, gradient) = self.0.evaluate(request.point.as_slice());
        Ok(Answer::Accurate(Evaluation::exact(value, Vector::from_vec(gradient), ())))
    }
}

#[test]
fn a_point_that_fails_is_not_proposed_again() {
    for problem in convex() {
        for seed in 1..6 {
            let start = v(&problem.start).map(|x| x + 0.01 * f64::from(seed));
            let Ok(report) = method(&problem).minimize(&Riddled(&problem), start) else { continue };
            assert!(!matches!(report.termination, Termination::OracleFailing { .. }), "{}: {report}", problem.name);
            let trials: Vec<f64> = report.history.iter().map(|record| record.step_length).collect();
            let failed = |i: &usize| report.history[*i].failure.is_some() && report.history[i - 1].failure.is_some();
            for i in (1..trials.len()).filter(failed) {
                assert!(trials[i] <= 0.51 * trials[i - 1], "{}, evaluation {i}: {report}", problem.name);
            }
        }
    }
}

/// Beside a shift of 1e8, values have eight digits. They hide decreases, but a noise limit is said only where the gap
/// is as small.
#[test]
fn a_shift_makes_no_noise_limit_far_from_the_minimum() {
    const SHIFT: f64 = 1e8;
    let (mut noise_limits, mut solved) = (0, 0);
    for steepness in [1.0, 5.0, 50.0, 500.0] {
        for start in 0..12 {
            let start = v(&[3.0 * (1.1 * f64::from(start)).sin(), 3.0 * (2.3 * f64::from(start)).cos()]);
            let valley = |x: &Vector| {
                let residual = x[0] * x[0] - x[1];
                let slope = steepness * residual.signum();
                let slopes = v(&[2.0 * slope * x[0] - 2.0 * (1.0 - x[0]), -slope]);
                (steepness * residual.abs() + (1.0 - x[0]).powi(2), slopes)
            };
            let shifted = FnObjective::new(2, |x: &Vector| {
                let (value, slope) = valley(x);
                (value + SHIFT, slope)
            });
            let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap();
            let report = method.minimize(&shifted, start).unwrap();
            let gap = valley(&report.solution).0;
            if let Termination::NoiseLimit { estimate } = report.termination {
                assert!(gap <= 10.0 * estimate, "{gap:.1e} {report}");
                noise_limits += 1;
            }
            solved += usize::from(gap < 1e-4);
        }
    }
    assert!(solved >= 28, "{noise_limits} noise limits, {solved} solved");
}

/// 10 max x_i + ‖x‖²/2 has its minimum −2.5 for 20 variables. At the start 0 its value is a rounding, an error or
/// noise, from which no length of a first step can be told.
#[test]
fn a_start_at_zero_with_hardly_a_value_is_left() {
    let problem = testset::all().into_iter().find(|problem| problem.name == "NesterovWorst_20").unwrap();
    for convexity in [Convexity::Convex, Convexity::Unknown] {
        for (shift, noise, promised) in
            [(1e-17, 0.0, 0.0), (1e-14, 0.0, 0.0), (1e-10, 1e-10, 0.0), (0.0, 1e-10, 1e-10), (0.0, 1e-6, 1e-6)]
        {
            let theta = Inaccurate { problem: &problem, shift, error: noise, promised };
            let config = BundleTrustConfig { convexity, ..Default::default() };
            let report = BundleTrust::new(config).unwrap().minimize(&theta, v(&problem.start)).unwrap();
            let gap = report.value - problem.optimal_value;
            assert!(gap < 1e-5 + 20.0 * noise, "{shift:.0e} {noise:.0e} {promised:.0e}: {gap:.1e} {report}");
        }
    }
}
