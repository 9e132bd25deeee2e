//! What to do when the model promises almost nothing: lower the weight, stop, or restart locally.
//!
//! A small predicted decrease at a large weight is not stationarity (a flat valley), and one that rests on cuts far from
//! the center is none either (a nonconvex function): both are checked before a run ends. For a function declared convex the cuts
//! bound Θ(x̂) − Θ(y) within reach, wherever they lie: the bound decides, and no restart is made.

use super::config::{AccuracyPolicy, Convexity};
use super::cut::{Cut, LEAST_ACTIVE_MULTIPLIER};
use super::proposers::proposal::Proposal;
use super::run::Run;
use crate::report::Termination;
use std::ops::ControlFlow::{self, Break, Continue};

/// Active cuts within this relative distance confirm stationarity.
const CONFIRMING_RADIUS: f64 = 1e-5;
/// The weight is lowered until the step has this relative length.
const LEAST_STEP_LENGTH: f64 = 1e-2;
/// What may be left within reach at a confirmed end, in small decreases: a decrease that is small at the least step length is at
/// most 1/[`LEAST_STEP_LENGTH`] times as large within reach.
const MAX_REMAINING_DECREASES: f64 = 1.0 / LEAST_STEP_LENGTH;
/// The same where Θ is convex, so that the bound itself ends the run.
const MAX_CONVEX_DECREASES: f64 = 10.0;
/// The bound of a convex Θ, rounding included, up to which its end counts as confirmed, in wanted decreases.
const MAX_BOUND_DECREASES: f64 = 2.0 * MAX_CONVEX_DECREASES;
/// Noise explains decreases up to this many times the noise of two values: predicted ones, and the bound of a convex Θ that ends a run.
const MAX_NOISY_DECREASES: f64 = 4.0;
/// A bound counts only if the linearizations of the active cuts vary within reach by this many times the limit.
const LEAST_SEEN_VARIATION: f64 = 10.0;
/// Noise below this share of the wanted decrease does not matter.
const NEGLIGIBLE_NOISE: f64 = 1e-3;

/// What the cuts say about the decrease within reach.
struct WithinReach {
    /// The least bound.
    bound: f64,
    /// The weight that gave it.
    weight: f64,
    /// The largest weight at which the predicted decrease is not small.
    worthwhile: Option<f64>,
}

impl Run<'_, '_> {
    /// A trial point worth an evaluation, or the reason to end.
    pub(super) fn next_trial(&mut self) -> ControlFlow<Termination, Proposal> {
        loop {
            let proposal = self.solve_subproblem()?;
            if self.center_is_too_coarse(&proposal) {
                return Continue(proposal);
            }
            if self.is_declared_convex() {
                return self.bound_decrease(proposal);
            }
            if proposal.predicted_decrease > self.small() {
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

    pub(super) fn is_declared_convex(&self) -> bool {
        self.method.config.convexity == Convexity::Convex
    }

    /// Predicted decrease that counts as small: the noise of the oracle where it is not negligible, otherwise the tolerance.
    pub(super) fn small(&self) -> f64 {
        self.noise().unwrap_or_else(|| self.tolerance())
    }

    /// The tolerance in units of Θ, plus what rounding hides.
    pub(super) fn tolerance(&self) -> f64 {
        self.wanted_decrease() + self.state.rounding()
    }

    fn wanted_decrease(&self) -> f64 {
        self.method.config.tolerance * self.state.natural_scale(&self.method.config)
    }

    /// Noise of the oracle; none where it is negligible beside the wanted decrease.
    fn noise(&self) -> Option<f64> {
        let noise = self.noise_level();
        (noise > NEGLIGIBLE_NOISE * self.wanted_decrease()).then_some(noise)
    }

    /// Why the run may end at a point where the model leaves a decrease of at most `remaining`, which is `confirmed` up to `allowed` wanted
    /// decreases; none if neither noise nor rounding explains more than that.
    fn word(&self, (remaining, allowed): (f64, f64), confirmed: Termination) -> Option<Termination> {
        let (wanted, rounding) = (self.wanted_decrease(), self.state.rounding());
        if let Some(noise) = self.noise() {
            remaining.is_finite().then(|| Termination::NoiseLimit { estimate: noise.max(remaining) })
        } else if remaining == 0.0 || remaining + rounding <= allowed * wanted {
            Some(confirmed)
        } else {
            (rounding > wanted).then(|| Termination::NoiseLimit { estimate: rounding.max(remaining) })
        }
    }

    /// Why the run may end at a point where a model that is exact at this point leaves at most `remaining` within reach; none if this is
    /// too much.
    pub(super) fn word_at_point(&self, remaining: f64) -> Option<Termination> {
        let convex = self.is_declared_convex();
        let allowed = if convex { MAX_BOUND_DECREASES } else { MAX_REMAINING_DECREASES };
        let confirmed = Termination::Stationary { radius: 0.0, gap: convex.then_some(remaining) };
        self.word((remaining, allowed), confirmed)
    }

    /// Noise seen in the values, or promised by the oracle and not to be reduced by asking for more accuracy.
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

    /// Whether the noise of the values behind the model explains the predicted decrease.
    pub(super) fn is_hidden_by_noise(&self, proposal: &Proposal) -> bool {
        self.noise().is_some_and(|noise| proposal.predicted_decrease <= MAX_NOISY_DECREASES * noise)
    }

    /// Lowers the weight tenfold; the answer at the lower weight, or none if the subproblem cannot be solved there.
    fn lower_weight(&mut self) -> Option<Proposal> {
        let kept = self.state.weight;
        self.state.weight = kept / 10.0;
        let lower = self.try_subproblem().ok();
        if lower.is_none() {
            self.state.weight = kept;
        }
        lower
    }

    /// Lowers the weight, without evaluations, until the step is long enough to tell or the decrease is not small.
    fn decrease_weight(&mut self, mut proposal: Proposal) -> Proposal {
        for _ in 0..self.method.config.attenuation_steps {
            let long_enough = proposal.step_length >= LEAST_STEP_LENGTH * self.state.length_scale();
            if long_enough && self.noise().is_none_or(|noise| self.has_seen_more_than(noise, &proposal)) {
                break;
            }
            let Some(next) = self.lower_weight() else { break };
            proposal = next;
            if proposal.predicted_decrease > self.small() {
                break;
            }
        }
        proposal
    }

    /// Ends the run if the cuts give a small bound of what a convex Θ can still fall. Otherwise the trial point comes from the largest
    /// weight at which the predicted decrease is not small, or from the last one tried.
    fn bound_decrease(&mut self, proposal: Proposal) -> ControlFlow<Termination, Proposal> {
        let noise = self.noise();
        let limit = noise.map_or_else(|| MAX_CONVEX_DECREASES * self.small(), |noise| MAX_NOISY_DECREASES * noise);
        if proposal.predicted_decrease > limit {
            return Continue(proposal);
        }
        let found = self.look_within_reach(proposal, limit);
        let certified = found.bound <= limit;
        self.state.weight = if certified { found.weight } else { found.worthwhile.unwrap_or(self.state.weight) };
        let proposal = self.solve_subproblem()?;
        if !certified {
            return Continue(proposal);
        }
        let confirmed = Termination::Stationary { radius: self.relative_radius(&proposal), gap: Some(found.bound) };
        let uncertain = Termination::NoiseLimit { estimate: found.bound.max(self.state.rounding()) };
        Break(self.word((found.bound, MAX_BOUND_DECREASES), confirmed).unwrap_or(uncertain))
    }

    /// Looks, without evaluations, for the weight at which the cuts give the least bound of the decrease within reach. The run keeps the
    /// last weight tried.
    fn look_within_reach(&mut self, mut proposal: Proposal, limit: f64) -> WithinReach {
        let small = self.small();
        let worthwhile = |proposal: &Proposal| (proposal.predicted_decrease > small).then_some(proposal.weight);
        let mut found = WithinReach {
            bound: self.meaningful_bound(&proposal, limit),
            weight: proposal.weight,
            worthwhile: worthwhile(&proposal),
        };
        let farthest = self.state.norm.length(&self.state.reach());
        for _ in 0..self.method.config.attenuation_steps {
            if proposal.step_length >= farthest && found.bound.is_finite() {
                break;
            }
            let Some(next) = self.lower_weight() else { break };
            proposal = next;
            let bound = self.meaningful_bound(&proposal, limit);
            if bound < found.bound {
                (found.bound, found.weight) = (bound, proposal.weight);
            }
            found.worthwhile = found.worthwhile.or_else(|| worthwhile(&proposal));
        }
        found
    }

    /// The bound of the decrease within reach; ∞ where the linearizations do not vary within reach by much more than the limit, because
    /// a reach that is a rounding of zero proves nothing.
    fn meaningful_bound(&self, proposal: &Proposal, limit: f64) -> f64 {
        let bound = self.state.gap_bound(proposal, &self.set);
        if self.has_seen_more_than(limit, proposal) { bound } else { f64::INFINITY }
    }

    /// Whether the linearizations of the active cuts vary within reach by much more than the limit, or leave no slope at all.
    fn has_seen_more_than(&self, limit: f64, proposal: &Proposal) -> bool {
        proposal.aggregate_norm == 0.0 || self.state.active_variation() >= LEAST_SEEN_VARIATION * limit
    }

    /// Ends the run if the point is confirmed, if noise or rounding hides what remains, or if no restart is left.
    fn stopping_test(&mut self, proposal: &Proposal) -> ControlFlow<Termination> {
        let radius = self.relative_radius(proposal);
        match self.confirmed(proposal) {
            Some(Termination::Stationary { .. }) if self.asks_for_second_look(radius, proposal.weight) => Continue(()),
            Some(word) => Break(word),
            None if self.may_restart() => Continue(()),
            None => Break(Termination::StationaryUnconfirmed { radius }),
        }
    }

    /// Why the run may end at a small predicted decrease; none where the active cuts lie too far, or leave too much.
    pub(super) fn confirmed(&mut self, proposal: &Proposal) -> Option<Termination> {
        let radius = self.relative_radius(proposal);
        let remaining = match self.noise() {
            // Where Θ is not convex, the cuts bound nothing.
            Some(_) if self.state.nonconvex => proposal.predicted_decrease,
            Some(noise) => self.look_within_reach(proposal.clone(), noise).bound,
            None => self.state.decrease_bound(proposal, &self.set),
        };
        // What rounding hides at the active cuts, a restart may bring to light.
        let hidden = self.noise().is_some();
        let word = self.word((remaining, MAX_REMAINING_DECREASES), Termination::Stationary { radius, gap: None })?;
        (radius <= CONFIRMING_RADIUS || hidden && matches!(word, Termination::NoiseLimit { .. })).then_some(word)
    }

    pub(super) fn may_restart(&self) -> bool {
        let allowed = if self.state.nonconvex { self.method.config.max_restarts } else { 1 };
        self.state.restarts < allowed.min(self.method.config.max_restarts)
    }

    /// The radius of the active cuts relative to the length of the variables near the center.
    fn relative_radius(&self, proposal: &Proposal) -> f64 {
        let radius = self.active_radius(proposal);
        radius / self.state.local_length(radius).max(f64::MIN_POSITIVE)
    }

    /// Largest distance from the center of a point behind an active cut.
    pub(super) fn active_radius(&self, proposal: &Proposal) -> f64 {
        let cuts = self.state.bundle.cuts().iter().zip(&proposal.cut_multipliers);
        let active = cuts.filter(|(_, multiplier)| **multiplier > LEAST_ACTIVE_MULTIPLIER);
        active.map(|(cut, _)| cut.farthest_from(&self.state.center, &self.state.norm)).fold(0.0, f64::max)
    }

    /// Forgets the cuts far from the center and raises the weight for a short next step; false if there was nothing to forget.
    fn restart(&mut self, proposal: &Proposal) -> bool {
        self.state.restarts += 1;
        self.state.counts.restarts += 1;
        let config = &self.method.config;
        let radius = config.restart_radius * self.active_radius(proposal);
        let state = &mut self.state;
        let before = state.bundle.cuts().len();
        let (center, center_id, norm) = (&state.center, state.center_id, &state.norm);
        state.bundle.retain(|cut| cut.id == center_id || cut.farthest_from(center, norm) <= radius);
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
