//! What a run keeps of its composite model from step to step.

use super::base::Base;
use super::curvature::Memory;
use super::kinks::Kinks;
use super::proof::Proof;
use crate::bundle::proposers::pause::Pause;
use crate::composite::LinearizationRequest;
use crate::{Accuracy, Vector};

/// The first weight, relative to the first weight of the cuts.
const FIRST_WEIGHT: f64 = 1e-2;
/// Factor by which the weight falls or rises.
pub(super) const FACTOR: f64 = 10.0;
/// Relative accuracy asked of a Jacobian.
const JACOBIAN_ACCURACY: f64 = 1e-4;

/// The composite model of a run.
#[derive(Debug)]
pub(crate) struct Composite {
    pub(super) weight: f64,
    /// Length that the next step must not exceed, after a rejected one.
    pub(super) longest: f64,
    pub(super) pause: Pause,
    pub(super) failures: usize,
    /// Where the model is built: the center, if its Jacobian is known.
    pub(super) base: Option<Base>,
    /// A rejected trial point with its Jacobian.
    pub(super) rejected: Option<Base>,
    /// Whether the pending trial point is a correction.
    pub(super) correcting: bool,
    /// Whether the model takes the curvature of the outputs into account: once a step and its correction have failed without it.
    pub(super) bends: bool,
    /// The share of the curvature of the outputs that steps have confirmed, at most 1.
    pub(super) bend: f64,
    /// Whether the last subproblem took the curvature of the outputs into account.
    pub(super) bent: bool,
    /// Serious steps in a row that have met less curvature of the outputs than predicted.
    pub(super) straight: usize,
    pub(super) memory: Memory,
    pub(super) kinks: Kinks,
    /// Weights of the outputs at the last subproblem's solution.
    pub(super) weights: Option<Vector>,
    pub(super) excursion: Option<Excursion>,
    /// Whether the center is the end of a last step that has brought a small decrease only.
    pub(super) polished: bool,
}

/// A run away from a stationary center.
#[derive(Debug)]
pub(crate) struct Excursion {
    pub(super) proof: Box<Proof>,
    /// Whether the pending step is the model's own last step, before the closing step.
    pub(super) last_step: bool,
    /// Where the model of the excursion is built; none before the first evaluation.
    pub(super) base: Option<Base>,
    pub(super) weight: f64,
    /// Evaluations left.
    pub(super) left: usize,
}

impl Excursion {
    pub(super) fn give_up(&mut self) {
        self.left = 0;
    }
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
