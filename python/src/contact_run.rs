//! The optimization of a scene: the runs of its driver, with journals, callback and signals.

use crate::contact_state::in_words;
use crate::failure::Failure;
use crate::outcome::RunOutcome;
use crate::run::{Interrupter, RunError, check_start, performed, signal};
use crate::setup::Setup;
use contact::plausibility::Warning;
use contact::solvers::{Processes, Wanted};
use nonsmooth::interruption::watched;
use nonsmooth::{Accuracy, BundleTrustConfig, OracleError, StateSolver, Termination, Vector};
use pyo3::prelude::*;
use scene_file::Case;
use scene_file::optimization::{ContactRun, ContactStage, Driver, OptimizationError, Runs};
use std::path::Path;
use std::time::Instant;

impl From<OptimizationError> for RunError {
    fn from(error: OptimizationError) -> Self {
        match error {
            OptimizationError::Run(error) => Self::Optimize(error),
            error => Self::Scene(error),
        }
    }
}

/// The runs that have ended, with the subgradients at their solutions.
#[derive(Default)]
struct Found {
    runs: Runs,
    subgradients: Vec<Option<Vector>>,
}

/// Optimizes a scene as the program does. Returns the run that is reported, none if there is no point, and the
/// exception that ended the optimization.
pub fn optimize<'py>(
    py: Python<'py>,
    case: &Case,
    setup: &Setup,
) -> PyResult<(Option<RunOutcome>, Option<Bound<'py, PyAny>>)> {
    let (failure, clock) = (Failure::default(), Instant::now());
    let config = BundleTrustConfig { composite_model: case.wanted() == Wanted::Jacobians, ..setup.config(py)? };
    let mut interrupter = Interrupter::new(py, setup, &failure);
    let (outcome, result) = py.detach(|| {
        let mut found = Found::default();
        let result = drive(case, (setup, &config, clock), &mut interrupter, (&failure, &mut found));
        let watch = failure.clone();
        (watched(move || signal(&watch), || found.outcome(&failure)), result)
    });
    let exception = failure.take().map(|error| error.into_value(py).into_bound(py).into_any());
    match (result, exception) {
        (Err(error), None) => Err(error.into()),
        (_, exception) => Ok((outcome, exception)),
    }
}

/// Performs the runs. Each has a folder of its own below that of the journal, as in a folder of the program.
fn drive(
    case: &Case,
    (setup, config, clock): (&Setup, &BundleTrustConfig, Instant),
    interrupter: &mut Interrupter,
    (failure, found): (&Failure, &mut Found),
) -> Result<(), RunError> {
    let (processes, start) = (Processes::alone(), setup.start());
    let driver = Driver::new(case, &processes).map_err(OptimizationError::from)?;
    let problem = driver.objective().solver().problem();
    problem.admissible.check(&start).map_err(OptimizationError::from)?;
    let Found { runs, subgradients } = found;
    let perform = |stage: ContactStage| {
        let within = |folder: &String| Path::new(folder).join(stage.label.part.folder().unwrap_or_default());
        let journal = setup.journal.as_ref().map(|(folder, identity)| (within(folder), identity.as_str()));
        let journal = journal.as_ref().map(|(folder, identity)| (folder.as_path(), *identity));
        if let Some((folder, _)) = journal.filter(|_| subgradients.is_empty()) {
            check_start(folder, &stage)?;
        }
        let RunOutcome { report, subgradient, .. } = performed(&stage, &*stage.objective, journal, interrupter)?;
        subgradients.push(subgradient);
        let is_last = failure.is_set() || report.termination == Termination::StoppedByObserver;
        Ok(ContactRun { stage, report, replayed: 0, is_kept: true, is_last })
    };
    let watch = failure.clone();
    watched(move || signal(&watch), || driver.run((&start, config, clock), runs, perform))
}

impl Found {
    /// The run that is reported, with the warnings about its shape and what there is to say of every run.
    fn outcome(self, failure: &Failure) -> Option<RunOutcome> {
        let chosen = self.runs.chosen()?;
        // Whoever has interrupted the runs does not wait for checks.
        let checked = if failure.is_set() { Ok(vec![]) } else { warnings(&self.runs, chosen) };
        let warnings = match checked {
            Ok(warnings) => in_words(&warnings),
            Err(error) => vec![format!("not-checked: the checks of the final shape failed: {error}")],
        };
        let place = self.runs.ended.iter().position(|run| std::ptr::eq(run, chosen))?;
        let mut report = chosen.report.clone();
        report.warnings.extend(warnings);
        let runs = self.runs.ended.iter().map(told).collect();
        Some(RunOutcome { report, set: chosen.stage.set.clone(), subgradient: self.subgradients[place].clone(), runs })
    }
}

/// What the result says of a run.
fn told(run: &ContactRun) -> serde_json::Value {
    serde_json::json!({
        "run": run.stage.label.part.folder(),
        "start_value": run.report.start_value,
        "fun": run.report.value,
        "nfev": run.report.counts.evaluations,
        "seconds": run.report.seconds,
        "message": run.report.termination.to_string(),
    })
}

/// What is implausible about the shape found, and why the runs stood still if they did.
fn warnings(runs: &Runs, ContactRun { stage, report, .. }: &ContactRun) -> Result<Vec<Warning>, OracleError> {
    let (cases, end) = (stage.objective.cases(), &report.solution);
    let states = cases.solve(end, None, Accuracy::TIGHTEST)?;
    let mut warnings = Vec::new();
    for (case, state) in states.iter().enumerate() {
        warnings.extend(cases.case(case).warnings(state)?);
    }
    warnings.extend(runs.standstill((end, &states))?);
    Ok(warnings)
}
