//! What the loop asks of whoever proposes trial points.
//!
//! ```text
//! propose   a trial point, or the end of the run with its proof, or nothing: the next proposer of the list is asked
//! learn     an evaluated trial point of any proposer, before the center moves;   update: afterwards
//! shorten   the oracle failed at a trial point
//! recenter  the center has been evaluated anew
//! ```

use super::proposal::Proposal;
use crate::Polyhedron;
use crate::bundle::config::{BundleTrustConfig, Convexity};
use crate::bundle::constrained::WorkingSet;
use crate::bundle::proof::Ending;
use crate::bundle::resolution::Resolution;
use crate::bundle::state::BundleState;
use crate::bundle::trial::Trial;
use crate::composite::{Linearization, OuterFunction};
use crate::qp::EpigraphQpSolver;
use std::borrow::Cow;

/// The answer of a proposer.
pub(crate) enum Answer {
    /// Nothing: the next proposer is asked.
    Silent,
    /// A trial point worth an evaluation.
    Trial(Box<Proposal>),
    /// The end of the run.
    End(Box<Ending>),
}

impl Answer {
    pub(crate) fn trial(proposal: Proposal) -> Self {
        Self::Trial(Box::new(proposal))
    }

    pub(crate) fn end(ending: Ending) -> Self {
        Self::End(Box::new(ending))
    }
}

/// The part of the run that a proposer reads and may change.
pub(crate) struct Position<'a> {
    pub state: &'a mut BundleState,
    pub set: &'a Polyhedron,
    /// The set with its linearized constraints, where there are nonlinear constraints.
    pub working: Option<&'a WorkingSet>,
    pub config: &'a BundleTrustConfig,
    pub solver: &'a mut EpigraphQpSolver,
    /// The convex function of a composite objective.
    pub outer: Option<&'a dyn OuterFunction>,
}

impl Position<'_> {
    /// The levels of small decreases at the present center.
    pub(crate) fn resolution(&self) -> Resolution {
        Resolution::new(self.state, self.config)
    }

    /// This run with another set.
    pub(crate) fn within<'b>(&'b mut self, working: &'b WorkingSet) -> Position<'b> {
        Position {
            state: &mut *self.state,
            set: &working.set,
            working: Some(working),
            config: self.config,
            solver: &mut *self.solver,
            outer: self.outer,
        }
    }

    /// The admissible set without linearized constraints.
    pub(crate) fn own_set(&self) -> Cow<'_, Polyhedron> {
        match self.working {
            Some(_) => Cow::Owned(self.set.with_tangents_kept(&[])),
            None => Cow::Borrowed(self.set),
        }
    }

    /// Whether cuts bound Θ on the feasible points from below wherever they were taken: the problem is declared convex,
    /// and no nonlinear constraint contradicts that.
    pub(crate) fn is_convex(&self) -> bool {
        self.config.convexity == Convexity::Convex && self.working.is_none_or(|working| working.convex)
    }

    /// Whether a step from a center that violates nonlinear constraints is short enough: as short as its predecessors
    /// have taught, or as the step that reduces the violation.
    pub(crate) fn trusts_restoring(&self, step_length: f64) -> bool {
        let known = self.working.zip(self.state.constraints.as_deref());
        known.is_none_or(|(working, known)| {
            step_length <= known.restoring.map_or(f64::INFINITY, |trust| trust.longest).max(2.0 * working.forced_length)
        })
    }

    /// Whether a constraint gives several pieces at the center.
    pub(crate) fn of_pieces(&self) -> bool {
        self.working.is_some_and(|working| working.of_pieces)
    }

    /// Whether the center violates nonlinear constraints.
    pub(crate) fn restoring(&self) -> bool {
        self.working.is_some_and(WorkingSet::restoring)
    }
}

/// A proposer of trial points.
pub(crate) trait Proposer {
    /// The next trial point, or the end of the run.
    fn propose(&mut self, at: &mut Position<'_>) -> Answer;

    /// Takes note of an evaluated trial point of any proposer; the center has not moved yet.
    fn learn(&mut self, at: &mut Position<'_>, trial: &Trial<'_>);

    /// Takes note of the same trial point once bundle and center have been updated.
    fn update(&mut self, _at: &mut Position<'_>, _trial: &Trial<'_>) {}

    /// Takes note that the oracle failed at a trial point of any proposer. Where the point was its own, a proposer
    /// takes a shorter step next, or pauses.
    fn shorten(&mut self, at: &mut Position<'_>, proposal: &Proposal);

    /// Takes note that a trial point of any proposer is known, so that its evaluation would tell nothing new.
    fn leave_known_point(&mut self, at: &mut Position<'_>, proposal: &Proposal) {
        self.shorten(at, proposal);
    }

    /// Takes note that the center has been evaluated, for the first time or anew, with its linearization if there is
    /// one.
    fn recenter(&mut self, _at: &mut Position<'_>, _linearization: Option<&Linearization>) {}

    /// The proof of the present center that has been found before, where the run goes on to look for something lower.
    fn standing_proof(&mut self) -> Option<Ending> {
        None
    }
}
