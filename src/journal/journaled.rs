//! An objective that is answered from its journal as long as that lasts, and keeps what it computes after that.

use super::entry::{Entry, RecordedAnswer, RecordedConstraints, RecordedLinearization, RecordedRequest};
use super::error::JournalError;
use super::writer::Writer;
use crate::composite::{Linearization, Linearized, OuterFunction};
use crate::panics::evaluate_without_panic;
use crate::{Answer, ConstraintKind, Evaluation, NonsmoothObjective, OracleError, Report, Request, Vector};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::Path;
use std::time::Instant;

/// Restart data of an evaluation of a [`Journaled`] objective.
#[derive(Debug, Clone)]
pub struct RestartData<W> {
    evaluation: usize,
    /// None for an evaluation that the journal answered: they are read when they are needed.
    data: Option<W>,
}

/// An objective with a journal; see the [module](super). Not `Sync`: one run at a time.
#[derive(Debug)]
pub struct Journaled<O> {
    inner: O,
    state: RefCell<JournalState>,
}

#[derive(Debug)]
struct JournalState {
    journal: Writer,
    /// Number of evaluations in the journal when it was opened.
    held: usize,
    /// Entries of the journal that have not answered a request yet.
    replay: VecDeque<Entry>,
    /// `seconds` of the entries that have answered a request.
    replayed: Vec<f64>,
    /// Number of the last evaluation.
    evaluation: usize,
    /// Seconds of the earlier invocations.
    before: f64,
    clock: Instant,
    warnings: Vec<String>,
    /// Whether the last line could not be written.
    is_failing: bool,
}

impl<O: NonsmoothObjective> Journaled<O> {
    /// Continues the journal of a folder, or begins one. The `identity` tells this objective from others: a name with
    /// everything that its values depend on, for example the text of an input file.
    ///
    /// # Errors
    /// [`JournalError::Identity`] and [`JournalError::Dimension`] for the journal of another objective,
    /// [`JournalError::Version`] and [`JournalError::Line`] for a file that is no journal of this version, and
    /// [`JournalError::File`] if the folder cannot be read or written.
    pub fn open(inner: O, folder: impl AsRef<Path>, identity: &str) -> Result<Self, JournalError> {
        let (journal, entries) = Writer::open(folder.as_ref(), identity, inner.dimension())?;
        let state = JournalState {
            journal,
            held: entries.len(),
            before: entries.last().map_or(0.0, |entry| entry.seconds),
            replay: VecDeque::from(entries),
            replayed: vec![],
            evaluation: 0,
            clock: Instant::now(),
            warnings: vec![],
            is_failing: false,
        };
        Ok(Self { inner, state: RefCell::new(state) })
    }
}

impl<O> Journaled<O> {
    /// Number of evaluations that the journal held when it was opened.
    pub fn held(&self) -> usize {
        self.state.borrow().held
    }

    /// Whether every evaluation so far is on disk.
    pub fn is_complete(&self) -> bool {
        !self.state.borrow().is_failing
    }

    /// Messages about what could not be kept or continued so far.
    pub fn warnings(&self) -> Vec<String> {
        self.state.borrow().warnings.clone()
    }

    /// Adds to the report of a run what only the journal knows: its warnings, and the time of earlier invocations, in
    /// the history too.
    pub fn complete(&self, report: &mut Report) {
        let state = self.state.borrow();
        report.warnings.extend(state.warnings.iter().cloned());
        for (index, record) in report.history.iter_mut().enumerate() {
            record.seconds = state.replayed.get(index).copied().unwrap_or(state.before + record.seconds);
        }
        report.seconds += state.before;
    }

    fn warn(&self, message: String) {
        self.state.borrow_mut().warnings.push(message);
    }

    /// The entry of the journal for the current evaluation, if there is one and the request is the recorded one.
    fn recorded<W>(&self, request: &Request<'_, RestartData<W>>) -> Option<Entry> {
        let mut state = self.state.borrow_mut();
        let entry = state.replay.pop_front()?;
        if entry.answers(request, request.warm_start.map(|start| start.evaluation)) {
            state.replayed.push(entry.seconds);
            return Some(entry);
        }
        state.replay.clear();
        let cut = state.journal.cut(entry.evaluation - 1);
        state.warnings.push(format!(
            "evaluation {} of the journal was asked for otherwise (another start, other settings, or another version of the \
             program); from there on all is computed again",
            entry.evaluation
        ));
        if let Err(error) = cut {
            state.warnings.push(format!("the journal cannot be shortened: {error}"));
        }
        None
    }

    /// Writes an evaluation down.
    fn keep<W>(
        &self,
        evaluation: usize,
        request: &Request<'_, RestartData<W>>,
        answer: RecordedAnswer,
        restart_data: Option<String>,
        linearization: Option<&Linearization>,
    ) {
        let mut state = self.state.borrow_mut();
        let entry = Entry {
            evaluation,
            point: request.point.as_slice().to_vec(),
            accuracy: request.accuracy.tolerance(),
            target: request.descent_target,
            linearization: request.linearization.map(RecordedRequest::from),
            restarted_from: request.warm_start.map(|start| start.evaluation),
            seconds: state.before + state.clock.elapsed().as_secs_f64(),
            answer,
        };
        let written = state.journal.append(&entry, restart_data, linearization);
        if let (Err(error), false) = (&written, state.is_failing) {
            state.warnings.push(format!(
                "from evaluation {evaluation} on, evaluations are not in the journal: {error}; tried again with every evaluation"
            ));
        }
        state.is_failing = written.is_err();
    }
}

impl<O: NonsmoothObjective<WarmStart: Serialize + DeserializeOwned>> Journaled<O> {
    /// Restart data as the oracle returned them; `None`, with a warning, if they are lost.
    fn read(&self, evaluation: usize) -> Option<O::WarmStart> {
        let text = self.state.borrow().journal.restart_data(evaluation);
        let data = text.map_err(|error| error.to_string());
        let data = data.and_then(|text| serde_json::from_slice(&text).map_err(|error| error.to_string()));
        data.map_err(|error| {
            self.warn(format!(
                "the restart data of evaluation {evaluation} are lost ({error}); the oracle starts without them, and the run may \
                 end elsewhere within its accuracy"
            ));
        })
        .ok()
    }

    /// The restart data of an answer as text. `null` (the unit type has no other form) is not worth a file.
    fn text(&self, evaluation: usize, data: &O::WarmStart) -> (bool, Option<String>) {
        match serde_json::to_string(data) {
            Ok(text) if text == "null" => (false, None),
            Ok(text) => (true, Some(text)),
            Err(error) => {
                self.warn(format!("the restart data of evaluation {evaluation} have no form in JSON: {error}"));
                (true, None)
            }
        }
    }

    /// An answer of the oracle as it is written down, with the text of its restart data.
    fn record(&self, evaluation: usize, answer: &Answer<O::WarmStart>) -> (RecordedAnswer, Option<String>) {
        let Evaluation { value, subgradient, error_bound, warm_start, linearization, constraints, work } =
            answer.evaluation();
        let (restart_data, text) = self.text(evaluation, warm_start);
        let recorded = RecordedAnswer::Evaluated {
            value: *value,
            subgradient: subgradient.as_slice().to_vec(),
            error_bound: *error_bound,
            no_descent: matches!(answer, Answer::NoDescent(_)),
            restart_data,
            linearization: match linearization {
                Linearized::NotAsked => None,
                Linearized::Known(_) => Some(RecordedLinearization::Stored),
                Linearized::Unavailable(reason) => Some(RecordedLinearization::Failed(reason.clone())),
            },
            constraints: constraints.as_ref().map(RecordedConstraints::from),
            work: *work,
        };
        (recorded, text)
    }

    /// The answer of an entry, which was given to this request.
    fn answer(
        &self,
        entry: Entry,
        request: &Request<'_, RestartData<O::WarmStart>>,
    ) -> Result<Answer<RestartData<O::WarmStart>>, OracleError> {
        match entry.answer {
            RecordedAnswer::Failed(reason) => Err(OracleError::Failed(reason.into())),
            RecordedAnswer::Evaluated {
                value,
                subgradient,
                error_bound,
                no_descent,
                restart_data,
                linearization,
                constraints,
                work,
            } => {
                let data = if restart_data { None } else { serde_json::from_str("null").ok() };
                let warm_start = RestartData { evaluation: entry.evaluation, data };
                let subgradient = Vector::from_vec(subgradient);
                let linearization = match linearization {
                    None => Linearized::NotAsked,
                    Some(RecordedLinearization::Stored) => self.linearization(entry.evaluation, request),
                    Some(RecordedLinearization::Failed(reason)) => Linearized::Unavailable(reason),
                };
                let constraints = constraints.map(|recorded| recorded.read(subgradient.len()));
                let exact = Evaluation::exact(value, subgradient, warm_start);
                let evaluation = Evaluation { error_bound, linearization, constraints, work, ..exact };
                Ok(if no_descent { Answer::NoDescent(evaluation) } else { Answer::Accurate(evaluation) })
            }
        }
    }

    /// Outputs and Jacobian of an evaluation from their file; computed again, to the same bits, where that is lost.
    fn linearization(&self, evaluation: usize, request: &Request<'_, RestartData<O::WarmStart>>) -> Linearized {
        let stored = self.state.borrow().journal.linearization(evaluation);
        let error = match stored {
            Ok(linearization) => return Linearized::Known(linearization),
            Err(error) => error,
        };
        self.warn(format!("the Jacobian of evaluation {evaluation} is lost ({error}) and is computed again"));
        let linearization = match self.ask(request) {
            Ok(answer) => answer.into_evaluation().linearization,
            Err(error) => Linearized::Unavailable(error.to_string()),
        };
        match &linearization {
            Linearized::NotAsked => {
                return Linearized::Unavailable("the oracle returns no Jacobian any more".to_owned());
            }
            Linearized::Unavailable(_) => {}
            Linearized::Known(known) => {
                if let Err(error) = self.state.borrow().journal.restore(evaluation, known) {
                    self.warn(format!("the Jacobian of evaluation {evaluation} cannot be written: {error}"));
                }
            }
        }
        linearization
    }

    /// Evaluates the objective and writes the answer to the journal.
    fn ask(&self, request: &Request<'_, RestartData<O::WarmStart>>) -> Result<Answer<O::WarmStart>, OracleError> {
        let stored = match request.warm_start {
            Some(RestartData { data: None, evaluation }) => self.read(*evaluation),
            _ => None,
        };
        let inner = Request {
            point: request.point,
            warm_start: request.warm_start.and_then(|start| start.data.as_ref()).or(stored.as_ref()),
            accuracy: request.accuracy,
            descent_target: request.descent_target,
            linearization: request.linearization,
        };
        // The optimizer treats a panic as a failed evaluation; the journal has to record it as one.
        evaluate_without_panic(&self.inner, &inner)
    }

    /// Asks the oracle, and writes its answer down before it is returned.
    fn compute(
        &self,
        evaluation: usize,
        request: &Request<'_, RestartData<O::WarmStart>>,
    ) -> Result<Answer<RestartData<O::WarmStart>>, OracleError> {
        let result = self.ask(request);
        if let Err(OracleError::Interrupted) = result {
            // Not an answer: a continued run asks again.
            return Err(OracleError::Interrupted);
        }
        let (answer, text) = match &result {
            Ok(answer) => self.record(evaluation, answer),
            Err(error) => (RecordedAnswer::Failed(error.to_string()), None),
        };
        let linearization = result.as_ref().ok().and_then(|answer| answer.evaluation().linearization.known());
        self.keep(evaluation, request, answer, text, linearization);
        let tag = |inner: Evaluation<O::WarmStart>| Evaluation {
            value: inner.value,
            subgradient: inner.subgradient,
            error_bound: inner.error_bound,
            warm_start: RestartData { evaluation, data: Some(inner.warm_start) },
            linearization: inner.linearization,
            constraints: inner.constraints,
            work: inner.work,
        };
        Ok(match result? {
            Answer::Accurate(inner) => Answer::Accurate(tag(inner)),
            Answer::NoDescent(inner) => Answer::NoDescent(tag(inner)),
        })
    }
}

impl<O: NonsmoothObjective<WarmStart: Serialize + DeserializeOwned>> NonsmoothObjective for Journaled<O> {
    type WarmStart = RestartData<O::WarmStart>;

    fn outer(&self) -> Option<&dyn OuterFunction> {
        self.inner.outer()
    }

    fn dimension(&self) -> usize {
        self.inner.dimension()
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        self.inner.constraint_kinds()
    }

    fn evaluate(&self, request: &Request<'_, Self::WarmStart>) -> Result<Answer<Self::WarmStart>, OracleError> {
        let evaluation = {
            let mut state = self.state.borrow_mut();
            state.evaluation += 1;
            state.evaluation
        };
        match self.recorded(request) {
            Some(entry) => self.answer(entry, request),
            None => self.compute(evaluation, request),
        }
    }
}
