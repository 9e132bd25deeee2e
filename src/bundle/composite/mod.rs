//! The composite model as a proposer: trial points from h exact and c linear, as long as that pays.
//!
//! ```text
//! predicted = h(c) − h(c + G d),   ratio = (Θ(x) − Θ(x + d))/predicted:   u falls if it is at least 0.5, rises after a rejected step
//! predicted small at small u:      stationary, proved by w ∈ ∂h and G at x alone                       radius 0
//! ```
//! One linearization is pessimistic where a constraint becomes active inside c, so that ratios above 1 are common. A rejected
//! step is corrected from the model at its end. Where the correction fails too, the subproblem takes the curvature of the outputs
//! that earlier Jacobians show. After repeated failures, and as soon as a step fails on kinks of c, the model pauses, and cuts,
//! curved model and exploration go on.

#[cfg(feature = "interior-point")]
mod cones;
mod curvature;
mod excursion;
mod kinks;
mod learning;
mod model;
mod proof;
mod step;

use super::proposers::pause::Pause;
use super::proposers::proposal::Proposal;
use super::run::Run;
use crate::composite::{Linearization, LinearizationRequest};
use crate::report::Termination;
use crate::{Accuracy, Vector};
use curvature::Memory;
use excursion::Excursion;
use kinks::Kinks;
use learning::MAX_PAUSE;
use std::ops::ControlFlow::{self, Continue};

pub(crate) use model::CompositeStep;
pub use model::OuterCut;
pub(crate) use proof::Proof;

/// The first weight, relative to the first weight of the cuts.
const FIRST_WEIGHT: f64 = 1e-2;
/// Factor by which the weight falls or rises.
const FACTOR: f64 = 10.0;
/// Weights tried, upwards and downwards, for one trial point.
const MAX_WEIGHTS: usize = 20;
/// A small predicted decrease that grows by less than this factor as the weight falls does not depend on the weight any more.
const LEAST_GAIN: f64 = 1.1;
/// Relative accuracy asked of a Jacobian.
const JACOBIAN_ACCURACY: f64 = 1e-4;

/// The composite model of a run.
#[derive(Debug)]
pub(crate) struct Composite {
    weight: f64,
    /// Length that the next step must not exceed, after a rejected one.
    longest: f64,
    pause: Pause,
    failures: usize,
    /// Where the model is built: the center, if its Jacobian is known.
    base: Option<Base>,
    /// A rejected trial point with its Jacobian.
    rejected: Option<Base>,
    /// Whether the pending trial point is a correction.
    correcting: bool,
    /// Whether the model takes the curvature of the outputs into account: once a step and its correction have failed without it.
    bends: bool,
    /// The share of the curvature of the outputs that steps have confirmed, at most 1.
    bend: f64,
    /// Whether the last subproblem took the curvature of the outputs into account.
    bent: bool,
    /// Serious steps in a row that have met less curvature of the outputs than predicted.
    straight: usize,
    memory: Memory,
    kinks: Kinks,
    /// Weights of the outputs at the last subproblem's solution.
    weights: Option<Vector>,
    excursion: Option<Excursion>,
    /// Whether the center is the end of a last step that has brought a small decrease only.
    polished: bool,
}

/// Where the model is built.
#[derive(Debug, Clone)]
pub(crate) struct Base {
    pub point: Vector,
    pub value: f64,
    pub linearization: Linearization,
}

impl Composite {
    pub(crate) fn new(first_weight: f64) -> Self {
        Self {
            weight: FIRST_WEIGHT * first_weight,
            longest: f64::INFINITY,
            pause: Pause::default(),
            failures: 0,
            base: None,
            rejected: None,
            correcting: false,
            bends: false,
            bend: 1.0,
            bent: false,
            straight: 0,
            memory: Memory::default(),
            kinks: Kinks::default(),
            weights: None,
            excursion: None,
            polished: false,
        }
    }

    /// What to ask of an evaluation; `below` is the value of Θ up to which a Jacobian is wanted.
    pub(crate) fn request(below: f64) -> LinearizationRequest {
        let accuracy = Accuracy::relative(JACOBIAN_ACCURACY).unwrap_or(Accuracy::TIGHTEST);
        LinearizationRequest { accuracy, below }
    }
}

impl Run<'_, '_> {
    /// The trial point of the composite model, or none where the model is silent. Ends the run at a point that the model proves stationary.
    pub(super) fn composite_trial(&mut self) -> ControlFlow<Termination, Option<Proposal>> {
        let Some(composite) = &mut self.composite else { return Continue(None) };
        if let Some(excursion) = composite.excursion.take() {
            return self.continue_excursion(excursion);
        }
        let Some(base) = composite.base.clone().filter(|_| composite.pause.pass()) else { return Continue(None) };
        let least = self.state.first_weight / self.method.config.weight_range;
        let mut weight = composite.weight.max(least);
        if let Some(rejected) = composite.rejected.take() {
            if let Some(proposal) = self.correction(&base, &rejected)? {
                return Continue(Some(proposal));
            }
            if let Some(composite) = &mut self.composite {
                composite.bends = true;
            }
        }
        let (mut raised, mut last) = (false, None::<Proposal>);
        for _ in 0..MAX_WEIGHTS {
            let Some((proposal, step)) = self.composite_step(&base, weight, None, None)? else {
                (weight, raised) = (weight * FACTOR, true);
                continue;
            };
            if let Some(word) = self.composite_word(&proposal) {
                return self.leave(Proof { word, base, step, proposal: proposal.clone() }, proposal);
            }
            let longest = self.composite.as_ref().map_or(0.0, |composite| composite.longest);
            if proposal.predicted_decrease > self.small() {
                if proposal.step_length <= longest {
                    return Continue(Some(proposal));
                }
                (weight, raised) = (weight * FACTOR, true);
                continue;
            }
            weight /= FACTOR;
            let exhausted = last.is_some_and(|last| proposal.predicted_decrease < LEAST_GAIN * last.predicted_decrease);
            if raised || exhausted {
                // No step that has not been rejected promises more. What is small already may be proved to be all that is left.
                if let Some(proof) = self.lighter_proof(&base, weight)? {
                    return self.leave(proof, proposal);
                }
                return Continue(self.small_step(proposal).filter(|_| !raised));
            }
            last = Some(proposal);
        }
        Continue(None)
    }

    /// A step that promises little: the model may prove the point at its end stationary. None within a limit of length, where a longer step
    /// has been rejected: the cuts go on.
    fn small_step(&mut self, proposal: Proposal) -> Option<Proposal> {
        let composite = self.composite.as_mut()?;
        if composite.longest < f64::INFINITY {
            composite.pause.fail(MAX_PAUSE);
            return None;
        }
        Some(proposal).filter(|proposal| proposal.predicted_decrease > self.state.rounding())
    }
}
