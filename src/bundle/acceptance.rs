//! Turns an answer of the oracle into a serious or a null step, and updates weight, bundle, center and noise.

use super::config::Convexity;
use super::cut::Cut;
use super::event::Event;
use super::proposers::proposal::Proposal;
use super::proposers::proposer::{Comparison, Trial};
use super::run::Run;
use super::state::NOISE_MARGIN;
use crate::report::StepKind;
use crate::{Accuracy, Answer, Evaluation, Vector};

/// Only steps shorter than this share of the length scale tell noise from slope.
const NOISE_STEP: f64 = 1e-4;
/// A change of Θ is noise if it exceeds this many times ‖d‖ times the largest ‖g‖*, promised errors and rounding aside.
const STEEPNESS_MARGIN: f64 = 4.0;
/// Cuts in the bundle beyond the number of variables, unless `bundle_size` is set.
const EXTRA_CUTS: usize = 15;
/// Largest number of cuts, unless `bundle_size` is set.
const MAX_CUTS: usize = 500;

impl Run<'_, '_> {
    /// Decides between serious and null step, and updates weight, bundle and center.
    pub(super) fn accept_or_reject(&mut self, proposal: Proposal, accuracy: Accuracy, answer: Answer<()>) {
        let accurate = matches!(answer, Answer::Accurate(_));
        let mut evaluation = answer.into_evaluation();
        let linearization = std::mem::take(&mut evaluation.linearization);
        let (value, work) = (evaluation.value, evaluation.work);
        let comparison = Comparison::new(&self.state, &proposal, value, &evaluation.subgradient);
        let serious = accurate && comparison.is_serious(&self.method.config);
        self.state.failures = 0;
        self.state.longest_step = None;
        if accurate {
            self.watch_noise(&proposal, &evaluation);
        }
        let trial = Trial { proposal: &proposal, comparison, accurate, serious };
        self.proposers.learn(&mut self.state, &self.method.config, &trial);
        let kind = if serious {
            if -comparison.change > self.tolerance() {
                self.state.restarts = 0;
            }
            self.state.counts.serious += 1;
            StepKind::Serious
        } else {
            self.state.counts.null += 1;
            if accurate { StepKind::Null } else { StepKind::NoDescent }
        };
        self.add_cut(proposal.trial.clone(), &evaluation, !accurate);
        if serious {
            self.move_center(proposal.trial.clone(), value, accuracy);
        } else if accurate {
            self.remember_lowest();
        }
        let noted = self.learn_structure(&trial, value, linearization);
        self.record(&proposal, accuracy, Event { kind, value: Some(value), failure: None, noted, work });
    }

    /// Values that jump although the points almost coincide, and cuts above the values of a convex function, are noise.
    fn watch_noise(&mut self, proposal: &Proposal, evaluation: &Evaluation<()>) {
        let state = &mut self.state;
        let change = evaluation.value - state.center_value;
        let promised = evaluation.error_bound + state.center_error_bound() + state.rounding();
        if proposal.step_length <= NOISE_STEP * state.length_scale().max(state.first_step) {
            let steepest = state.bundle.dual_lengths().fold(state.norm.dual_length(&evaluation.subgradient), f64::max);
            if change.abs() > STEEPNESS_MARGIN * steepest * proposal.step_length + NOISE_MARGIN * promised {
                state.noise = state.noise.max(change.abs());
                // Pairs that seemed to prove Θ nonconvex may have shown noise; the others prove it again.
                state.nonconvex = false;
            }
        }
        if self.method.config.convexity == Convexity::Convex {
            let error = evaluation.subgradient.dot(&proposal.step) - change;
            if error < -NOISE_MARGIN * promised {
                state.noise = state.noise.max(-error);
            }
        }
    }

    pub(super) fn add_cut(&mut self, point: Vector, evaluation: &Evaluation<()>, certified: bool) {
        let size = self.method.config.bundle_size.unwrap_or_else(|| (point.len() + EXTRA_CUTS).min(MAX_CUTS));
        let state = &mut self.state;
        state.bundle.make_room(size, state.center_id, &mut state.next_id, &state.norm);
        let cut = Cut {
            id: state.next_id,
            point,
            radius: 0.0,
            value: evaluation.value,
            subgradient: evaluation.subgradient.clone(),
            error_bound: evaluation.error_bound,
            certified,
            multiplier: 0.0,
            idle: 0,
        };
        state.bundle.push(cut, &state.norm);
        state.next_id += 1;
        self.forget_model();
    }

    /// Remembers the newest cut if it is the lowest so far and lies below the center.
    fn remember_lowest(&mut self) {
        let state = &mut self.state;
        let lowest = state.lowest.as_ref().map_or(state.center_value, Cut::highest_value).min(state.center_value);
        if let Some(newest) = state.bundle.cut(state.next_id - 1).filter(|cut| cut.highest_value() < lowest) {
            state.lowest = Some(newest.clone());
        }
    }

    /// Moves the center to the point of the newest cut, which must be that of the last evaluation.
    pub(super) fn move_center(&mut self, point: Vector, value: f64, accuracy: Accuracy) {
        self.state.center = point;
        self.state.center_value = value;
        self.state.center_id = self.state.next_id - 1;
        self.state.center_accuracy = accuracy.tolerance();
        self.oracle.keep_warm_start();
    }
}
