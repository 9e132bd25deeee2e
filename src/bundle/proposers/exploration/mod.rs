//! Exploration: far trial points along directions in which no subgradient changes.
//!
//! ```text
//! min over d   max_i { slope_i·d − offset_i } + ½ dᵀ(σ S + w W) d
//! S = Σ z zᵀ/⟨z, s⟩                           at least the curvature seen; none in directions in which no subgradient changed
//! σ ← σ/2 after a good exploration, 2σ ≤ 1 after another one
//! ```
//! s and z are the differences of points and subgradients between the other cuts and the center. When the promised decrease
//! has become tiny beside what the run has gained, one such trial looks along long flat valleys. Failures double the pause
//! before the next exploration.

pub(crate) mod config;

use super::pause::Pause;
use super::proposal::{Proposal, SubproblemError};
use super::proposer::{Position, Proposer, Trial};
use super::subproblem;
use crate::bundle::config::BundleTrustConfig;
use crate::bundle::state::State;
use crate::qp::Metric;
use crate::report::Origin;
use crate::{Matrix, Vector};
use config::ExplorationConfig;

/// Least share of S: with none, explorations overshoot in directions that no cut has shown.
const LEAST_SHARE: f64 = 1e-6;

/// Explorations of a run.
#[derive(Debug)]
pub(crate) struct Exploration {
    settings: ExplorationConfig,
    /// Weight added to S in the next exploration.
    weight: f64,
    /// The share σ of S in the next exploration.
    share: f64,
    pause: Pause,
}

impl Exploration {
    pub(crate) fn new(settings: ExplorationConfig, weight: f64) -> Self {
        Self { settings, weight, share: 1.0, pause: Pause::default() }
    }

    /// Whether the promised decrease is tiny beside what the run has gained per evaluation.
    fn is_stalled(&self, state: &State, predicted_decrease: f64) -> bool {
        let gained = state.start_value - state.center_value;
        predicted_decrease * (state.counts.evaluations as f64) < self.settings.stall_share * gained
    }

    /// The matrix S.
    fn seen_curvature(&self, state: &State) -> Matrix {
        let n = state.center.len();
        let mut matrix = Matrix::zeros(n, n);
        let Some(center) = state.bundle.cut(state.center_id) else { return matrix };
        for cut in state.bundle.cuts() {
            let s = &cut.point - &center.point;
            let z = &cut.subgradient - &center.subgradient;
            let least = self.settings.least_cosine * state.norm.dual_length(&z) * state.norm.length(&s);
            let along = z.dot(&s).max(least);
            if along > 0.0 {
                matrix.ger(1.0 / along, &z, &z, 1.0);
            }
        }
        // Rounding makes the sum of rank-one updates unsymmetric.
        (&matrix + matrix.transpose()) * 0.5
    }

    /// Lowers the share of S where an exploration has kept its promise, raises it otherwise.
    fn trust_curvature(&mut self, kept: bool) {
        let decrease = self.settings.metric_decrease;
        self.share = (self.share * if kept { decrease } else { 1.0 / decrease }).clamp(LEAST_SHARE, 1.0);
    }

    /// The trial point with one weight beside S, with the decrease that the plain cuts promise there.
    fn far(
        &self,
        at: &mut Position<'_>,
        plain: &Proposal,
        (seen, weight): (&Matrix, f64),
    ) -> Result<Proposal, SubproblemError> {
        let cuts = at.model.cuts();
        let mut metric = seen.clone();
        at.state.norm.add_to(&mut metric, weight);
        let step = subproblem::solve(at.solver, at.set, &at.state.center, Metric::Dense(&metric), cuts)?.step;
        let change = |step: &Vector| cuts.change(step) + 0.5 * step.dot(&(seen * step));
        let far = plain.replaced((step, weight, Origin::Exploration), (at.set, at.state), change)?;
        Ok(Proposal { predicted_decrease: -cuts.change(&far.step), ..far })
    }
}

impl Proposer for Exploration {
    fn propose(
        &mut self,
        at: &mut Position<'_>,
        proposed: &[Proposal],
        small: f64,
    ) -> Result<Option<Proposal>, SubproblemError> {
        let may_propose = self.pause.pass();
        let (Some(plain), Some(best)) = (proposed.first(), proposed.last()) else { return Ok(None) };
        if !may_propose || !self.is_stalled(at.state, best.predicted_decrease) {
            return Ok(None);
        }
        let worthwhile = small.max(self.settings.min_gain * best.predicted_decrease);
        let seen = self.seen_curvature(at.state) * self.share;
        let mut weight = self.weight.min(at.state.weight / self.settings.weight_factor);
        for _ in 0..self.settings.weights {
            if let Ok(far) = self.far(at, plain, (&seen, weight))
                && far.predicted_decrease > worthwhile
            {
                return Ok(Some(far));
            }
            weight /= self.settings.weight_factor;
        }
        Ok(None)
    }

    fn shorten(&mut self, _state: &mut State, _config: &BundleTrustConfig, proposal: &Proposal) {
        if proposal.origin == Origin::Exploration {
            self.weight = proposal.weight * self.settings.weight_factor;
            self.pause.fail(self.settings.max_pause);
            self.trust_curvature(false);
        }
    }

    fn learn(&mut self, state: &mut State, config: &BundleTrustConfig, trial: &Trial<'_>) {
        if trial.proposal.origin != Origin::Exploration {
            return;
        }
        if trial.serious {
            self.weight = trial.proposal.weight / self.settings.weight_factor;
            self.pause.succeed();
            self.trust_curvature(trial.comparison.is_good(config));
        } else {
            self.shorten(state, config, trial.proposal);
        }
    }
}
