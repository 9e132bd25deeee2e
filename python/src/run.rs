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
use nonsmooth::{
    BundleTrust, BundleTrustConfig, Journal, Journaled, NonsmoothObjective, Observer, OptimizeError, Polyhedron,
    Report, Run, TablePrinter, Termination, Vector,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::Write;
use std::time::{Duration, Instant};

/// Signals are looked for after steps that end later than this after the last look.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(100);

/// What a run needs besides its objective; nothing of it is bound to the interpreter.
pub struct RunInput {
    pub config: BundleTrustConfig,
    pub set: Polyhedron,
    pub start: Vector,
    /// Called after every evaluation; true ends the run.
    pub callback: Option<Py<PyAny>>,
    /// Whether a table is printed.
    pub disp: bool,
    /// Exceptions of the user's code.
    pub failure: Failure,
}

/// Minimises a function. Returns the outcome, none if there is no point, and the exception that ended the run.
#[pyfunction]
pub fn minimize<'py>(py: Python<'py>, setup: Setup) -> PyResult<(Option<RunOutcome>, Option<Bound<'py, PyAny>>)> {
    let failure = Failure::default();
    let input = RunInput {
        config: setup.config(py)?,
        set: setup.constraints.polyhedron(py)?,
        start: setup.start(),
        callback: setup.callback.as_ref().map(|callback| callback.clone_ref(py)),
        disp: setup.disp,
        failure: failure.clone(),
    };
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
    let (result, outside) = py.detach(|| run(input, oracle, setup.journal.as_ref()));
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
}

impl From<RunError> for PyErr {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Optimize(error) => errors::optimize(error),
            RunError::Journal(error) => errors::journal(error),
            RunError::OtherStart(folder) => PyValueError::new_err(format!(
                "{folder}: the journal began at another x0, so that none of its evaluations would be of use: pass that x0, or another \
                 folder as journal"
            )),
        }
    }
}

/// Runs with or without a journal; the second part is the first `OutsideDomain` of the function.
fn run(
    input: RunInput,
    oracle: PythonOracle,
    journal: Option<&(String, String)>,
) -> (Result<RunOutcome, RunError>, Option<PyErr>) {
    let result = match journal {
        Some((folder, identity)) => journaled(input, &oracle, folder, identity),
        None => {
            let watched = Watched::new(&oracle);
            drive(input, &watched).map(|(report, set)| watched.outcome(report, set)).map_err(RunError::Optimize)
        }
    };
    (result, oracle.outside.take())
}

pub fn journaled<O>(input: RunInput, objective: &O, folder: &str, identity: &str) -> Result<RunOutcome, RunError>
where
    O: NonsmoothObjective<WarmStart: Serialize + DeserializeOwned>,
{
    check_start(folder, &input)?;
    let watched = Watched::new(Journaled::open(objective, folder, identity).map_err(RunError::Journal)?);
    let (mut report, set) = drive(input, &watched).map_err(RunError::Optimize)?;
    watched.inner.complete(&mut report);
    Ok(watched.outcome(report, set))
}

/// Refuses to continue from another start: the run would drop the evaluations of the journal.
fn check_start(folder: &str, input: &RunInput) -> Result<(), RunError> {
    let journal = Journal::read(folder).map_err(RunError::Journal)?;
    let first = journal.as_ref().and_then(|journal| journal.entries.first());
    // Coordinates of the run round.
    let same =
        |point: &[f64]| point.iter().zip(input.start.iter()).all(|(a, b)| (a - b).abs() <= 1e-9 * input.start.amax());
    match first {
        // A journal of other size is refused as such; an inadmissible start is moved and need not be the first point.
        Some(entry) if entry.point.len() == input.start.len() && input.set.dimension() == input.start.len() => {
            let is_other = input.set.violation(&input.start) == 0.0 && !same(&entry.point);
            if is_other { Err(RunError::OtherStart(folder.to_owned())) } else { Ok(()) }
        }
        _ => Ok(()),
    }
}

/// Drives the run to its end, to an exception, to a signal, or until the callback ends it.
pub fn drive<O: NonsmoothObjective>(input: RunInput, objective: &O) -> Result<(Report, Polyhedron), OptimizeError> {
    let failure = input.failure.clone();
    watched(move || signal(&failure), || drive_watched(input, objective))
}

/// Whether an exception is to end what the engine does: one that is kept already, or that of a signal.
pub fn signal(failure: &Failure) -> bool {
    if let Err(error) = Python::attach(|py| py.check_signals()) {
        failure.set(error);
    }
    failure.is_set()
}

fn drive_watched<O: NonsmoothObjective>(input: RunInput, objective: &O) -> Result<(Report, Polyhedron), OptimizeError> {
    let mut method = BundleTrust::new(input.config)?.constraints(input.set.clone());
    if input.disp {
        let mut table = TablePrinter::new(PythonStdout);
        method = method.observer(move |record: &nonsmooth::IterationRecord| table.observe(record));
    }
    let mut run = method.start(objective, input.start)?;
    let mut interrupter =
        Interrupter { callback: input.callback, failure: input.failure, told: 0, looked: Instant::now() };
    let mut stopped = interrupter.wants_end(&run);
    while !stopped && run.step().is_continue() {
        stopped = interrupter.wants_end(&run);
    }
    // The evaluation that ended the run has not been told yet.
    stopped = stopped || interrupter.wants_end(&run);
    let mut report = run.finish();
    if stopped && report.termination == Termination::Unfinished {
        report.termination = Termination::StoppedByObserver;
    }
    Ok((report, input.set))
}

/// What may end a run from outside: callback, exceptions, signals.
struct Interrupter {
    callback: Option<Py<PyAny>>,
    failure: Failure,
    /// Evaluations that the callback knows.
    told: usize,
    looked: Instant,
}

impl Interrupter {
    fn wants_end(&mut self, run: &Run<'_, '_>) -> bool {
        if self.failure.is_set() {
            return true;
        }
        let new = run.history().len() > self.told && self.callback.is_some();
        if !new && self.looked.elapsed() < SIGNAL_INTERVAL {
            return false;
        }
        self.looked = Instant::now();
        Python::attach(|py| match py.check_signals().and_then(|()| self.tell(py, run)) {
            Ok(stop) => stop,
            Err(error) => {
                self.failure.set(error);
                true
            }
        })
    }

    /// Tells the callback what is new.
    fn tell(&mut self, py: Python<'_>, run: &Run<'_, '_>) -> PyResult<bool> {
        let Some(callback) = &self.callback else { return Ok(false) };
        while let Some(record) = run.history().get(self.told) {
            self.told += 1;
            // Records are plain data; one that has no form in JSON is told as none.
            let record = serde_json::to_string(record).unwrap_or_else(|_| "null".to_owned());
            let answer = callback.bind(py).call1((convert::array(py, run.center()), run.value(), record))?;
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
