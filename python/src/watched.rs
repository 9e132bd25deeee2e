//! An objective that remembers the subgradient of its lowest value: a report holds the best point, but not what belongs
//! to it. With nonlinear constraints, the solution need not be the lowest point; the certificate then has its
//! subgradient.

use crate::outcome::RunOutcome;
use nonsmooth::composite::OuterFunction;
use nonsmooth::{Answer, ConstraintKind, NonsmoothObjective, OracleError, Polyhedron, Report, Request, Vector};
use std::cell::RefCell;

/// An objective with the point, the value and the subgradient of its best accurate answer.
#[derive(Debug)]
pub struct Watched<O> {
    pub inner: O,
    best: RefCell<Option<(Vector, f64, Vector)>>,
}

impl<O> Watched<O> {
    pub fn new(inner: O) -> Self {
        Self { inner, best: RefCell::new(None) }
    }

    /// The report with the subgradient at its solution.
    pub fn outcome(&self, report: Report, set: Polyhedron) -> RunOutcome {
        let best = self.best.borrow();
        let there = best.as_ref().filter(|(at, ..)| *at == report.solution);
        let cuts = report.certificate.iter().flat_map(|certificate| &certificate.cuts);
        let mut of_cuts = cuts.filter(|cut| cut.point == report.solution).map(|cut| &cut.subgradient);
        let subgradient = there.map(|(_, _, subgradient)| subgradient).or_else(|| of_cuts.next()).cloned();
        RunOutcome { report, set, subgradient, runs: vec![] }
    }
}

impl<O: NonsmoothObjective> NonsmoothObjective for Watched<O> {
    type WarmStart = O::WarmStart;

    fn dimension(&self) -> usize {
        self.inner.dimension()
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        self.inner.outer()
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        self.inner.constraint_kinds()
    }

    fn evaluate(&self, request: &Request<'_, Self::WarmStart>) -> Result<Answer<Self::WarmStart>, OracleError> {
        let answer = self.inner.evaluate(request)?;
        if let Answer::Accurate(evaluation) = &answer {
            let mut best = self.best.borrow_mut();
            // A second evaluation of the best point refines it and replaces the first, whatever its value.
            if best.as_ref().is_none_or(|(at, value, _)| evaluation.value <= *value || at == request.point) {
                *best = Some((request.point.clone(), evaluation.value, evaluation.subgradient.clone()));
            }
        }
        Ok(answer)
    }
}
