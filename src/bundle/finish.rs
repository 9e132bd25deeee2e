//! The report at the end of a run.

use super::config::Convexity;
use super::constrained::{Constraints, Tangent};
use super::evidence::active_cuts;
use super::oracle::OracleResult;
use super::proof::Proof;
use super::proposers::proposal::Proposal;
use super::run::{Run, without_pattern};
use crate::report::{Certificate, ConstraintCut, ConstraintProof, Report, Termination};
use crate::{Accuracy, Vector};

/// The warning about a plateau.
const PLATEAU: &str =
    "plateau: the objective is constant around this point; it says nothing of other points, which may be lower";

impl Run<'_, '_> {
    /// Ends the run and returns its report; the termination is [`Termination::Unfinished`] if the run had not ended by
    /// itself.
    pub fn finish(mut self) -> Report {
        self.end_at_lowest();
        self.tell_violation();
        let plateau = self.is_plateau().then(|| PLATEAU.to_owned());
        let contradiction = self.rows.contradiction.map(|(row, by)| {
            format!(
                "row {row} of the admissible set depends on other rows and contradicts them by {by:.1e} of their sides, \
                 which counts as rounding"
            )
        });
        let warnings = plateau.into_iter().chain(contradiction).collect();
        let proof = match self.proof.take() {
            Some(proof) => Some(proof),
            None => self.ask(|proposers, at| proposers.plain_proof(at)),
        };
        let certificate = proof.map(|proof| self.certificate(&proof));
        let seconds = self.clock.elapsed().as_secs_f64();
        let multipliers =
            certificate.as_ref().and_then(|proof: &Certificate| Some(proof.constraints.as_ref()?.multipliers()));
        let state = self.state;
        let known = state.constraints.as_deref();
        let constraints = known.map(|known| known.report(known.at_center(), multipliers.as_ref())).unwrap_or_default();
        let penalty = known.map(|known| known.penalty);
        Report {
            solution: state.center,
            value: state.center_value,
            start_value: state.start_value,
            termination: self.termination.unwrap_or(Termination::Unfinished),
            certificate,
            constraints,
            penalty,
            counts: state.counts,
            largest_violation: state.history.iter().map(|record| record.violation).fold(0.0, f64::max),
            history: state.history,
            warnings,
            seconds,
        }
    }

    /// A run that ended by itself at a point that violates constraints says so. One that was ended from outside may
    /// have reached a better point later.
    fn tell_violation(&mut self) {
        let Some(constraints) = self.state.constraints.as_deref() else { return };
        let ended = matches!(
            self.termination,
            Some(
                Termination::Stationary { .. }
                    | Termination::StationaryUnconfirmed { .. }
                    | Termination::NoiseLimit { .. }
                    | Termination::StepTooShort { .. }
                    | Termination::DegenerateConstraints { .. }
            )
        );
        if ended && constraints.center_excess() > 1.0 {
            let (constraint, violation) = constraints.worst();
            let end = self.termination.take().map_or_else(String::new, |end| end.to_string());
            self.termination = Some(Termination::Violated { constraint, violation, end });
        }
    }

    /// Whether Θ is constant around a stationary center: value and vanishing subgradient are those of the points a
    /// first step away, both ways along a direction without pattern. At a smooth minimum the values differ. They are
    /// evaluated only where the run has seen no slope at all, or the same at another point: no minimum at a kink costs
    /// more for it.
    fn is_plateau(&mut self) -> bool {
        let vanishes = |subgradient: &Vector| subgradient.iter().all(|slope| *slope == 0.0);
        let (center, value) = (self.state.center.clone(), self.state.center_value);
        let is_equal = |other: f64| (other - value).abs() <= 4.0 * f64::EPSILON * value.abs();
        let confirmed = self.termination.as_ref().is_some_and(Termination::is_confirmed);
        let own = self.state.bundle.cut(self.state.center_id);
        if !confirmed || !own.is_some_and(|cut| vanishes(&cut.subgradient)) {
            return false;
        }
        let mut others = self.state.bundle.cuts().iter().filter(|cut| cut.point != center && !cut.certified);
        let twice = others.any(|cut| vanishes(&cut.subgradient) && is_equal(cut.value));
        if !twice && !vanishes(&self.state.seen.steepest) {
            return false;
        }
        let direction = Vector::from_fn(center.len(), |i, _| without_pattern(i));
        let direction = &direction * (self.state.first_step / self.state.norm.length(&direction));
        let set = self.rows.set.clone();
        let points = [direction.clone(), -direction].into_iter().map(|step| set.clamp_to_box(&(&center + step)));
        let points: Vec<Vector> = points.filter(|point| *point != center && set.violation(point) <= 0.0).collect();
        !points.is_empty()
            && points.into_iter().all(|point| {
                match self.evaluate(&point, Accuracy::TIGHTEST, None, f64::NEG_INFINITY) {
                    OracleResult::Answer(answer) => {
                        let found = answer.evaluation();
                        vanishes(&found.subgradient) && is_equal(found.value)
                    }
                    _ => false,
                }
            })
    }

    /// A run that ends with nothing to say about its center ends at the lowest point evaluated: a step that brings
    /// little of what the model promised is a null step, also where it lowers Θ.
    fn end_at_lowest(&mut self) {
        let about_center = matches!(
            self.termination,
            Some(
                Termination::Stationary { .. }
                    | Termination::StationaryUnconfirmed { .. }
                    | Termination::NoiseLimit { .. }
            )
        );
        let resolution = self.ask(|_, at| at.resolution().tolerance());
        let confirmed = self.termination.as_ref().is_some_and(Termination::is_confirmed);
        let moved = match &mut self.state.constraints {
            Some(constraints) => !confirmed && constraints.best_is_better(if about_center { resolution } else { 0.0 }),
            None => !about_center && self.state.move_to_lowest(),
        };
        if moved && self.state.constraints.is_some() {
            self.state.move_to_best();
        }
        if moved {
            self.proof = None;
            self.tell(|proposer, at| proposer.recenter(at, None));
        }
    }

    fn certificate(&mut self, proof: &Proof) -> Certificate {
        let mut certificate = proof.certificate(self.of_bundle(&proof.proposal));
        // As a later check computes them. Where the weight is small, the step tells them less accurately than the
        // multipliers do.
        if let Ok(check) = certificate.recheck(&self.rows.set) {
            (certificate.aggregate_norm, certificate.aggregate_error) = (check.aggregate_norm, check.aggregate_error);
        }
        certificate.row_multipliers = self.rows.whole_multipliers(&certificate.row_multipliers);
        certificate
    }

    fn of_bundle(&mut self, proposal: &Proposal) -> Certificate {
        let noise = self.ask(|_, at| at.resolution().noise_level);
        let state = &self.state;
        let radius = active_cuts(state, proposal).map(|cut| cut.farthest_from(&state.center, &state.norm));
        let constraints = state.constraints.as_deref().map(|known| constraint_proof(known, proposal));
        let of_constraints = constraints.iter().flat_map(|proof| &proof.cuts);
        let of_constraints = of_constraints.map(|cut| cut.distance(&state.center, &state.norm)).fold(0.0, f64::max);
        let own_rows = proposal.row_multipliers.len() - proposal.tangents.as_ref().map_or(0, |tangents| tangents.len());
        Certificate {
            point: state.center.clone(),
            value: state.center_value,
            error_bound: state.center_error_bound(),
            aggregate_norm: proposal.aggregate_norm,
            aggregate_error: proposal.aggregate_error,
            predicted_decrease: proposal.predicted_decrease,
            weight: proposal.weight,
            convexification: proposal.convexification,
            convex: self.method.config.convexity == Convexity::Convex,
            norm: state.norm.clone(),
            cuts: state.bundle.cuts().to_vec(),
            row_multipliers: proposal.row_multipliers.rows(0, own_rows).into_owned(),
            constraints,
            bound_multipliers: proposal.bound_multipliers.clone(),
            active_radius: radius.fold(of_constraints, f64::max),
            noise,
            composite: None,
        }
    }
}

/// The constraints in the certificate that rests on a proposal.
fn constraint_proof(known: &Constraints, proposal: &Proposal) -> ConstraintProof {
    let cut = |(tangent, multiplier): (&Tangent, f64)| ConstraintCut {
        constraint: tangent.constraint,
        point: (*tangent.point).clone(),
        value: tangent.value,
        subgradient: (*tangent.slope).clone(),
        multiplier: multiplier / known.unit(tangent.constraint),
    };
    ConstraintProof {
        kinds: known.kinds().to_vec(),
        values: known.at_center().clone(),
        sizes: known.sizes(),
        cuts: proposal.active_tangents().map(cut).collect(),
    }
}
