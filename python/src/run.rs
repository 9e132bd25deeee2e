//! A run: the engine works without the interpreter, which it takes only for the user's function, the callback and
//! signals.

use crate::convert;
use crate::errors;
use crate::failure::Failure;
use crate::oracle::PythonOracle;
use crate::outcome::RunOutcome;
use crate::outer::Outer;
use crate::setup::Setup;
use crate::watched::Watched;
use nonsmooth::interruption::watched;
use nonsmooth::runs::Stage;
use nonsmooth::{
    IterationRecord, Journal, Journaled, NonsmoothObjective, Observer, OptimizeError, TablePrinter, Vector,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
#[cfg(feature = "contact")]
use scene_file::optimization::OptimizationError;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Signals are looked for after steps that end later than this after the last look.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(100);

/// Minimises a function. Returns the outcome, none if there is no point, and the exception that ended the run.
#[pyfunction]
pub fn minimize<'py>(py: Python<'py>, setup: Setup) -> PyResult<(Option<RunOutcome>, Option<Bound<'py, PyAny>>)> {
    let failure = Failure::default();
    let stage = Stage {
        label: (),
        objective: Arc::new(()),
        set: setup.constraints.polyhedron(py)?,
        start: setup.start(),
        directions: None,
        config: setup.config(py)?,
    };
    let mut interrupter = Interrupter::new(py, &setup, &failure);
    let outer = setup.outer.as_ref().map(|outer| Outer::new(py, outer, &failure));
    let oracle = PythonOracle {
        function: setup.fun.clone_ref(py),
        jac_apart: setup.jac_apart,
        smooth: setup.smooth.as_ref().map(|smooth| smooth.clone_ref(py)),
        dimension: setup.x0.len(),
        takes_accuracy: setup.takes_accuracy,
        outer: outer.transpose()?,
        nonlinear: setup.nonlinear.as_ref().map(|given| given.constraints(py)).transpose()?.unwrap_or_default(),
        failure: failure.clone(),
        outside: Failure::default(),
    };
    let (result, outside) = py.detach(|| {
        let journal = setup.journal.as_ref().map(|(folder, identity)| (Path::new(folder), identity.as_str()));
        let checked = journal.map_or(Ok(()), |(folder, _)| check_start(folder, &stage));
        let watch = failure.clone();
        let run = || performed(&stage, &oracle, journal, &mut interrupter);
        (checked.and_then(|()| watched(move || signal(&watch), run)), oracle.outside.take())
    });
    let exception = |error: PyErr| error.into_value(py).into_bound(py).into_any();
    match (result, failure.take()) {
        (Ok(outcome), None) => Ok((Some(outcome), None)),
        (Ok(outcome), Some(error)) => Ok((Some(outcome), Some(exception(error)))),
        (Err(_), Some(error)) => Ok((None, Some(exception(error)))),
        // The start lies outside the domain: the user's own exception says more.
        (Err(RunError::Optimize(OptimizeError::Oracle(_))), None) if outside.is_some() => {
            Ok((None, outside.map(exception)))
        }
        (Err(error), None) => Err(error.into()),
    }
}

/// Why a run could not begin.
pub enum RunError {
    /// The engine refuses, or the first evaluation failed.
    Optimize(OptimizeError),
    /// The journal could not be opened or does not belong to this run.
    Journal(nonsmooth::JournalError),
    /// The journal of this folder began at another point.
    OtherStart(String),
    /// A scene could not be optimized.
    #[cfg(feature = "contact")]
    Scene(OptimizationError),
}

impl From<RunError> for PyErr {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Optimize(error) => errors::optimize(error),
            RunError::Journal(error) => errors::journal(error),
            #[cfg(feature = "contact")]
            RunError::Scene(error) => errors::failed(problems::commands::Failure::from(error)),
            RunError::OtherStart(folder) => PyValueError::new_err(format!(
                "{folder}: the journal began at another x0, so that none of its evaluations would be of use: pass that x0, or another \
                 folder as journal"
            )),
        }
    }
}

/// Performs a run, with a journal in a folder if there is one. `objective` is that of the stage, or what stands for it.
pub fn performed<O, L, P>(
    stage: &Stage<O, L>,
    objective: &P,
    journal: Option<(&Path, &str)>,
    interrupter: &mut Interrupter,
) -> Result<RunOutcome, RunError>
where
    P: NonsmoothObjective<WarmStart: Serialize + DeserializeOwned>,
{
    let mut watch = |center: &Vector, new: &[IterationRecord]| interrupter.watch(center, new);
    let Some((folder, identity)) = journal else {
        let watched = Watched::new(objective);
        let report = stage.run(&watched, &mut watch).map_err(RunError::Optimize)?;
        return Ok(watched.outcome(report, stage.set.clone()));
    };
    let watched = Watched::new(Journaled::open(objective, folder, identity).map_err(RunError::Journal)?);
    let mut report = stage.run(&watched, &mut watch).map_err(RunError::Optimize)?;
    watched.inner.complete(&mut report);
    Ok(watched.outcome(report, stage.set.clone()))
}

/// Refuses to continue from another start: the run would drop the evaluations of the journal.
pub fn check_start<O, L>(folder: &Path, Stage { set, start, .. }: &Stage<O, L>) -> Result<(), RunError> {
    let journal = Journal::read(folder).map_err(RunError::Journal)?;
    let first = journal.as_ref().and_then(|journal| journal.entries.first());
    // Coordinates of the run round.
    let same = |point: &[f64]| point.iter().zip(start.iter()).all(|(a, b)| (a - b).abs() <= 1e-9 * start.amax());
    match first {
        // A journal of other size is refused as such; an inadmissible start is moved and need not be the first point.
        Some(entry) if entry.point.len() == start.len() && set.dimension() == start.len() => {
            let is_other = set.violation(start) == 0.0 && !same(&entry.point);
            if is_other { Err(RunError::OtherStart(folder.display().to_string())) } else { Ok(()) }
        }
        _ => Ok(()),
    }
}

/// Whether an exception is to end what the engine does: one that is kept already, or that of a signal.
pub fn signal(failure: &Failure) -> bool {
    if let Err(error) = Python::attach(|py| py.check_signals()) {
        failure.set(error);
    }
    failure.is_set()
}

/// What sees a run and may end it from outside: table, callback, exceptions, signals.
pub struct Interrupter {
    table: Option<TablePrinter<PythonStdout>>,
    /// Called after every evaluation; true ends the run.
    callback: Option<Py<PyAny>>,
    /// Exceptions of the user's code.
    failure: Failure,
    looked: Instant,
}

impl Interrupter {
    pub fn new(py: Python<'_>, setup: &Setup, failure: &Failure) -> Self {
        let callback = setup.callback.as_ref().map(|callback| callback.clone_ref(py));
        let table = setup.disp.then(|| TablePrinter::new(PythonStdout));
        Self { table, callback, failure: failure.clone(), looked: Instant::now() }
    }

    /// Shows and tells the records that are new; `Break` ends the run.
    fn watch(&mut self, center: &Vector, new: &[IterationRecord]) -> ControlFlow<()> {
        if let Some(table) = &mut self.table {
            new.iter().try_for_each(|record| table.observe(record))?;
        }
        if self.failure.is_set() {
            return ControlFlow::Break(());
        }
        let is_told = !new.is_empty() && self.callback.is_some();
        if !is_told && self.looked.elapsed() < SIGNAL_INTERVAL {
            return ControlFlow::Continue(());
        }
        self.looked = Instant::now();
        let told = Python::attach(|py| py.check_signals().and_then(|()| self.tell(py, center, new)));
        match told {
            Ok(false) => ControlFlow::Continue(()),
            Ok(true) => ControlFlow::Break(()),
            Err(error) => {
                self.failure.set(error);
                ControlFlow::Break(())
            }
        }
    }

    /// Tells the callback what is new; whether it wants the end.
    fn tell(&self, py: Python<'_>, center: &Vector, new: &[IterationRecord]) -> PyResult<bool> {
        let (Some(callback), Some(last)) = (&self.callback, new.last()) else { return Ok(false) };
        for record in new {
            // Records are plain data; one that has no form in JSON is told as none.
            let record = serde_json::to_string(record).unwrap_or_else(|_| "null".to_owned());
            let answer = callback.bind(py).call1((convert::array(py, center), last.center_value, record))?;
            if answer.is_truthy()? {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// `sys.stdout`, which notebooks and tests replace.
#[derive(Debug)]
struct PythonStdout;

impl Write for PythonStdout {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let text = String::from_utf8_lossy(bytes);
        let written = Python::attach(|py| {
            py.import("sys")?.getattr("stdout")?.call_method1("write", (text.as_ref(),)).map(|_| ())
        });
        written.map(|()| bytes.len()).map_err(|error| std::io::Error::other(error.to_string()))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
