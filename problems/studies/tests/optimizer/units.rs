//! The engine on convex problems in variables of different units, and whether what it says at the end is true.
//!
//! ```text
//! size = max(Θ(start) − min Θ, mean rise of Θ one unit of every variable away from the minimiser)
//! reached: Θ(x) − min Θ ≤ 1e-6 size + rounding
//! false: confirmed, and   Θ(x) − min Θ > 1e-5 size + rounding
//!                    or   Θ(x) − min Θ > gap + rounding, for Θ declared convex in a finite box
//!                    or   x outside of the set by more than 1e-9
//! ```

use super::Run;
use super::problem::Problem;
use nonsmooth::composite::FnOuter;
use nonsmooth::interruption::watched;
use nonsmooth::{
    BundleTrust, BundleTrustConfig, CompositeFunction, Convexity, FnObjective, OptimizeError, Report, Termination,
    Vector,
};
use rayon::prelude::*;
use std::time::{Duration, Instant};
use testset::kit::Random;

/// Largest decimal exponent of the units.
const LARGEST_SPREAD: usize = 8;
/// Problems of a family, a set and a spread: as many as there are pairs of an offset and a start.
const PROBLEMS: usize = OFFSETS.len() * STARTS.len();
/// Constants added to Θ.
const OFFSETS: [f64; 3] = [0.0, 100.0, -1e4];
/// Starts: the last one beyond the constraints that are active at the minimiser.
const STARTS: [&str; 4] = ["from zero", "from afar", "at the minimiser", "beyond the minimiser"];
/// Entries of a start from afar, in variables of unit 1.
const AFAR: f64 = 8.0;
/// What the engine is told: values and subgradients alone; that Θ is convex; the outputs with their Jacobian.
const GIVEN: [&str; 3] = ["plain", "convex", "outputs"];
const MAX_EVALUATIONS: usize = 1000;
/// Time of a run, usually a hundredth of a second: steps without evaluations have no limit, but no run may hang.
const LONGEST_RUN: Duration = Duration::from_secs(30);
/// Largest excess of a confirmed end, and of a minimum that is reached, relative to the size of Θ.
const GAP: (f64, f64) = (1e-5, 1e-6);
/// Rounding errors of Θ, relative to the terms that it is computed from.
const ROUNDING: f64 = 1e-13;
/// Violation of the set that counts as rounding.
const VIOLATION: f64 = 1e-9;

/// A problem in units, with all that a run is told.
struct UnitCase {
    /// The problem in variables of unit 1.
    problem: Problem,
    units: Vector,
    offset: f64,
    start: Vector,
    given: &'static str,
    name: String,
    /// "1e±3", the range of the units.
    range: String,
}

/// The runs of a problem: each with another thing given.
fn runs_of(problem: &Problem, units: &Vector, number: usize, set: &str, random: &mut Random) -> Vec<UnitCase> {
    let spread = units.iter().map(|unit| unit.log10().abs().round() as usize).max().unwrap_or(0);
    let (offset, kind) = (OFFSETS[number % OFFSETS.len()], STARTS[number / OFFSETS.len() % STARTS.len()]);
    let start = match kind {
        "from zero" => Vector::zeros(units.len()),
        "from afar" => units.map(|_| AFAR * random.signed()),
        "at the minimiser" => problem.minimiser.clone(),
        _ => &problem.minimiser + &problem.normal,
    };
    let case = |given: &'static str| UnitCase {
        problem: problem.clone(),
        units: units.clone(),
        offset,
        start: start.clone(),
        given,
        name: format!("{}, {given}, {set}, 1e{spread}, {kind}, {offset:+}, #{number}", problem.family),
        range: format!("1e±{spread}"),
    };
    GIVEN.map(case).into()
}

/// Units 10^u with u uniform in [−spread, spread], or all but one equal to 1.
fn units(random: &mut Random, n: usize, spread: usize) -> Vector {
    let largest = spread as f64;
    if random.below(2) == 0 {
        let mut units = Vector::from_fn(n, |_, _| 10_f64.powf(largest * random.signed()));
        // One reaches the end of the range.
        units[random.below(n)] = 10_f64.powf(largest);
        return units;
    }
    // A large unit hides a variable more often than a small one: its derivatives are small beside the others.
    let (one, sign) = (random.below(n), if random.below(4) == 0 { -1.0 } else { 1.0 });
    Vector::from_fn(n, |i, _| if i == one { 10_f64.powf(sign * largest) } else { 1.0 })
}

/// All runs: random problems by spread, from equal units on, then those of users.
fn cases() -> Vec<UnitCase> {
    let mut all = vec![];
    for spread in 0..=LARGEST_SPREAD {
        let kinds = Problem::FAMILIES.into_iter().flat_map(|family| Problem::SETS.map(|set| (family, set)));
        for (kind, (family, set)) in kinds.enumerate().filter(|(_, kind)| *kind != ("linear function", "free")) {
            for number in 0..PROBLEMS {
                let mut random = Random((kind * 1_000_000 + spread * 10_000 + number) as u64);
                let problem = Problem::random(family, set, number, &mut random);
                let units = units(&mut random, problem.minimiser.len(), spread);
                all.extend(runs_of(&problem, &units, number, set, &mut random));
            }
        }
    }
    for (index, (problem, units)) in Problem::of_users().iter().enumerate() {
        for number in 0..PROBLEMS {
            let set = format!("{} {index}", if problem.is_boxed() { "box" } else { "free" });
            all.extend(runs_of(problem, units, number, &set, &mut Random(number as u64)));
        }
    }
    all
}

/// Runs the engine on Θ + offset in the units of the user.
fn minimise(case: &UnitCase, problem: &Problem) -> Result<Report, OptimizeError> {
    let (n, offset, start) = (case.units.len(), case.offset, case.start.component_mul(&case.units));
    let convexity = if case.given == "convex" { Convexity::Convex } else { Convexity::Unknown };
    let config = BundleTrustConfig { max_evaluations: MAX_EVALUATIONS, convexity, ..Default::default() };
    let mut method = BundleTrust::new(config)?.constraints(problem.set());
    let outer = problem.outer.function();
    if case.given != "outputs" {
        let theta = FnObjective::new(n, |x: &Vector| {
            let (outputs, jacobian) = problem.outputs(x);
            (outer.value(&outputs) + offset, jacobian.tr_mul(&outer.subgradient(&outputs)))
        });
        return method.minimize(&theta, start);
    }
    let outputs = |x: &Vector| problem.outputs(x);
    if offset == 0.0 {
        // As a function of the engine, of which it knows more than values.
        return method.minimize(&CompositeFunction::new(n, &*outer, outputs), start);
    }
    let shifted = FnOuter::new(|r: &Vector| (outer.value(r) + offset, outer.subgradient(r)));
    method.minimize(&CompositeFunction::new(n, shifted, outputs), start)
}

/// Runs one case. A run that the engine refuses does not reach the minimum.
fn checked(case: UnitCase) -> Run {
    let problem = case.problem.in_units(&case.units);
    let set = problem.set();
    let (boxed, begin) = (problem.is_boxed(), Instant::now());
    let given = format!("{}, {}", case.given, if boxed { "box" } else { "no box" });
    let report = watched(move || begin.elapsed() > LONGEST_RUN, || minimise(&case, &problem));
    let mut run = Run { name: case.name, rows: [given, case.range], ..Run::default() };
    let report = match report {
        Ok(report) => report,
        Err(error) => {
            run.termination = format!("refused: {error}");
            return run;
        }
    };
    let minimum = case.problem.value(&case.problem.minimiser);
    let above = problem.value(&report.solution) - minimum;
    let size = (report.start_value - case.offset - minimum).max(case.problem.rise());
    let rounding = ROUNDING * (case.offset.abs() + problem.size_of_terms(&report.solution));
    let gap = match report.termination {
        Termination::Stationary { gap, .. } => gap.filter(|_| boxed && case.given == "convex"),
        _ => None,
    };
    run.excess = above / size;
    run.reached = above <= GAP.1 * size + rounding;
    run.confirmed = report.termination.is_confirmed();
    run.wrong = match () {
        () if !run.confirmed => None,
        () if above.is_nan() || above > GAP.0 * size + rounding => Some("value above the minimum"),
        () if gap.is_some_and(|gap| above > gap + rounding) => Some("gap too small"),
        () if set.violation(&report.solution) > VIOLATION => Some("outside of the set"),
        () => None,
    };
    run.evaluations = report.counts.evaluations;
    run.termination = report.termination.to_string();
    run
}

/// Runs those that `wanted` selects by their names, on all processors; they keep their order.
pub fn mixed_units(mut wanted: impl FnMut(&str) -> bool) -> Vec<Run> {
    let cases: Vec<UnitCase> = cases().into_iter().filter(|case| wanted(&case.name)).collect();
    cases.into_par_iter().map(checked).collect()
}
