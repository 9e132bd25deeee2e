//! The verdict on a center: evidence in, termination out. No other file decides that a point is stationary.
//!
//! ```text
//! exact        subgradients of the center and the normal cone cancel to rounding                 confirmed
//! undecided    along some variable the aggregate subgradient has not cancelled                   go on, or unconfirmed
//! remaining    ẽ + Σ |z̃_i| reach_i small beside the wanted decrease, active cuts near, or Θ declared convex          confirmed
//! noise        noise or rounding hides what remains                                              noise limit
//! ```
//! A small aggregate error alone proves nothing, nor does a small predicted decrease: both are small for a variable
//! whose unit hides it.

use super::evidence::Evidence;
use super::proposers::proposal::Proposal;
use super::proposers::proposer::Position;
use super::resolution::Resolution;
use crate::report::Termination;

/// What may be left within reach at a confirmed end, in wanted decreases: a decrease that is small at a step of a
/// hundredth of the variables is at most 100 times as large within reach. With 10, smooth minima end unconfirmed.
const MAX_REMAINING_DECREASES: f64 = 100.0;

/// The slopes next to a center may lead as far down, over the reach of the variables, as this share of Θ and of the
/// decrease of the run: the curvature of Θ bounds what is left. Valleys that are flat over large distances leave more.
const MAX_SLOPE_SHARE: f64 = 1e-3;

/// Where subgradients cancel next to a center, rounding may be this share of what cancels within reach: curved valleys
/// whose curvature rounding hides look like kinks from 1e-9 on.
const MAX_ROUNDING_SHARE: f64 = 1e-11;

/// The classification of the evidence at a center.
pub(crate) enum Verdict {
    /// The run may end.
    End(Termination),
    /// Stationary but for active cuts away from the center.
    Far,
    /// Too much is left, or a variable is undecided.
    Open,
}

/// Classifies the evidence that a subproblem gives.
pub(crate) fn verdict(at: &Position<'_>, evidence: &Evidence) -> Verdict {
    match judged(at, evidence) {
        Verdict::End(termination) if termination.is_confirmed() && evidence.degenerate => {
            Verdict::End(Termination::DegenerateConstraints { radius: evidence.radius })
        }
        verdict => verdict,
    }
}

/// The verdict as if the constraints were not degenerate.
fn judged(at: &Position<'_>, evidence: &Evidence) -> Verdict {
    if at.restoring() {
        return Verdict::Open;
    }
    let resolution = at.resolution();
    let convex = at.is_convex();
    let confirmed = || Termination::Stationary { radius: evidence.radius, gap: convex.then(|| evidence.gap()) };
    if evidence.is_exact(resolution.tolerance()) {
        return Verdict::End(match resolution.noise() {
            Some(noise) if !evidence.of_outputs => Termination::NoiseLimit { estimate: noise },
            _ => confirmed(),
        });
    }
    let allowed = allowed(&resolution, convex);
    if evidence.undecided(allowed).is_some() {
        return Verdict::Open;
    }
    let remaining = if convex { evidence.gap() } else { evidence.remaining() };
    if let Some(noise) = resolution.noise() {
        let hidden = !convex || remaining <= resolution.hidden_by_noise();
        return if hidden && remaining.is_finite() {
            Verdict::End(Termination::NoiseLimit { estimate: noise.max(remaining) })
        } else {
            Verdict::Open
        };
    }
    if remaining > allowed {
        Verdict::Open
    } else if !convex && evidence.distance > near(&resolution) {
        Verdict::Far
    } else if resolution.rounding > 10.0 * resolution.wanted {
        Verdict::End(Termination::NoiseLimit { estimate: resolution.rounding.max(remaining) })
    } else {
        Verdict::End(confirmed())
    }
}

/// The classification of a center, which all cuts together call stationary, by the cuts next to it.
pub(crate) enum Near {
    /// The cuts next to the center promise as little as all cuts.
    Confirmed,
    /// Those cuts promise more, although their subgradients nearly cancel: only the curvature of Θ, which cuts do not
    /// show, bounds what is left.
    Falls,
    /// The subgradients of those cuts do not cancel.
    Open,
}

/// Classifies the cuts next to a center by their subproblem at the weight of the run.
pub(crate) fn near_verdict(
    center_value: f64,
    resolution: &Resolution,
    evidence: &Evidence,
    proposal: &Proposal,
) -> Near {
    let remaining = evidence.remaining();
    let hidden = resolution.noise().is_some() || resolution.rounding > 10.0 * resolution.wanted;
    let least = evidence.drop.min(center_value.abs());
    let resolved = resolution.noise().is_none() && resolution.rounding <= MAX_ROUNDING_SHARE * evidence.cancelling();
    if resolved
        && evidence.cancels()
        && evidence.error <= resolution.negligible()
        && evidence.distance <= near(resolution)
    {
        Near::Confirmed
    } else if hidden
        || evidence.undecided(resolution.small()).is_some()
        || remaining > MAX_SLOPE_SHARE * least + near(resolution)
    {
        Near::Open
    } else if proposal.predicted_decrease > near(resolution) || remaining > allowed(resolution, false) {
        Near::Falls
    } else {
        Near::Confirmed
    }
}

/// The confirmed end by cuts next to the center.
pub(crate) fn confirmed(near: &Evidence) -> Termination {
    Termination::Stationary { radius: near.radius, gap: None }
}

/// The distance, in units of Θ, up to which a cut lies next to the center: Θ varies by no more in between than what may
/// be left.
pub(crate) fn near(resolution: &Resolution) -> f64 {
    10.0 * resolution.small()
}

/// What may be left within reach, what rounding hides included. Where Θ is declared convex, it is a bound, and five
/// wanted decreases.
pub(crate) fn allowed(resolution: &Resolution, convex: bool) -> f64 {
    let decreases = if convex { 5.0 } else { MAX_REMAINING_DECREASES };
    decreases * resolution.wanted + resolution.rounding
}

/// Why a run ends whose predicted decrease stays small although the evidence does not suffice.
pub(crate) fn unconfirmed(at: &Position<'_>, evidence: &Evidence) -> Termination {
    let allowed = allowed(&at.resolution(), at.is_convex());
    Termination::StationaryUnconfirmed { radius: evidence.radius, undecided: evidence.undecided(allowed) }
}

/// Why a run ends at a step that does not change the variables although the model promises a decrease.
pub(crate) fn too_short(at: &Position<'_>, proposal: &Proposal) -> Termination {
    let evidence = Evidence::new(at.state, at.set, proposal);
    let resolution = at.resolution();
    match verdict(at, &evidence) {
        Verdict::End(termination) => termination,
        _ if resolution.noise_level > 0.0 => {
            Termination::NoiseLimit { estimate: resolution.noise_level.max(evidence.remaining()) }
        }
        Verdict::Far => unconfirmed(at, &evidence),
        Verdict::Open if proposal.predicted_decrease <= resolution.tolerance() => unconfirmed(at, &evidence),
        Verdict::Open => Termination::StepTooShort { predicted_decrease: proposal.predicted_decrease },
    }
}

/// Why a run ends whose admissible set is a single point: the normal cone there is everything.
pub(crate) fn only_point(at: &Position<'_>) -> Termination {
    if !at.state.is_feasible() {
        return Termination::Infeasible { violation: at.state.violation() };
    }
    let resolution = at.resolution();
    match resolution.noise() {
        Some(noise) => Termination::NoiseLimit { estimate: noise },
        None => Termination::Stationary { radius: 0.0, gap: at.is_convex().then_some(0.0) },
    }
}
