//! One run of the engine, and whether what it says at the end is true.
//!
//! ```text
//! size = max(Θ(start) − min Θ, mean rise of Θ one unit of every variable away from the minimiser)
//! reached: Θ(x) − min Θ ≤ 1e-6 size + rounding
//! false: confirmed, and   Θ(x) − min Θ > 1e-5 size + rounding
//!                    or   Θ(x) − min Θ > gap + rounding, for Θ declared convex in a finite box
//!                    or   x outside of the set by more than 1e-9
//! ```

use crate::stability::mixed_units::cases::{Given, UnitCase};
use crate::stability::mixed_units::function::Function;
use crate::stability::mixed_units::problem::Start;
use crate::stability::mixed_units::truth::Truth;
use nonsmooth::interruption::watched;
use nonsmooth::{
    BundleTrust, BundleTrustConfig, CompositeFunction, Convexity, FnObjective, InputError, OptimizeError, Polyhedron,
    Report, Termination, Vector,
};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Evaluations of a run.
const MAX_EVALUATIONS: usize = 1000;
/// Time of a run, usually a hundredth of a second: no run may hang; steps without evaluations have no limit.
const LONGEST_RUN: Duration = Duration::from_secs(30);
/// Largest excess of a confirmed end, relative to the size of Θ.
const GAP: f64 = 1e-5;
/// Largest excess of a minimum that is reached.
const REACHED: f64 = 1e-6;
/// Rounding errors of Θ, relative to the terms that it is computed from.
const ROUNDING: f64 = 1e-13;
/// Relative violation of the set that counts as rounding.
const VIOLATION: f64 = 1e-9;

/// One run and what it claims.
#[derive(Debug, Clone, Serialize)]
pub struct UnitRecord {
    /// Name of the run; `--only` with it takes this run alone.
    pub name: String,
    /// Family of the problem.
    pub family: &'static str,
    /// What the engine was told.
    pub given: Given,
    /// Whether every variable has two finite bounds.
    pub boxed: bool,
    pub start: &'static str,
    /// Largest decimal exponent of the units.
    pub spread: usize,
    /// The constant added to Θ.
    pub offset: f64,
    /// Value at the end, without the offset.
    pub value: f64,
    /// The minimum, without the offset.
    pub minimum: f64,
    /// (value − minimum) / size.
    pub excess: f64,
    /// The bound of value − minimum that the engine printed.
    pub gap: Option<f64>,
    /// Whether the end is confirmed.
    pub said: bool,
    /// Whether the minimum is reached.
    pub reached: bool,
    /// What is false about a confirmed end.
    pub false_termination: Option<&'static str>,
    /// Evaluations of the run.
    pub evaluations: usize,
    /// The text of the termination.
    pub termination: String,
}

impl UnitRecord {
    /// Whether the termination is false, or the minimum is not reached, or the run does not state that it is reached.
    pub fn is_bad(&self) -> bool {
        self.false_termination.is_some() || !self.reached || !self.said
    }
}

/// Runs the engine on Θ in the units of the user.
fn minimise(function: &Function, set: Polyhedron, start: Vector, given: Given) -> Result<Report, OptimizeError> {
    let n = function.dimension();
    let convexity = if given == Given::Convexity { Convexity::Convex } else { Convexity::Unknown };
    let config = BundleTrustConfig { max_evaluations: MAX_EVALUATIONS, convexity, ..Default::default() };
    let mut method = BundleTrust::new(config)?.constraints(set);
    if given == Given::Outputs {
        let outer = function.outer_function();
        return method.minimize(&CompositeFunction::new(n, &*outer, |x: &Vector| function.outputs(x)), start);
    }
    method.minimize(&FnObjective::new(n, |x: &Vector| function.at(x)), start)
}

/// The start of a run in variables of unit 1.
fn start_point(case: &UnitCase, truth: &Truth, index: usize) -> Vector {
    match &case.problem.starts[index] {
        Start::Zero => Vector::zeros(case.units.len()),
        Start::Random(point) | Start::Given(point) => point.clone(),
        Start::Minimiser => truth.minimiser.clone(),
        Start::Beyond => truth.beyond(&case.problem),
    }
}

/// A run of which nothing is known yet.
fn unchecked(case: &UnitCase, truth: &Truth, given: Given, index: usize) -> UnitRecord {
    UnitRecord {
        name: case.name(given, index),
        family: case.problem.family,
        given,
        boxed: case.problem.is_boxed(),
        start: case.problem.starts[index].name(),
        spread: case.spread,
        offset: case.offset,
        value: f64::NAN,
        minimum: truth.minimum,
        excess: f64::NAN,
        gap: None,
        said: false,
        reached: false,
        false_termination: None,
        evaluations: 0,
        termination: String::new(),
    }
}

/// Runs one case from one of its starts. A run that the engine refuses does not reach the minimum.
///
/// # Errors
/// [`InputError`] if the problem cannot be posed.
pub fn checked(case: &UnitCase, truth: &Truth, given: Given, index: usize) -> Result<UnitRecord, InputError> {
    let mut record = unchecked(case, truth, given, index);
    let function = case.problem.function.in_units(&case.units);
    let set = case.problem.set(&case.units)?;
    let start = start_point(case, truth, index).component_mul(&case.units);
    let shifted = function.with_offset(case.offset);
    let begin = Instant::now();
    let late = move || begin.elapsed() > LONGEST_RUN;
    match watched(late, || minimise(&shifted, set.clone(), start, given)) {
        Ok(report) => check(&mut record, truth, &function, &set, &report),
        Err(error) => record.termination = format!("refused: {error}"),
    }
    Ok(record)
}

/// Compares the end of a run with the truth.
fn check(record: &mut UnitRecord, truth: &Truth, function: &Function, set: &Polyhedron, report: &Report) {
    record.value = function.value(&report.solution);
    let above = record.value - truth.minimum;
    let size = (report.start_value - record.offset - truth.minimum).max(truth.rise);
    let terms = record.offset.abs() + function.size_of_terms(&report.solution);
    let rounding = ROUNDING * terms + truth.uncertainty;
    record.gap = match report.termination {
        Termination::Stationary { gap, .. } => gap,
        _ => None,
    };
    let bound = record.gap.filter(|_| record.boxed && record.given == Given::Convexity);
    record.excess = above / size;
    record.said = report.termination.is_confirmed();
    record.reached = above <= REACHED * size + rounding;
    record.false_termination = match () {
        () if !record.said => None,
        () if above.is_nan() || above > GAP * size + rounding => Some("value above the minimum"),
        () if bound.is_some_and(|gap| above > gap + rounding) => Some("gap too small"),
        () if set.violation(&report.solution) > VIOLATION => Some("outside of the set"),
        () => None,
    };
    record.evaluations = report.counts.evaluations;
    record.termination = report.termination.to_string();
}
