//! A decorator that counts and times the evaluations of an objective.

use crate::{Answer, NonsmoothObjective, OracleError, Request};
use std::cell::Cell;
use std::time::Instant;

/// An objective with counters. Not `Sync`: count per thread.
///
/// ```
/// use nonsmooth::{Counted, FnObjective, NonsmoothObjective, Request, Vector};
/// let theta = Counted::new(FnObjective::new(1, |x: &Vector| (x[0].abs(), Vector::from_element(1, x[0].signum()))));
/// theta.evaluate(&Request::tight(&Vector::from_element(1, 3.0)))?;
/// assert_eq!(theta.evaluations(), 1);
/// # Ok::<(), nonsmooth::OracleError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Counted<O> {
    inner: O,
    evaluations: Cell<usize>,
    failures: Cell<usize>,
    no_descent: Cell<usize>,
    seconds: Cell<f64>,
}

impl<O> Counted<O> {
    /// Wraps an objective; all counters are zero.
    pub fn new(inner: O) -> Self {
        Self {
            inner,
            evaluations: Cell::new(0),
            failures: Cell::new(0),
            no_descent: Cell::new(0),
            seconds: Cell::new(0.0),
        }
    }

    /// The objective inside.
    pub fn inner(&self) -> &O {
        &self.inner
    }

    /// Evaluations so far, failed ones included.
    pub fn evaluations(&self) -> usize {
        self.evaluations.get()
    }

    /// Evaluations that returned an error; one that panicked counts as an evaluation only.
    pub fn failures(&self) -> usize {
        self.failures.get()
    }

    /// Evaluations answered by a certificate of no descent.
    pub fn no_descent(&self) -> usize {
        self.no_descent.get()
    }

    /// Seconds spent inside the objective.
    pub fn seconds(&self) -> f64 {
        self.seconds.get()
    }
}

impl<O: NonsmoothObjective> NonsmoothObjective for Counted<O> {
    type WarmStart = O::WarmStart;

    fn dimension(&self) -> usize {
        self.inner.dimension()
    }

    fn evaluate(&self, request: &Request<'_, O::WarmStart>) -> Result<Answer<O::WarmStart>, OracleError> {
        self.evaluations.set(self.evaluations.get() + 1);
        let clock = Instant::now();
        let answer = self.inner.evaluate(request);
        self.seconds.set(self.seconds.get() + clock.elapsed().as_secs_f64());
        match &answer {
            Err(_) => self.failures.set(self.failures.get() + 1),
            Ok(Answer::NoDescent(_)) => self.no_descent.set(self.no_descent.get() + 1),
            Ok(Answer::Accurate(_)) => {}
        }
        answer
    }
}
