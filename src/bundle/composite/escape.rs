//! Steps away from a confirmed point, whose proof of stationarity stands if they find nothing lower.
//!
//! ```text
//! s_i + S_i d ≤ −s_i/2 for the inactive constraints next to the point      one composite step with these rows, then go on
//! ```
//! The linearization at a stationary point sees one piece of c alone. Where a constraint inside c (an open contact
//! node) is all but active, the neighbouring piece may lead lower. The steps may rise above the center. They end when a
//! trial point is serious, when the model promises no value below the center any more, or after two evaluations.

use super::base::Base;
use super::steps::{Changes, Steps};
use super::trust::Trust;
use crate::bundle::proof::Ending;
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::proposers::proposer::{Answer, Position};
use crate::composite::InactiveConstraints;
use crate::{Polyhedron, Vector};

/// Steps away from a stationary center.
#[derive(Debug)]
pub(super) struct Escape {
    /// The end of the run if the steps find nothing lower.
    pub ending: Ending,
    /// Where the model of the next step is built; none before the first evaluation.
    base: Option<Base>,
    pub weight: f64,
    /// Number of evaluations that the escape steps may still spend.
    left: usize,
}

impl Escape {
    /// The first step beyond the constraints next to the point, or the end of the run with the proof where there are
    /// none.
    pub(super) fn begin(
        at: &mut Position<'_>,
        steps: &mut Steps,
        ending: Ending,
        center: &Base,
    ) -> (Option<Self>, Answer) {
        let inactive = center.linearization.inactive.as_ref();
        let Some(set) = inactive.and_then(|inactive| closing_set(at, center, inactive)) else {
            return (None, Answer::end(ending));
        };
        let weight = Trust::new(at.state.first_weight).next.weight;
        // A fault of h beyond the constraints takes nothing from the proof.
        let Ok(Some((proposal, _))) = steps.step(at, center, weight, Changes { set: Some(&set), origin: None }) else {
            return (None, Answer::end(ending));
        };
        let predicted_decrease = at.resolution().small();
        // Two evaluations in all.
        let escape = Self { ending, base: None, weight, left: 1 };
        (Some(escape), Answer::trial(Proposal { predicted_decrease, ..proposal }))
    }

    /// The next trial point, or the end of the run with the proof of its center.
    pub(super) fn next(mut self, at: &mut Position<'_>, steps: &mut Steps) -> (Option<Self>, Answer) {
        let (small, center) = (at.resolution().small(), at.state.center_value);
        let base = self.base.take().filter(|_| self.left > 0);
        let found = base.and_then(|base| {
            let (proposal, _) = steps.step(at, &base, self.weight, Changes::default()).ok().flatten()?;
            // One linearization is pessimistic where constraints become active: twice the predicted decrease is common.
            (base.value - 2.0 * proposal.predicted_decrease < center - small).then_some((base, proposal))
        });
        let Some((base, proposal)) = found else { return (None, Answer::end(self.ending)) };
        let predicted_decrease = (center - base.value + proposal.predicted_decrease).max(small);
        self.base = Some(base);
        self.left -= 1;
        (Some(self), Answer::trial(Proposal { predicted_decrease, ..proposal }))
    }

    /// Takes note of a trial point that is not serious; `seen` is a base at this point where its Jacobian is known.
    pub(super) fn learn(&mut self, value: f64, seen: Option<Base>) {
        if self.base.as_ref().is_some_and(|base| value >= base.value) {
            self.weight *= 10.0;
        } else {
            self.weight /= 10.0;
            self.base = seen;
        }
    }

    /// Ends the escape steps: no evaluation is spent on them any more.
    pub(super) fn give_up(&mut self) {
        self.left = 0;
    }
}

/// The admissible points at which, by the linearization, the constraints within a first step are violated by half of
/// their slacks; none if no constraint is so near.
fn closing_set(at: &Position<'_>, base: &Base, inactive: &InactiveConstraints) -> Option<Polyhedron> {
    let distance = |i: usize| inactive.slacks[i] / at.state.norm.dual_length(&inactive.jacobian.row(i).transpose());
    let close: Vec<usize> = (0..inactive.slacks.len()).filter(|&i| distance(i) <= at.state.first_step).collect();
    if close.is_empty() {
        return None;
    }
    let rows = inactive.jacobian.select_rows(&close);
    let at_base = &rows * &base.point;
    let upper = Vector::from_fn(close.len(), |k, _| at_base[k] - 1.5 * inactive.slacks[close[k]]);
    let open = Vector::from_element(close.len(), f64::NEG_INFINITY);
    at.set.clone().with_rows(&rows, &open, &upper).ok()
}
