//! Plain model, curved model and exploration compete for the next evaluation.

use super::curvature::{
    CurvedModel, EXPLORATION, LARGEST_DIMENSION, Origin, Quadratic, WORTHWHILE, is_stalled, largest, seen_curvature,
};
use super::model::Model;
use super::run::Run;
use super::subproblem::{Proposal, solve_curved};
use super::weight::Comparison;
use crate::NonsmoothObjective;

impl<O: NonsmoothObjective> Run<'_, '_, O> {
    /// The proposal worth an evaluation, with what both models predict there.
    pub(super) fn compete(&mut self, plain: Proposal) -> Proposal {
        if self.state.center.len() > LARGEST_DIMENSION {
            return plain;
        }
        let before = self.solver.counts();
        let chosen = self.best_of(plain);
        self.count_solves(before);
        chosen
    }

    fn best_of(&mut self, plain: Proposal) -> Proposal {
        let model = Model::new(&mut self.state, &self.method.config);
        let curved = CurvedModel::new(&self.state, &model);
        let small = self.small();
        let mut chosen = plain.clone();
        if self.state.curvature.is_trusted() {
            let weight = self.state.curvature.weight;
            let answer = solve_curved(&mut self.solver, &self.set, &self.state, &curved, (&plain, weight));
            if let Ok(better) = answer
                && better.predicted_decrease > small
            {
                chosen = Proposal { origin: Origin::Curved, ..better };
            }
        }
        if self.state.curvature.may_explore()
            && is_stalled(&self.state, chosen.predicted_decrease)
            && let Some(exploration) = self.explore(&model, &plain, small.max(WORTHWHILE * chosen.predicted_decrease))
        {
            chosen = exploration;
        }
        self.state.curvature.count_down();
        let predicted = largest(&model.slopes, &model.offsets, &chosen.step);
        chosen.predictions = Some((predicted, curved.change(&chosen.step)));
        chosen
    }

    /// A trial far along directions in which no subgradient changes, if the cuts promise more than `worthwhile` there.
    fn explore(&mut self, model: &Model, plain: &Proposal, worthwhile: f64) -> Option<Proposal> {
        let quadratic = Quadratic::Common(seen_curvature(&self.state));
        let (slopes, offsets, ids) = (model.slopes.clone(), model.offsets.clone(), model.ids.clone());
        let metric = CurvedModel { quadratic, slopes, offsets, ids };
        let mut weight = self.state.curvature.exploration_weight.min(self.state.weight / EXPLORATION);
        for _ in 0..2 {
            if let Ok(far) = solve_curved(&mut self.solver, &self.set, &self.state, &metric, (plain, weight)) {
                let predicted_decrease = -largest(&model.slopes, &model.offsets, &far.step);
                if predicted_decrease > worthwhile {
                    return Some(Proposal { predicted_decrease, origin: Origin::Exploration, ..far });
                }
            }
            weight /= EXPLORATION;
        }
        None
    }

    /// Judges both models by what happened at the trial point, where that is known.
    pub(super) fn keep_record(&mut self, proposal: &Proposal, comparison: Option<&Comparison>, serious: bool) {
        let record = &mut self.state.curvature;
        if let (Some((plain, curved)), Some(comparison)) = (proposal.predictions, comparison) {
            record.compare(comparison.change, plain, curved);
        }
        match proposal.origin {
            Origin::Plain => {}
            Origin::Curved => record.after_curved(serious),
            Origin::Exploration => record.after_exploration(proposal.weight, serious),
        }
    }
}
