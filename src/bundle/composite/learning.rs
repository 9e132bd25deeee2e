//! What the composite model learns from an evaluation.

use super::base::Base;
use super::kinks::Seen;
use super::state::{Composite, FACTOR};
use crate::Vector;
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::proposers::proposer::Trial;
use crate::bundle::run::Run;
use crate::bundle::state::OutputScales;
use crate::composite::{Linearization, Linearized, OuterFunction};
use crate::panics::without_panic;
use crate::report::{Noted, Origin};

/// A step that brings this share of the predicted decrease lets the weight fall.
const GOOD_RATIO: f64 = 0.5;
/// A step of the model with the curvature of the outputs that brings this many times the predicted decrease has met less curvature than
/// predicted: without any curvature along the step it would bring twice the predicted decrease.
const STRAIGHT_RATIO: f64 = 1.5;
/// So many such steps in a row lower the share of the curvature that counts: single ones come from constraints that become active.
const STRAIGHT_STEPS: usize = 3;
/// The least share of the curvature that counts; three rejected steps lead from here back to the whole.
const LEAST_BEND: f64 = 1.0 / 64.0;
/// Factor by which this share falls, and rises after a rejected step.
const BEND_FACTOR: f64 = 4.0;
/// Largest length of the step after a rejected one, in lengths of the rejected step.
const SHORTER: f64 = 0.3;
/// Longest pause after failures, evaluations.
pub(super) const MAX_PAUSE: usize = 64;
/// Rejected or failed steps in a row before a pause.
const PATIENCE: usize = 3;

impl Composite {
    /// Learns what came of a step of the model: `ratio` is the decrease over the predicted one, none if the oracle failed.
    fn learn(&mut self, proposal: &Proposal, ratio: Option<f64>, accepted: bool) {
        self.weight = proposal.weight;
        if accepted {
            self.failures = 0;
            self.pause.succeed();
            self.longest = f64::INFINITY;
            if ratio.is_some_and(|ratio| ratio >= GOOD_RATIO) {
                self.weight /= FACTOR;
            }
            let straight = self.bent && ratio.is_some_and(|ratio| ratio >= STRAIGHT_RATIO);
            self.straight = if straight { self.straight + 1 } else { 0 };
            if self.straight >= STRAIGHT_STEPS {
                self.bend = (self.bend / BEND_FACTOR).max(LEAST_BEND);
            }
        } else {
            self.failures += 1;
            self.weight *= FACTOR;
            self.straight = 0;
            self.bend = (self.bend * BEND_FACTOR).min(1.0);
            self.longest = SHORTER * proposal.step_length;
            if self.failures >= PATIENCE {
                self.pause.fail(MAX_PAUSE);
            }
        }
    }
}

impl Run<'_, '_> {
    /// Learns from a trial point and from what its evaluation says about the outputs. Returns what to note about the Jacobian.
    pub(in crate::bundle) fn learn_structure(
        &mut self,
        trial: &Trial<'_>,
        value: f64,
        linearization: Linearized,
    ) -> Noted {
        let point = &trial.proposal.trial;
        let Some((known, noted)) = self.note(point, linearization) else { return Noted::Nothing };
        let Some(composite) = self.composite.as_mut() else { return Noted::Nothing };
        if composite.excursion.is_some() {
            self.learn_excursion(trial, value, known);
            return noted;
        }
        let own = trial.proposal.origin == Origin::CompositeModel;
        if let (Some(outer), Some(base)) = (self.outer, &composite.base) {
            let seen = Seen { outer, base, point, change: trial.comparison.change, end: known.as_ref() };
            if !own {
                if composite.kinks.remain(&seen) {
                    composite.pause.prolong();
                }
            } else if composite.kinks.met(&seen, trial.proposal.predicted_decrease, trial.serious) {
                composite.pause.fail(MAX_PAUSE);
            }
        }
        let correcting = std::mem::take(&mut composite.correcting);
        if own && (trial.serious || !correcting) {
            let ratio = trial.comparison.change / trial.comparison.model_change;
            composite.learn(trial.proposal, Some(ratio), trial.serious);
        }
        if trial.serious {
            composite.polished = false;
            self.rebase(point, value, known);
        } else if own && correcting {
            composite.bends = true;
        } else if own {
            let point = point.clone();
            composite.rejected = known.map(|linearization| Base { point, value, linearization });
        }
        noted
    }

    /// Counts and remembers a Jacobian. Returns the linearization, if there is one, and what to note about it; none without a composite
    /// model.
    pub(in crate::bundle) fn note(
        &mut self,
        point: &Vector,
        linearization: Linearized,
    ) -> Option<(Option<Linearization>, Noted)> {
        let (composite, outer) = (self.composite.as_mut()?, self.outer);
        Some(match linearization {
            Linearized::NotAsked => (None, Noted::Nothing),
            Linearized::Unavailable(reason) => (None, Noted::NoJacobian(reason)),
            Linearized::Known(linearization) => {
                self.state.counts.jacobians += 1;
                // Where h has a curvature of its own, the model uses no curvature of the outputs.
                let Linearization { outputs, jacobian, .. } = &linearization;
                let bends = |outer: &dyn OuterFunction| outer.curvature(outputs, jacobian).is_none();
                if outer.is_some_and(|outer| without_panic(|| bends(outer)).unwrap_or_default()) {
                    composite.memory.remember(point, jacobian);
                }
                (Some(linearization), Noted::Jacobian)
            }
        })
    }

    /// Takes note that the oracle failed at a trial point.
    pub(in crate::bundle) fn shorten_composite(&mut self, proposal: &Proposal) {
        let Some(composite) = &mut self.composite else { return };
        if let Some(excursion) = &mut composite.excursion {
            excursion.give_up();
        } else if proposal.origin == Origin::CompositeModel {
            composite.correcting = false;
            composite.learn(proposal, None, false);
        }
    }

    /// Moves the model to a new center. Without a Jacobian there, the model is silent until the center moves again.
    pub(in crate::bundle) fn rebase(&mut self, point: &Vector, value: f64, linearization: Option<Linearization>) {
        let known = self.outer.zip(linearization.as_ref());
        let reach = self.state.reach();
        self.state.output_scales = known.and_then(|(outer, known)| output_scales(outer, known, &reach));
        if let Some(composite) = &mut self.composite {
            composite.rejected = None;
            composite.base = linearization.map(|linearization| Base { point: point.clone(), value, linearization });
        }
    }
}

/// What outputs, their Jacobian and h tell about the scale of Θ; none where h gives no subgradient of the right size.
fn output_scales(outer: &dyn OuterFunction, known: &Linearization, reach: &Vector) -> Option<OutputScales> {
    let Linearization { outputs, jacobian, .. } = known;
    let weights = without_panic(|| outer.subgradient(outputs)).ok().filter(|w| w.len() == outputs.len())?;
    let sizes = jacobian.abs();
    let change = &sizes * reach;
    let rise = |sign: f64| outer.value(&(outputs + &change * sign)) - outer.value(outputs);
    // h need not be defined, or finite, on both sides.
    let known_rise = |sign: f64| without_panic(|| rise(sign)).ok().filter(|rise| rise.is_finite());
    let within_reach = [1.0, -1.0].into_iter().filter_map(known_rise).fold(0.0, f64::max);
    Some(OutputScales { slopes: sizes.tr_mul(&weights.abs()), within_reach })
}
