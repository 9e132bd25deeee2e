//! An objective that answers from a journal as long as that lasts, and writes everything after it down.

use crate::commands::long_run::journal::{Entry, Journal, Outcome};
use contact::contact_shape::ContactWarmStart;
use nonsmooth::{Answer, Evaluation, NonsmoothObjective, OracleError, Request, Vector};
use std::any::Any;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// Restart data with the evaluation they come from; none for one answered from the journal.
#[derive(Debug, Clone)]
pub struct Kept {
    evaluation: usize,
    data: Option<ContactWarmStart>,
}

/// A journaled objective.
pub struct Journaled<'j, O> {
    inner: O,
    state: RefCell<State<'j>>,
}

struct State<'j> {
    journal: &'j mut Journal,
    /// Evaluations of an earlier part of the run that are still to be answered.
    replay: VecDeque<Entry>,
    /// Number of the last evaluation.
    evaluation: usize,
    /// Seconds of the earlier parts.
    before: f64,
    clock: Instant,
    warnings: Vec<String>,
    /// Whether the last line could not be written.
    failing: bool,
}

impl<'j, O> Journaled<'j, O> {
    /// An objective whose first answers are those of `replay`.
    pub fn new(inner: O, journal: &'j mut Journal, replay: Vec<Entry>) -> Self {
        let before = replay.last().map_or(0.0, |entry| entry.seconds);
        let (replay, clock) = (VecDeque::from(replay), Instant::now());
        let state = State { journal, replay, evaluation: 0, before, clock, warnings: vec![], failing: false };
        Self { inner, state: RefCell::new(state) }
    }

    /// What could not be kept, in words.
    pub fn into_warnings(self) -> Vec<String> {
        self.state.into_inner().warnings
    }
}

impl<O: NonsmoothObjective<WarmStart = ContactWarmStart>> Journaled<'_, O> {
    /// The answer of the journal, if it has one for this point.
    fn replayed(&self, request: &Request<'_, Kept>) -> Option<Result<Answer<Kept>, OracleError>> {
        let mut state = self.state.borrow_mut();
        let entry = state.replay.pop_front()?;
        let same = entry.point.iter().zip(request.point.iter()).all(|(a, b)| a.to_bits() == b.to_bits());
        if !same || entry.point.len() != request.point.len() || entry.accuracy != request.accuracy.tolerance() {
            state.replay.clear();
            let cut = state.journal.cut(entry.evaluation - 1);
            drop(state);
            // Another first point is another run: an earlier stage went further than when the journal was written.
            if entry.evaluation > 1 {
                self.warn(format!(
                    "evaluation {} of the journal was elsewhere (written by another version of this program?); from there on \
                     all is computed again",
                    entry.evaluation
                ));
            }
            if let Err(error) = cut {
                self.warn(format!("the journal cannot be shortened: {error}"));
            }
            return None;
        }
        let evaluation = state.evaluation;
        Some(match entry.outcome {
            Outcome::Failure(reason) => Err(OracleError::Failed(reason.into())),
            Outcome::Answer { value, subgradient, error_bound, no_descent } => {
                let subgradient = Vector::from_vec(subgradient);
                let warm_start = Kept { evaluation, data: None };
                let answer = Evaluation { value, subgradient, error_bound, warm_start };
                Ok(if no_descent { Answer::NoDescent(answer) } else { Answer::Accurate(answer) })
            }
        })
    }

    fn computed(&self, request: &Request<'_, Kept>) -> Result<Answer<Kept>, OracleError> {
        let (evaluation, center) = (self.state.borrow().evaluation, request.warm_start.map(|kept| kept.evaluation));
        let stored = match request.warm_start {
            Some(Kept { data: None, evaluation }) => {
                let found = self.state.borrow().journal.warm_start(*evaluation);
                if found.is_none() {
                    let words =
                        format!("restart data of evaluation {evaluation} are missing: the end may differ in rounding");
                    self.warn(words);
                }
                found
            }
            _ => None,
        };
        let warm_start = request.warm_start.and_then(|kept| kept.data.as_ref()).or(stored.as_ref());
        let inner = Request {
            point: request.point,
            warm_start,
            accuracy: request.accuracy,
            descent_target: request.descent_target,
        };
        tracing::debug!(evaluation, "evaluation begins");
        // The optimizer treats a panic as a failure; it has to be in the journal like one.
        let answer = catch_unwind(AssertUnwindSafe(|| self.inner.evaluate(&inner)))
            .unwrap_or_else(|payload| Err(OracleError::Panicked { message: panic_text(payload.as_ref()) }))
            .and_then(finite);
        let (outcome, data) = match &answer {
            Err(error) => (Outcome::Failure(error.to_string()), None),
            Ok(answer) => {
                let Evaluation { value, subgradient, error_bound, warm_start } = answer.evaluation();
                let (value, error_bound, subgradient) = (*value, *error_bound, subgradient.as_slice().to_vec());
                let no_descent = matches!(answer, Answer::NoDescent(_));
                (Outcome::Answer { value, subgradient, error_bound, no_descent }, Some(warm_start))
            }
        };
        let mut state = self.state.borrow_mut();
        let seconds = state.before + state.clock.elapsed().as_secs_f64();
        let (point, accuracy) = (request.point.as_slice().to_vec(), request.accuracy.tolerance());
        let entry = Entry { evaluation, point, accuracy, seconds, outcome };
        let written = state.journal.append(&entry, data, center);
        let news = written.is_err() && !state.failing;
        state.failing = written.is_err();
        drop(state);
        if let (Err(error), true) = (written, news) {
            self.warn(format!(
                "from evaluation {evaluation} on, evaluations are not in the journal: {error}; tried again each time"
            ));
        }
        let kept = |inner: Evaluation<ContactWarmStart>| Evaluation {
            value: inner.value,
            subgradient: inner.subgradient,
            error_bound: inner.error_bound,
            warm_start: Kept { evaluation, data: Some(inner.warm_start) },
        };
        Ok(match answer? {
            Answer::Accurate(inner) => Answer::Accurate(kept(inner)),
            Answer::NoDescent(inner) => Answer::NoDescent(kept(inner)),
        })
    }

    fn warn(&self, words: String) {
        eprintln!("warning: {words}");
        self.state.borrow_mut().warnings.push(words);
    }
}

impl<O: NonsmoothObjective<WarmStart = ContactWarmStart>> NonsmoothObjective for Journaled<'_, O> {
    type WarmStart = Kept;

    fn dimension(&self) -> usize {
        self.inner.dimension()
    }

    fn evaluate(&self, request: &Request<'_, Kept>) -> Result<Answer<Kept>, OracleError> {
        self.state.borrow_mut().evaluation += 1;
        match self.replayed(request) {
            Some(answer) => answer,
            None => self.computed(request),
        }
    }
}

fn panic_text(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a payload that is not text".to_owned())
}

/// Numbers that are not finite have no form in the journal; to the optimizer they are failures anyway.
fn finite(answer: Answer<ContactWarmStart>) -> Result<Answer<ContactWarmStart>, OracleError> {
    let evaluation = answer.evaluation();
    let refuse = |what| Err(OracleError::NotFinite { what });
    if !evaluation.value.is_finite() {
        refuse("value")
    } else if nonsmooth::linalg::first_non_finite(evaluation.subgradient.as_slice()).is_some() {
        refuse("subgradient")
    } else if !evaluation.error_bound.is_finite() {
        refuse("error bound")
    } else {
        Ok(answer)
    }
}
