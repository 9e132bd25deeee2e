//! Terminations of the optimizer on the collection in all its variants, compared with known minima and stationary
//! points.
//!
//! A termination is false if it is *confirmed* above the gap, unless the function is not convex and true gradients
//! prove Clarke stationarity, or it is convex and the bound stated for a finite box holds; if it is *confirmed* where
//! the oracle is noisy and says so; or if it is a *noise limit* of a convex function above ten times the noise. A
//! failure is false if a run ends by a failure of the oracle or of the subproblem above the gap although the oracle
//! answers at the best point.

use crate::markdown::table;
use crate::stability::optimizer_stationarity::is_clarke_stationary;
use crate::stability::optimizer_variants::{Changed, Variant, variants};
use nonsmooth::{
    BundleTrust, BundleTrustConfig, Convexity, InputError, NonsmoothObjective, Report, Request, Termination,
};
use rayon::prelude::*;
use serde::Serialize;
use testset::Problem;

/// Evaluations of a run.
const MAX_EVALUATIONS: usize = 1000;
/// Largest gap relative to 1 + |f*| of a confirmed end.
const GAP: f64 = 1e-5;
/// Gap to which evaluations are counted.
const COUNTED_GAP: f64 = 1e-6;
/// Times the noise that the gap of a convex function may be at a noise limit.
const NOISE_GAP: f64 = 10.0;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TerminationKind {
    /// Stationary, with sufficient evidence.
    Confirmed,
    /// Stationary by the model, without sufficient evidence.
    Unconfirmed,
    /// Noise hides the remaining decrease.
    Noise,
    /// A step too short to change the variables.
    Short,
    /// A failure of the oracle or of the subproblem.
    Failed,
    /// A limit, or unbounded below.
    Limit,
    /// The start has no finite value.
    NoStart,
}

/// One run and what it claims.
#[derive(Debug, Clone, Serialize)]
pub struct TerminationRecord {
    pub problem: String,
    pub variant: Variant,
    /// Whether it is convex, and declared so.
    pub convex: bool,
    pub kind: TerminationKind,
    /// (value − a f* − s)/a, relative to 1 + |f*|.
    pub gap: f64,
    /// Evaluations of the run.
    pub evaluations: usize,
    /// Evaluations to a gap of 1e-6.
    pub evaluations_to_gap: Option<usize>,
    /// Whether the termination claims something false.
    pub false_confirmed: bool,
    /// Whether it failed where the oracle answers.
    pub false_failure: bool,
    /// The text of the termination.
    pub termination: String,
}

/// What all runs came to.
#[derive(Debug, Clone, Serialize)]
pub struct TerminationReport {
    /// Runs whose start has a value.
    pub runs: usize,
    /// Terminations that claim something false.
    pub false_confirmed: usize,
    /// Failures where the oracle answers.
    pub false_failures: usize,
    /// Confirmed ends of the convex problems as they are, and their number.
    pub convex_confirmed: (usize, usize),
    /// Confirmed ends of all problems as they are, and their number.
    pub all_confirmed: (usize, usize),
    /// Evaluations of the convex problems as they are, over those to a gap of 1e-6.
    pub convex_cost: f64,
    /// Runs with a false termination.
    pub offenders: Vec<TerminationRecord>,
    /// All runs, in the order of the problems.
    #[serde(skip)]
    pub records: Vec<TerminationRecord>,
}

fn run_one(problem: &Problem, variant: Variant) -> Result<TerminationRecord, InputError> {
    let changed = Changed::new(problem, variant);
    let convex = problem.convex;
    let convexity = if convex { Convexity::Convex } else { Convexity::Unknown };
    let config = BundleTrustConfig { max_evaluations: MAX_EVALUATIONS, convexity, ..BundleTrustConfig::default() };
    let mut record = TerminationRecord {
        problem: problem.name.clone(),
        variant,
        convex: problem.convex,
        kind: TerminationKind::NoStart,
        gap: f64::INFINITY,
        evaluations: 0,
        evaluations_to_gap: None,
        false_confirmed: false,
        false_failure: false,
        termination: String::new(),
    };
    let mut method = BundleTrust::new(config)?.constraints(changed.set()?);
    match method.minimize(&changed, changed.start()) {
        Ok(report) => check(&mut record, &changed, &report)?,
        Err(error) => record.termination = error.to_string(),
    }
    Ok(record)
}

fn check(record: &mut TerminationRecord, changed: &Changed<'_>, report: &Report) -> Result<(), InputError> {
    let (problem, variant) = (changed.problem, changed.variant);
    let size = 1.0 + problem.optimal_value.abs();
    let rounding = 4.0 * f64::EPSILON * variant.shift.abs() / variant.factor / size;
    let relative =
        |value: f64| (value / variant.factor - problem.optimal_value - variant.shift / variant.factor) / size;
    // Noise is no gain: the gap is that of the function itself.
    let noisy = variant.noise > 0.0;
    let own = (changed.exact(&report.solution).0 - problem.optimal_value) / size;
    record.gap = if noisy { own } else { relative(report.value) };
    record.evaluations = report.counts.evaluations;
    let reached = |value: f64| relative(value) <= COUNTED_GAP;
    record.evaluations_to_gap =
        report.history.iter().find(|step| reached(step.center_value)).map(|step| step.evaluation);
    record.termination = report.termination.to_string();
    record.kind = match report.termination {
        Termination::Stationary { .. } => TerminationKind::Confirmed,
        Termination::StationaryUnconfirmed { .. } => TerminationKind::Unconfirmed,
        Termination::NoiseLimit { .. } => TerminationKind::Noise,
        Termination::StepTooShort { .. } => TerminationKind::Short,
        Termination::OracleFailing { .. }
        | Termination::OracleContradiction { .. }
        | Termination::SubproblemFailed { .. } => TerminationKind::Failed,
        _ => TerminationKind::Limit,
    };
    let above = record.gap > GAP + rounding;
    // In a finite box the bound is a proof; it is relative to the values as they are, shift included.
    let excess = variant.factor * size * record.gap;
    let proved = match report.termination {
        Termination::Stationary { gap: Some(gap), .. } => {
            excess <= gap && gap <= GAP * report.value.abs() && variant.wide
        }
        _ => false,
    };
    record.false_confirmed = match record.kind {
        TerminationKind::Confirmed if !noisy => {
            above && !proved && (record.convex || !is_clarke_stationary(changed, &report.solution)?)
        }
        TerminationKind::Confirmed => noisy,
        TerminationKind::Noise => noisy && record.convex && record.gap > NOISE_GAP * variant.noise,
        _ => false,
    };
    let answers = || (0..2).any(|_| changed.evaluate(&Request::tight(&report.solution)).is_ok());
    record.false_failure = record.kind == TerminationKind::Failed && above && answers();
    Ok(())
}

/// Runs the variants that `take` selects by their number, on all processors; records are in the order of problems.
///
/// # Errors
/// [`InputError`] if a problem of the collection cannot be posed.
pub fn terminations(take: impl Fn(usize) -> bool) -> Result<TerminationReport, InputError> {
    let problems = testset::all();
    let jobs: Vec<(&Problem, Variant)> =
        problems.iter().flat_map(|problem| variants().into_iter().map(move |variant| (problem, variant))).collect();
    let jobs: Vec<_> = jobs.into_iter().enumerate().filter(|(number, _)| take(*number)).map(|(_, job)| job).collect();
    let records = jobs.into_par_iter().map(|(problem, variant)| run_one(problem, variant));
    Ok(summarize(records.collect::<Result<_, _>>()?))
}

fn summarize(records: Vec<TerminationRecord>) -> TerminationReport {
    let started = || records.iter().filter(|record| record.kind != TerminationKind::NoStart);
    let plain = || records.iter().filter(|record| record.variant == Variant::PLAIN);
    let confirmed = |convex: bool| {
        let of = || plain().filter(move |record| record.convex || !convex);
        (of().filter(|record| record.kind == TerminationKind::Confirmed).count(), of().count())
    };
    let solved: Vec<(usize, usize)> = plain()
        .filter(|record| record.convex)
        .filter_map(|record| Some((record.evaluations, record.evaluations_to_gap?)))
        .collect();
    let total = |of: fn(&(usize, usize)) -> usize| solved.iter().map(of).sum::<usize>() as f64;
    TerminationReport {
        runs: started().count(),
        false_confirmed: started().filter(|record| record.false_confirmed).count(),
        false_failures: started().filter(|record| record.false_failure).count(),
        convex_confirmed: confirmed(true),
        all_confirmed: confirmed(false),
        convex_cost: total(|pair| pair.0) / total(|pair| pair.1),
        offenders: started().filter(|record| record.false_confirmed || record.false_failure).cloned().collect(),
        records,
    }
}

/// Totals, and how the runs of each kind of change ended.
pub fn markdown(report: &TerminationReport) -> String {
    let text = format!(
        "{} runs, {} false confirmed, {} false failures. As they are: {} of {} convex problems confirmed, {} of {} of all; \
         evaluations of the convex ones {:.3} × those to 1e-6.\n\n",
        report.runs,
        report.false_confirmed,
        report.false_failures,
        report.convex_confirmed.0,
        report.convex_confirmed.1,
        report.all_confirmed.0,
        report.all_confirmed.1,
        report.convex_cost
    );
    let mut groups: Vec<&str> = vec![];
    for record in &report.records {
        if !groups.contains(&record.variant.group()) {
            groups.push(record.variant.group());
        }
    }
    let kinds = [
        TerminationKind::Confirmed,
        TerminationKind::Unconfirmed,
        TerminationKind::Noise,
        TerminationKind::Short,
        TerminationKind::Failed,
        TerminationKind::Limit,
    ];
    let rows = groups.into_iter().map(|group| {
        let of = || report.records.iter().filter(|r| r.variant.group() == group && r.kind != TerminationKind::NoStart);
        let counts = kinds.map(|kind| of().filter(|record| record.kind == kind).count());
        let wrong = of().filter(|record| record.false_confirmed || record.false_failure).count();
        let numbers = [&[of().count()], &counts[..], &[wrong]].concat();
        std::iter::once(group.to_owned()).chain(numbers.iter().map(usize::to_string)).collect()
    });
    let head = "change | runs | confirmed | unconfirmed | noise limit | step too short | failed | other limits | false";
    text + &table(head, rows)
}
