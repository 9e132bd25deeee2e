//! What to do when the model promises almost nothing: lower the weight, stop, or restart locally.
//!
//! A small predicted decrease at a large weight is not stationarity (a flat valley), and one that rests on cuts far from
//! the center is none either (a nonconvex function): both are checked before a run ends.

use super::config::AccuracyPolicy;
use super::cut::{Cut, LEAST_ACTIVE_MULTIPLIER};
use super::proposers::proposal::Proposal;
use super::run::Run;
use crate::report::Termination;
use crate::{NonsmoothObjective, Vector};
use std::ops::ControlFlow::{self, Break, Continue};

/// Active cuts within this relative distance confirm stationarity.
const CONFIRMING_RADIUS: f64 = 1e-5;
/// Largest share of the aggregate subgradient that may stem from convexification in a confirmed end: more means that
/// subgradients and values contradict each other, or that the cuts lie on both sides of a ridge.
const MAX_CONVEXIFIED_SHARE: f64 = 0.1;
/// The weight is lowered until the step has this relative length.
const LEAST_STEP_LENGTH: f64 = 1e-2;

impl<O: NonsmoothObjective> Run<'_, '_, O> {
    /// A trial point worth an evaluation, or the reason to end.
    pub(super) fn next_trial(&mut self) -> ControlFlow<Termination, Proposal> {
        loop {
            let proposal = self.solve_subproblem()?;
            if proposal.predicted_decrease > self.small() || self.center_is_too_coarse(&proposal) {
                return Continue(proposal);
            }
            let kept = self.state.weight;
            let proposal = self.decrease_weight(proposal);
            if proposal.predicted_decrease > self.small() {
                return Continue(proposal);
            }
            self.state.weight = kept;
            self.stopping_test(&proposal)?;
            if !self.restart(&proposal) {
                return Continue(proposal);
            }
        }
    }

    /// Predicted decrease that counts as small: tolerance, rounding or noise.
    pub(super) fn small(&self) -> f64 {
        self.tolerance().max(self.noise_level())
    }

    pub(super) fn tolerance(&self) -> f64 {
        let config = &self.method.config;
        config.tolerance * self.state.value_scale(config) + self.state.rounding()
    }

    /// Noise seen in the values, or promised by the oracle and not to be improved by asking for more.
    pub(super) fn noise_level(&self) -> f64 {
        let center = self.state.center_error_bound();
        let promised = match self.method.config.accuracy {
            AccuracyPolicy::Tightest => {
                let active = self.state.bundle.cuts().iter().filter(|cut| cut.is_active());
                center + active.map(Cut::excess).fold(0.0, f64::max)
            }
            AccuracyPolicy::OnDemand { tightest, .. } => {
                let asked = self.state.center_accuracy;
                let refused = center > 2.0 * asked * self.state.center_value.abs();
                if asked <= 2.0 * tightest || refused { center } else { 0.0 }
            }
        };
        self.state.noise.max(promised)
    }

    /// Lowers the weight, without evaluations, until the step is long enough to tell or the decrease is not small.
    fn decrease_weight(&mut self, mut proposal: Proposal) -> Proposal {
        for _ in 0..self.method.config.attenuation_steps {
            if proposal.step_length >= LEAST_STEP_LENGTH * self.state.length_scale() {
                break;
            }
            let kept = self.state.weight;
            self.state.weight = kept / 10.0;
            match self.try_subproblem() {
                Ok(next) => proposal = next,
                Err(_) => {
                    self.state.weight = kept;
                    break;
                }
            }
            if proposal.predicted_decrease > self.small() {
                break;
            }
        }
        proposal
    }

    /// Ends the run if nothing is left to try.
    fn stopping_test(&mut self, proposal: &Proposal) -> ControlFlow<Termination> {
        let noise = self.noise_level();
        if noise > self.tolerance() && proposal.predicted_decrease > 0.0 {
            return Break(Termination::NoiseLimit { estimate: noise });
        }
        let radius = self.active_radius(proposal) / self.state.length_scale().max(f64::MIN_POSITIVE);
        let near = radius <= CONFIRMING_RADIUS;
        let trusted = self.convexified_share(proposal) <= MAX_CONVEXIFIED_SHARE;
        if near && trusted {
            return Break(Termination::Stationary { radius });
        }
        let allowed = if self.state.nonconvex { self.method.config.max_restarts } else { 1 };
        if self.state.restarts >= allowed.min(self.method.config.max_restarts) {
            return Break(if near {
                Termination::StepTooShort { predicted_decrease: proposal.predicted_decrease }
            } else {
                Termination::StationaryUnconfirmed { radius }
            });
        }
        Continue(())
    }

    /// Norm of what convexification added to the aggregate subgradient, relative to the active subgradients.
    fn convexified_share(&self, proposal: &Proposal) -> f64 {
        let state = &self.state;
        let (mut added, mut slopes) = (Vector::zeros(state.center.len()), 0.0);
        for (cut, &multiplier) in state.bundle.cuts().iter().zip(&proposal.cut_multipliers) {
            added +=
                state.norm.lower_index(&(&state.center - &cut.point)) * (2.0 * proposal.convexification * multiplier);
            slopes += multiplier * state.norm.dual_length(&cut.subgradient);
        }
        if slopes > 0.0 { state.norm.dual_length(&added) / slopes } else { 0.0 }
    }

    /// Largest distance of a cut with a positive multiplier.
    pub(super) fn active_radius(&self, proposal: &Proposal) -> f64 {
        let cuts = self.state.bundle.cuts().iter().zip(&proposal.cut_multipliers);
        let active = cuts.filter(|(_, multiplier)| **multiplier > LEAST_ACTIVE_MULTIPLIER);
        let distances = active.map(|(cut, _)| self.state.norm.squared_distance(&self.state.center, &cut.point));
        distances.fold(0.0, f64::max).sqrt()
    }

    /// Forgets the cuts far away and takes a short step next; false if there was nothing to forget.
    fn restart(&mut self, proposal: &Proposal) -> bool {
        self.state.restarts += 1;
        self.state.counts.restarts += 1;
        let config = &self.method.config;
        let radius = config.restart_radius * self.active_radius(proposal);
        let state = &mut self.state;
        let before = state.bundle.cuts().len();
        let (center, center_id, norm) = (&state.center, state.center_id, &state.norm);
        state.bundle.retain(|cut| cut.id == center_id || norm.squared_distance(center, &cut.point) <= radius * radius);
        if state.bundle.cuts().len() == before {
            return false;
        }
        let slope = state.bundle.cut(center_id).map_or(0.0, |cut| norm.dual_length(&cut.subgradient));
        let weight = state.weight.max(slope / (config.restart_radius * radius));
        state.set_weight(weight, config);
        state.streak = 0;
        state.variation = None;
        self.forget_model();
        true
    }
}
