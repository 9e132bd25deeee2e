//! Steps from a center that violates constraints: the composite model weighs the violation that is left against the
//! objective, as an exact penalty does.
//!
//! ```text
//! min over d, s of  h(c + G d) + u‖d‖²/2 + dᵀB d/2 + ρ s,   c_j + ⟨h_j, d⟩ ≤ s        at its minimum Σ μ_j = ρ or s = 0
//! ```
//! s is found by a search on the sum of the multipliers μ, which falls as s rises. The penalty ρ is raised until the
//! step reduces the linearized violation by a good share of what a step of its length can ([ByrdNocedalWaltz2008],
//! steering rules).

use super::base::Base;
use super::steps::{Changes, Steps};
use crate::bundle::constrained::{ROOM, WorkingSet};
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::proposers::proposer::Position;
use crate::report::Termination;

/// Share of the possible reduction of the linearized violation that a step has to bring.
const SHARE: f64 = 0.6;
/// Factor by which the penalty is raised.
const RAISE: f64 = 4.0;
/// Penalties tried for one step.
const MAX_PENALTIES: usize = 30;
/// Violations tried for one penalty.
const MAX_TRIALS: usize = 8;
/// Two violations left are equal within this share of the reduction.
const SAME: f64 = 0.05;

/// A violation left with its step.
#[derive(Debug)]
struct Tried {
    left: f64,
    /// Σ |μ_j|; infinite without a step.
    multipliers: f64,
    proposal: Option<Proposal>,
}

/// The steps tried for one weight, by the violations that they leave.
struct Search<'s> {
    steps: &'s mut Steps,
    base: &'s Base,
    working: &'s WorkingSet,
    weight: f64,
    violation: f64,
    tried: Vec<Tried>,
}

impl Search<'_> {
    fn attempt(&mut self, at: &mut Position<'_>, left: f64) -> Result<(), Termination> {
        let set = self.working.leaving(left);
        let found = self.steps.step(&mut at.within(&set), self.base, self.weight, Changes::default())?;
        let proposal = found.map(|(proposal, _)| Proposal { leaves: Some(left), ..proposal });
        let multipliers = proposal.as_ref().map_or(f64::INFINITY, |own| self.working.multipliers(own));
        let place = self.tried.partition_point(|other| other.left < left);
        self.tried.insert(place, Tried { left, multipliers, proposal });
        Ok(())
    }

    /// The place of the least violation whose multipliers a penalty outweighs.
    fn outweighed(&self, penalty: f64) -> Option<usize> {
        self.tried.iter().position(|tried| tried.multipliers <= penalty)
    }

    /// Looks for the violation that a penalty leaves.
    fn refine(&mut self, at: &mut Position<'_>, penalty: f64) -> Result<(), Termination> {
        for _ in 0..MAX_TRIALS {
            let Some(place) = self.outweighed(penalty) else { return Ok(()) };
            let Some(before) = place.checked_sub(1) else { return Ok(()) };
            let (less, more) = (&self.tried[before], &self.tried[place]);
            let distance = more.left - less.left;
            if more.multipliers >= 0.5 * penalty || distance <= SAME * (self.violation - more.left) {
                return Ok(());
            }
            let share = match less.multipliers.is_finite() {
                true => (less.multipliers - 0.75 * penalty) / (less.multipliers - more.multipliers),
                false => 0.5,
            };
            let left = less.left + share.clamp(0.1, 0.9) * distance;
            self.attempt(at, left)?;
        }
        Ok(())
    }
}

/// The step for a weight of the composite model, with the penalty that it needs as that of the run; none where no
/// penalty makes it reduce the violation enough.
pub(super) fn elastic(
    steps: &mut Steps,
    at: &mut Position<'_>,
    base: &Base,
    weight: f64,
) -> Result<Option<Proposal>, Termination> {
    let Some(working) = at.working else { return Ok(None) };
    let (violation, known) = (at.state.violation(), at.state.constraints.as_ref());
    let mut penalty = known.map_or(1.0, |constraints| constraints.penalty);
    let mut search = Search { steps, base, working, weight, violation, tried: vec![] };
    search.attempt(at, ROOM * violation)?;
    if penalty == 0.0 {
        // Where the objective has no slope, the first multipliers give the penalty its unit.
        search.attempt(at, 0.5 * violation)?;
        let known = search.tried.iter().map(|tried| tried.multipliers).filter(|sum| sum.is_finite());
        penalty = known.fold(0.0, f64::max);
    }
    for _ in 0..MAX_PENALTIES {
        if search.tried.len() == 1 && search.outweighed(penalty).is_none() {
            search.attempt(at, violation)?;
        }
        search.refine(at, penalty)?;
        if let Some(place) = search.outweighed(penalty) {
            let Some(proposal) = &search.tried[place].proposal else { return Ok(None) };
            let reduced = violation - search.tried[place].left;
            if reduced >= SHARE * working.reducible(proposal.step_length) {
                if let Some(constraints) = &mut at.state.constraints {
                    constraints.penalty = penalty;
                }
                return Ok(Some(proposal.clone()));
            }
        }
        penalty *= RAISE;
    }
    Ok(None)
}
