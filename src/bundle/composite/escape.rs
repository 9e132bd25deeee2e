//! Steps away from a point that is proved stationary, whose proof stands if they find nothing lower.
//!
//! ```text
//! predicted > small/10:      the model's own last step, which costs one evaluation: near a stationary point the model is at its best;
//!                            not once more from its end, unless it has brought more than a small decrease
//! s_i + S_i d ≤ −s_i/2 for the inactive constraints next to the point      one composite step with these rows, then go on
//! ```
//! The linearization at a stationary point sees one piece of c alone. Where a constraint inside c (an open contact node) is all
//! but active, the neighbouring piece may lead lower. The steps may rise above the center. They end when a trial point is
//! serious, when the model promises no value below the center any more, or after a few evaluations.

use super::base::Base;
use super::steps::{Changes, Steps};
use super::trust::{FACTOR, Trust};
use crate::bundle::proof::Ending;
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::proposers::proposer::{Answer, Position};
use crate::composite::InactiveConstraints;
use crate::{Polyhedron, Vector};

/// Evaluations of an escape, its first included.
const MAX_EVALUATIONS: usize = 4;
/// How far beyond its activation a constraint is taken, relative to its slack.
const BEYOND: f64 = 0.5;
/// Distances up to which constraints count as next to the point, in lengths of the first step; tried in turn.
const NEAR: [f64; 3] = [0.3, 0.1, 0.03];
/// One linearization is pessimistic where constraints become active: decreases up to this many times the predicted one are common.
const PESSIMISM: f64 = 2.5;
/// A last step of the model is worth its evaluation if it promises this share of a small decrease.
const WORTH_A_STEP: f64 = 0.1;

/// Steps away from a stationary center.
#[derive(Debug)]
pub(super) struct Escape {
    /// The end of the run if the steps find nothing lower.
    pub ending: Ending,
    /// The base at the center.
    center: Base,
    /// Whether the pending step is the model's own last step, before the closing step.
    pub last_step: bool,
    /// Where the model of the next step is built; none before the first evaluation.
    base: Option<Base>,
    pub weight: f64,
    /// Evaluations left.
    left: usize,
}

impl Escape {
    /// The way out of a proved center: the model's last step if it is worth its evaluation, else the closing step, else the end.
    pub(super) fn begin(
        at: &mut Position<'_>,
        steps: &mut Steps,
        (ending, center): (Ending, Base),
        last: Option<Proposal>,
    ) -> (Option<Self>, Answer) {
        let resolution = at.resolution();
        let worth = (WORTH_A_STEP * resolution.small()).max(resolution.rounding);
        match last.filter(|last| last.predicted_decrease > worth) {
            Some(last) => {
                let escape = Self { ending, center, last_step: true, base: None, weight: last.weight, left: 0 };
                (Some(escape), Answer::trial(last))
            }
            None => Self::close(at, steps, ending, center),
        }
    }

    /// The first step beyond the constraints next to the point, or the end of the run with the proof where there are none.
    fn close(at: &mut Position<'_>, steps: &mut Steps, ending: Ending, center: Base) -> (Option<Self>, Answer) {
        let inactive = center.linearization.inactive.clone();
        for near in inactive.iter().flat_map(|_| NEAR) {
            let closing = inactive.as_ref().and_then(|inactive| closing_set(at, &center, inactive, near));
            let Some(set) = closing else { continue };
            let weight = Trust::new(at.state.first_weight).weight;
            // A fault of h beyond the constraints takes nothing from the proof.
            let found = steps.step(at, &center, weight, Changes { set: Some(&set), origin: None });
            if let Ok(Some((proposal, _))) = found {
                let predicted_decrease = at.resolution().small();
                let left = MAX_EVALUATIONS - 1;
                let escape = Self { ending, center, last_step: false, base: None, weight, left };
                return (Some(escape), Answer::trial(Proposal { predicted_decrease, ..proposal }));
            }
        }
        (None, Answer::end(ending))
    }

    /// The next trial point, or the end of the run with the proof of its center.
    pub(super) fn next(mut self, at: &mut Position<'_>, steps: &mut Steps) -> (Option<Self>, Answer) {
        if self.last_step {
            return Self::close(at, steps, self.ending, self.center);
        }
        let (small, center) = (at.resolution().small(), at.state.center_value);
        let base = self.base.take().filter(|_| self.left > 0);
        let found = base.and_then(|base| {
            let (proposal, _) = steps.step(at, &base, self.weight, Changes::default()).ok().flatten()?;
            (base.value - PESSIMISM * proposal.predicted_decrease < center - small).then_some((base, proposal))
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
            self.weight *= FACTOR;
        } else {
            self.weight /= FACTOR;
            self.base = seen;
        }
    }

    /// No further evaluation.
    pub(super) fn give_up(&mut self) {
        self.left = 0;
    }
}

/// The admissible points at which, by the linearization, the constraints within a distance are violated by [`BEYOND`] of their slacks;
/// none if no constraint is so near.
fn closing_set(at: &Position<'_>, base: &Base, inactive: &InactiveConstraints, near: f64) -> Option<Polyhedron> {
    let reach = near * at.state.first_step;
    let distance = |i: usize| inactive.slacks[i] / at.state.norm.dual_length(&inactive.jacobian.row(i).transpose());
    let close: Vec<usize> = (0..inactive.slacks.len()).filter(|&i| distance(i) <= reach).collect();
    if close.is_empty() {
        return None;
    }
    let rows = inactive.jacobian.select_rows(&close);
    let at_base = &rows * &base.point;
    let upper = Vector::from_fn(close.len(), |k, _| at_base[k] - (1.0 + BEYOND) * inactive.slacks[close[k]]);
    let open = Vector::from_element(close.len(), f64::NEG_INFINITY);
    at.set.clone().with_rows(&rows, &open, &upper).ok()
}
