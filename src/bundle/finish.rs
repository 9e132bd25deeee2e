//! Records, observers, and the report at the end.

use super::event::Event;
use super::proposers::proposal::Proposal;
use super::run::Run;
use crate::Accuracy;
use crate::report::{Certificate, IterationRecord, Origin, Report, StepKind, Termination};
use std::ops::ControlFlow::{self, Break, Continue};

/// A decrease of Θ beyond this many times |Θ(x⁰)| + ‖g⁰‖·max(first step, 1) ends the run as unbounded below.
const UNBOUNDED_DECREASE: f64 = 1e12;
/// Next to zero, the first step may be a rounding, beside which every decrease is large. Lengths of 1 cost an unbounded run some steps more
/// and say nothing about bounded ones, whatever their units.
const LEAST_LENGTH: f64 = 1.0;

impl Run<'_, '_> {
    pub(super) fn record(&mut self, proposal: &Proposal, accuracy: Accuracy, event: Event) {
        let Event { kind, value, failure, noted, work } = event;
        let origin = if kind == StepKind::Refinement { Origin::Given } else { proposal.origin };
        self.state.counts.trials.add(origin);
        let mut record = IterationRecord {
            evaluation: self.state.counts.evaluations,
            kind,
            origin,
            value,
            center_value: self.state.center_value,
            predicted_decrease: proposal.predicted_decrease,
            aggregate_norm: proposal.aggregate_norm,
            aggregate_error: proposal.aggregate_error,
            weight: proposal.weight,
            step_length: proposal.step_length,
            violation: proposal.violation,
            cuts: self.state.bundle.cuts().len(),
            convexification: proposal.convexification,
            accuracy: accuracy.tolerance(),
            failure,
            jacobian: false,
            note: None,
            work,
            seconds: self.seconds(),
        };
        record.note(noted);
        self.state.history.push(record);
    }

    /// Calls the observers, and tests the stopping rules and divergence.
    pub(super) fn after_evaluation(&mut self) -> ControlFlow<Termination> {
        let Some(record) = self.state.history.last().cloned() else { return Continue(()) };
        let mut stop = false;
        for observer in &mut self.method.observers {
            stop |= observer.observe(&record).is_break();
        }
        if stop {
            return Break(Termination::StoppedByObserver);
        }
        if let Some(rule) = self.method.stop.as_ref().and_then(|rule| rule.holds(&self.state.history)) {
            return Break(Termination::StopRule { rule });
        }
        let slope = self.state.first_weight * self.state.first_step;
        let limit =
            UNBOUNDED_DECREASE * (self.state.start_value.abs() + slope * self.state.first_step.max(LEAST_LENGTH));
        if self.state.start_value - self.state.center_value > limit {
            return Break(Termination::UnboundedBelow);
        }
        Continue(())
    }

    /// Ends the run and returns its report; the termination is [`Termination::Unfinished`] if the run had not ended by itself.
    pub fn finish(mut self) -> Report {
        self.end_at_lowest();
        if self.proposal.is_none() && self.proof.is_none() {
            let _solved = self.try_subproblem();
        }
        let certificate = self.certificate();
        let seconds = self.seconds();
        let state = self.state;
        Report {
            solution: state.center,
            value: state.center_value,
            start_value: state.start_value,
            termination: self.termination.unwrap_or(Termination::Unfinished),
            certificate,
            counts: state.counts,
            largest_violation: state.history.iter().map(|record| record.violation).fold(0.0, f64::max),
            history: state.history,
            warnings: vec![],
            seconds,
        }
    }

    /// A run that ends with nothing to say about its center ends at the lowest point evaluated: a step that brings little of what the model
    /// promised is a null step, also where it lowers Θ.
    fn end_at_lowest(&mut self) {
        let about_center = matches!(
            self.termination,
            Some(
                Termination::Stationary { .. }
                    | Termination::StationaryUnconfirmed { .. }
                    | Termination::NoiseLimit { .. }
            )
        );
        let Some(lowest) = self.state.lowest.take().filter(|_| !about_center) else { return };
        let state = &mut self.state;
        if lowest.highest_value() >= state.center_value - state.center_error_bound() {
            return;
        }
        (state.center, state.center_value, state.center_id) = (lowest.point.clone(), lowest.value, lowest.id);
        if state.bundle.cut(lowest.id).is_none() {
            state.bundle.push(lowest, &state.norm);
        }
        self.forget_model();
        let (point, value) = (self.state.center.clone(), self.state.center_value);
        self.rebase(&point, value, None);
    }

    fn certificate(&self) -> Option<Certificate> {
        let mut certificate = match &self.proof {
            Some(proof) => proof.certificate(self.certificate_of(&proof.proposal)),
            None => self.certificate_of(self.proposal.as_ref()?),
        };
        // As a later check computes them. Where the weight is small, the step tells them less accurately than the multipliers do.
        if let Ok(check) = certificate.recheck(&self.set) {
            (certificate.aggregate_norm, certificate.aggregate_error) = (check.aggregate_norm, check.aggregate_error);
        }
        Some(certificate)
    }

    fn certificate_of(&self, proposal: &Proposal) -> Certificate {
        Certificate {
            point: self.state.center.clone(),
            value: self.state.center_value,
            error_bound: self.state.center_error_bound(),
            aggregate_norm: proposal.aggregate_norm,
            aggregate_error: proposal.aggregate_error,
            predicted_decrease: proposal.predicted_decrease,
            weight: proposal.weight,
            convexification: proposal.convexification,
            convex: self.is_declared_convex(),
            norm: self.state.norm.clone(),
            cuts: self.state.bundle.cuts().to_vec(),
            row_multipliers: proposal.row_multipliers.clone(),
            bound_multipliers: proposal.bound_multipliers.clone(),
            active_radius: self.active_radius(proposal),
            noise: self.noise_level(),
            composite: None,
        }
    }
}
