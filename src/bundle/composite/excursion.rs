//! Steps away from a point that is proved stationary, whose proof stands if they find nothing lower.
//!
//! ```text
//! predicted > small/10:      the model's own last step, which costs one evaluation: near a stationary point the model is at its best;
//!                            not once more from its end, unless it has brought more than a small decrease
//! s_i + S_i d ≤ −s_i/2 for the inactive constraints next to the point      one composite step with these rows, then go on
//! ```
//! The linearization at a stationary point sees one piece of c alone. Where a constraint inside c (an open contact node) is all
//! but active, the neighbouring piece may lead lower. The excursion may rise above the center. It ends when a trial point is
//! serious, when the model promises no value below the center any more, or after a few evaluations.

use super::base::Base;
use super::proof::Proof;
use super::state::{Composite, Excursion, FACTOR};
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::proposers::proposer::Trial;
use crate::bundle::run::Run;
use crate::composite::{InactiveConstraints, Linearization};
use crate::report::Termination;
use crate::{Polyhedron, Vector};
use std::ops::ControlFlow::{self, Break, Continue};

/// Evaluations of an excursion, its first included.
const MAX_EVALUATIONS: usize = 4;
/// How far beyond its activation a constraint is taken, relative to its slack.
const BEYOND: f64 = 0.5;
/// Distances up to which constraints count as next to the point, in lengths of the first step; tried in turn.
const NEAR: [f64; 3] = [0.3, 0.1, 0.03];
/// One linearization is pessimistic where constraints become active: decreases up to this many times the predicted one are common.
const PESSIMISM: f64 = 2.5;

/// A last step of the model is worth its evaluation if it promises this share of a small decrease.
const WORTH_A_STEP: f64 = 0.1;

impl Run<'_, '_> {
    /// Ends the run with a proof, unless the model's last step is worth its evaluation or constraints next to the point are to be closed
    /// first.
    pub(super) fn leave(&mut self, proof: Proof, last: Proposal) -> ControlFlow<Termination, Option<Proposal>> {
        let worth = (WORTH_A_STEP * self.small()).max(self.state.rounding());
        let polished = self.composite.as_ref().is_some_and(|composite| composite.polished);
        if polished || last.predicted_decrease <= worth {
            return self.close(proof);
        }
        let weight = last.weight;
        self.depart(Excursion { proof: Box::new(proof), last_step: true, base: None, weight, left: 0 });
        Continue(Some(last))
    }

    fn depart(&mut self, excursion: Excursion) {
        if let Some(composite) = &mut self.composite {
            composite.excursion = Some(excursion);
        }
    }

    /// The first step beyond the constraints next to the point, or the end of the run with the proof where there are none.
    fn close(&mut self, proof: Proof) -> ControlFlow<Termination, Option<Proposal>> {
        let inactive = proof.base.linearization.inactive.clone();
        for near in inactive.iter().flat_map(|_| NEAR) {
            let Some(set) = inactive.as_ref().and_then(|inactive| self.closing_set(&proof.base, inactive, near)) else {
                continue;
            };
            let first_weight = Composite::new(self.state.first_weight).weight;
            // A fault of h beyond the constraints takes nothing from the proof.
            if let Continue(Some((proposal, _))) = self.composite_step(&proof.base, first_weight, Some(&set), None) {
                let (proof, left) = (Box::new(proof), MAX_EVALUATIONS - 1);
                self.depart(Excursion { proof, last_step: false, base: None, weight: first_weight, left });
                let predicted_decrease = self.small();
                return Continue(Some(Proposal { predicted_decrease, ..proposal }));
            }
        }
        self.prove(proof)
    }

    fn prove(&mut self, proof: Proof) -> ControlFlow<Termination, Option<Proposal>> {
        let word = proof.word.clone();
        self.proof = Some(proof);
        Break(word)
    }

    /// Ends an excursion together with its proof, which the center evaluated anew has outdated.
    pub(in crate::bundle) fn forget_excursion(&mut self) {
        if let Some(composite) = &mut self.composite {
            composite.excursion = None;
        }
    }

    /// The termination of the stationary center, if a limit ends the run on an excursion from this center.
    pub(in crate::bundle) fn end_excursion(&mut self) -> Option<Termination> {
        let excursion = self.composite.as_mut()?.excursion.take()?;
        let word = excursion.proof.word.clone();
        self.proof = Some(*excursion.proof);
        Some(word)
    }

    /// The admissible points at which, by the linearization, the constraints within a distance are violated by [`BEYOND`] of their slacks;
    /// none if no constraint is so near.
    fn closing_set(&self, base: &Base, inactive: &InactiveConstraints, near: f64) -> Option<Polyhedron> {
        let reach = near * self.state.first_step;
        let distance =
            |i: usize| inactive.slacks[i] / self.state.norm.dual_length(&inactive.jacobian.row(i).transpose());
        let close: Vec<usize> = (0..inactive.slacks.len()).filter(|&i| distance(i) <= reach).collect();
        if close.is_empty() {
            return None;
        }
        let rows = inactive.jacobian.select_rows(&close);
        let at_base = &rows * &base.point;
        let upper = Vector::from_fn(close.len(), |k, _| at_base[k] - (1.0 + BEYOND) * inactive.slacks[close[k]]);
        let open = Vector::from_element(close.len(), f64::NEG_INFINITY);
        self.set.clone().with_rows(&rows, &open, &upper).ok()
    }

    /// The next trial point of an excursion, or the end of the run with the proof of its center.
    pub(super) fn continue_excursion(
        &mut self,
        mut excursion: Excursion,
    ) -> ControlFlow<Termination, Option<Proposal>> {
        if excursion.last_step {
            return self.close(*excursion.proof);
        }
        let base = excursion.base.take().filter(|_| excursion.left > 0);
        let Some(base) = base else { return self.prove(*excursion.proof) };
        let Continue(found) = self.composite_step(&base, excursion.weight, None, None) else {
            return self.prove(*excursion.proof);
        };
        let least = |proposal: &Proposal| base.value - PESSIMISM * proposal.predicted_decrease;
        let center = self.state.center_value;
        let Some((proposal, _)) = found.filter(|(proposal, _)| least(proposal) < center - self.small()) else {
            return self.prove(*excursion.proof);
        };
        let predicted_decrease = (center - base.value + proposal.predicted_decrease).max(self.small());
        excursion.base = Some(base);
        excursion.left -= 1;
        self.depart(excursion);
        Continue(Some(Proposal { predicted_decrease, ..proposal }))
    }

    pub(super) fn learn_excursion(&mut self, trial: &Trial<'_>, value: f64, linearization: Option<Linearization>) {
        let small = self.small();
        let Some(composite) = &mut self.composite else { return };
        let Some(excursion) = &mut composite.excursion else { return };
        let point = &trial.proposal.trial;
        if trial.serious {
            composite.weight = excursion.weight;
            composite.polished = excursion.last_step && -trial.comparison.change <= small;
            composite.excursion = None;
            self.rebase(point, value, linearization);
        } else if excursion.base.as_ref().is_some_and(|base| value >= base.value) {
            excursion.weight *= FACTOR;
        } else {
            excursion.weight /= FACTOR;
            excursion.base = linearization.map(|linearization| Base { point: point.clone(), value, linearization });
        }
    }
}
