//! The runs of an optimization that have ended, and the one that it is reported by.

use crate::optimization::{Attempt, Part};
use contact::contact_objective::ContactObjective;
use contact::load_cases::CaseStates;
use contact::plausibility::Warning;
use contact::standstill::standstill;
use nonsmooth::runs::Ended;
use nonsmooth::{OracleError, Termination, Vector};

/// What a run is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Label {
    /// What it is within its optimization.
    pub part: Part,
    /// The bending of the shape that a fairer one has replaced at the start.
    pub bending_before: Option<f64>,
}

/// A run of an optimization that has ended.
pub type ContactRun = Ended<ContactObjective, Label>;

/// Relative difference of Θ that a fairer shape may cost: shapes are not made more exactly.
const AS_GOOD: f64 = 1e-4;

/// Relative difference of Θ within which two attempts agree: about their tolerance.
pub(super) const AGREES: f64 = 0.03;

/// The runs of an optimization.
#[derive(Debug, Default)]
pub struct Runs {
    /// Those that have ended, one per mesh, start or attempt, in order.
    pub ended: Vec<ContactRun>,
    /// Number of runs asked for.
    pub asked: usize,
}

impl Runs {
    /// The run that the optimization is reported by: the last one, or the best one of several starts, or of attempts
    /// without a later run. A run from a fairer shape counts if its end is as good.
    pub fn chosen(&self) -> Option<&ContactRun> {
        let (last, others) = self.ended.split_last()?;
        match last.stage.label.part {
            Part::Start(_) | Part::Try(_) => best(self.ended.iter()),
            Part::Fair => others.last().filter(|whole| !is_as_good(last, whole)).or(Some(last)),
            Part::Whole | Part::Mesh(_) => Some(last),
        }
    }

    /// The runs that lead to the one that it is reported by, this one included: all meshes in turn, one start alone, or
    /// the best attempt and the runs from there.
    pub fn leading(&self) -> Vec<&ContactRun> {
        let Some(chosen) = self.chosen() else { return vec![] };
        let (runs, part) = (self.ended.iter(), |run: &ContactRun| run.stage.label.part);
        match part(chosen) {
            Part::Mesh(_) => runs.collect(),
            Part::Start(_) | Part::Try(_) => vec![chosen],
            Part::Whole | Part::Fair => {
                let attempt = best(runs.clone().filter(|run| part(run).is_attempt()));
                let later = runs.clone().skip_while(|run| part(run).is_attempt());
                let until = later.take_while(|run| part(run) == Part::Whole || part(chosen) == Part::Fair);
                let is_refined = attempt.is_some_and(|run| part(run) == Part::Try(Attempt::Refined));
                let coarse = runs.clone().filter(|run| is_refined && part(run) == Part::Try(Attempt::Coarse));
                coarse.chain(attempt).chain(until).collect()
            }
        }
    }

    /// Whether it ended at a limit or was stopped, so that more evaluations may improve it.
    pub fn can_continue(&self) -> bool {
        let limits = [Termination::EvaluationLimit, Termination::TimeLimit, Termination::StoppedByObserver];
        let limited = |run: &ContactRun| limits.contains(&run.report.termination);
        self.ended.len() < self.asked || self.ended.last().is_some_and(limited)
    }

    /// Number of evaluations of all runs.
    pub fn evaluations(&self) -> usize {
        self.ended.iter().map(|run| run.report.counts.evaluations).sum()
    }

    /// How many attempts have come to the Θ found, of how many; none without attempts.
    pub fn agreement(&self, found: f64) -> Option<[usize; 2]> {
        let attempts = || self.ended.iter().filter(|run| run.stage.label.part.is_attempt());
        let agreeing = attempts().filter(|run| run.report.value - found <= AGREES * found.abs()).count();
        Some([agreeing, attempts().count()]).filter(|[_, all]| *all > 0)
    }

    /// As [`standstill`], for all runs and the controls at the end of the chosen one, with their states.
    ///
    /// # Errors
    /// [`OracleError`] of the adjoint.
    pub fn standstill(&self, end: (&Vector, &CaseStates)) -> Result<Option<Warning>, OracleError> {
        let Some(ContactRun { stage, .. }) = self.chosen() else { return Ok(None) };
        standstill(self.ended.iter().map(|run| &run.report), &stage.objective, &stage.start, end)
    }
}

/// The violation of the limits at the end of a run, relative to their bounds, so that runs can be compared; 0 where all
/// are kept.
pub(super) fn violation(run: &ContactRun) -> f64 {
    let limits = run.stage.objective.limits().zip(&run.report.constraints);
    let violated = limits.filter(|(_, found)| !found.satisfied);
    violated.map(|(limit, found)| found.value.abs() / limit.scale()).fold(0.0, f64::max)
}

/// The best of some runs: least violation of the limits, then least Θ.
pub(super) fn best<'r>(runs: impl Iterator<Item = &'r ContactRun>) -> Option<&'r ContactRun> {
    runs.min_by(|a, b| violation(a).total_cmp(&violation(b)).then(a.report.value.total_cmp(&b.report.value)))
}

fn is_as_good(fair: &ContactRun, other: &ContactRun) -> bool {
    let (gain, same) = (other.report.value - fair.report.value, AS_GOOD * other.report.value.abs());
    violation(fair) <= violation(other) && (gain > same || gain >= -same && fair.report.is_confirmed())
}
