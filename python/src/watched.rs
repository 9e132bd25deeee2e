//! An objective that remembers the subgradients of its best points: a report holds the best point, but not what belongs
//! to it.

use crate::outcome::RunOutcome;
use nonsmooth::composite::OuterFunction;
use nonsmooth::{
    Answer, ConstraintKind, Evaluation, NonsmoothObjective, OracleError, Polyhedron, Report, Request, Vector,
};
use std::cell::RefCell;

/// An accurate answer.
#[derive(Debug)]
struct Known {
    point: Vector,
    value: f64,
    /// Largest violation of a nonlinear constraint, in the unit of the constraint.
    violation: f64,
    subgradient: Vector,
}

impl Known {
    /// Whether another answer is worse in neither value nor violation.
    fn yields_to(&self, other: &Self) -> bool {
        other.value <= self.value && other.violation <= self.violation || other.point == self.point
    }
}

/// An objective with those of its accurate answers that have no other below them in both value and violation; without
/// nonlinear constraints, this is the lowest answer alone.
#[derive(Debug)]
pub struct Watched<O> {
    pub inner: O,
    best: RefCell<Vec<Known>>,
}

impl<O> Watched<O> {
    pub fn new(inner: O) -> Self {
        Self { inner, best: RefCell::default() }
    }

    /// The report with the subgradient at its solution.
    pub fn outcome(&self, report: Report, set: Polyhedron) -> RunOutcome {
        let best = self.best.borrow();
        let there = best.iter().find(|known| known.point == report.solution);
        let subgradient = there.map(|known| known.subgradient.clone());
        RunOutcome { report, set, subgradient }
    }
}

impl<O: NonsmoothObjective> Watched<O> {
    fn remember<W>(&self, point: &Vector, evaluation: &Evaluation<W>) {
        let values = evaluation.constraints.iter().flat_map(|constraints| constraints.values.iter());
        let violations = values.zip(self.inner.constraint_kinds()).map(|(value, kind)| kind.violation(*value));
        // `f64::max` would leave out what is NaN.
        let violation = violations.fold(0.0, |most, next| if most >= next { most } else { next });
        if !(evaluation.value.is_finite() && violation.is_finite()) {
            return;
        }
        let (value, subgradient) = (evaluation.value, evaluation.subgradient.clone());
        let new = Known { point: point.clone(), value, violation, subgradient };
        let mut best = self.best.borrow_mut();
        // A second evaluation of a point refines it and replaces the first, whatever its value.
        if best.iter().all(|known| known.yields_to(&new) || !new.yields_to(known)) {
            best.retain(|known| !known.yields_to(&new));
            best.push(new);
        }
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
            self.remember(request.point, evaluation);
        }
        Ok(answer)
    }
}
