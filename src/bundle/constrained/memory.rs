//! What a run has seen of its nonlinear constraints.

use super::tangent::Tangent;
use crate::bundle::norm::ScaledNorm;
use crate::bundle::step_trust::StepTrust;
use crate::report::ConstraintReport;
use crate::{ConstraintEvaluation, ConstraintKind, Matrix, Vector};
use std::rc::Rc;

/// A constraint is satisfied if its violation is at most this share of its size.
const TOLERANCE: f64 = 1e-10;
/// The rounding of a value c_j, as a share of Σ |h_i x_i|.
const ROUNDING: f64 = 2e-15;
/// Linearizations above a constraint by more than this share of the terms prove it nonconvex.
const CONVEX_SHARE: f64 = 1e-9;
/// Gradients of active constraints that cancel, or vanish, to this share are degenerate.
const DEGENERATE: f64 = 1e-6;
/// A gradient this many times shorter than that at a later center vanishes, and is no unit.
const VANISHING: f64 = 1e-6;
/// A penalty weight this many times larger than the multipliers ask for is lowered: it would reject steps along curved
/// constraints.
const MAX_PENALTY_SHARE: f64 = 4.0;
/// Tangents kept beside those of the center, and three for every variable.
const EXTRA_TANGENTS: usize = 50;

/// A point with all that its evaluation gave.
#[derive(Debug, Clone)]
struct Known {
    point: Rc<Vector>,
    objective: f64,
    evaluation: ConstraintEvaluation,
    /// The linearizations at the point.
    tangents: Vec<Tangent>,
}

/// A feasible point, or the least infeasible one.
#[derive(Debug, Clone)]
pub(crate) struct Best {
    pub point: Vector,
    pub objective: f64,
    pub evaluation: ConstraintEvaluation,
}

/// The nonlinear constraints of a run.
#[derive(Debug, Clone)]
pub(crate) struct Constraints {
    kinds: Vec<ConstraintKind>,
    /// σ_j; 0 as long as no gradient other than 0 has been seen.
    units: Vec<f64>,
    /// The largest |c_j|.
    largest: Vec<f64>,
    /// Whether linearizations prove c_j nonconvex.
    nonconvex: Vec<bool>,
    /// Σ σ_j |μ_j| of the last subproblem: how much the objective costs per unit of violation.
    pub sensitivity: f64,
    /// ρ.
    pub penalty: f64,
    /// v where ρ was last lowered. Half of it lets ρ fall again, so that it cannot rise and fall for ever.
    lowered_at: f64,
    /// How far steps are trusted that reduce the violation; none as long as none has failed.
    pub restoring: Option<StepTrust>,
    /// ‖g‖* of the objective at the start.
    pub objective_slope: f64,
    center: Known,
    newest: Option<Known>,
    /// The last trial point, if it has not become the center.
    rejected: Option<Known>,
    /// The center before.
    former: Option<Known>,
    /// Linearizations at other points, the oldest first.
    others: Vec<Tangent>,
    /// Length of the last step to a new center.
    last_step: f64,
    /// Objective and constraints at all points.
    visited: Vec<(f64, Vector)>,
    best: Best,
    /// Changes whenever a linearization comes or goes.
    revision: u64,
}

/// A point with the linearizations of its constraints.
fn known(point: &Vector, objective: f64, evaluation: &ConstraintEvaluation) -> Known {
    let shared = Rc::new(point.clone());
    let row = |j: usize| Tangent {
        constraint: j,
        point: Rc::clone(&shared),
        value: evaluation.values[j],
        slope: Rc::new(evaluation.jacobian.row(j).transpose()),
    };
    let mut tangents: Vec<Tangent> = (0..evaluation.values.len()).map(row).collect();
    for piece in &evaluation.pieces {
        let own = &tangents[piece.constraint];
        if own.value != piece.value || *own.slope != piece.gradient {
            tangents.push(Tangent {
                constraint: piece.constraint,
                point: Rc::clone(&shared),
                value: piece.value,
                slope: Rc::new(piece.gradient.clone()),
            });
        }
    }
    Known { point: shared, objective, evaluation: evaluation.clone(), tangents }
}

impl Constraints {
    /// The constraints at the start; `slope` is ‖g‖* of the objective there.
    pub(crate) fn new(
        kinds: &[ConstraintKind],
        point: &Vector,
        objective: f64,
        evaluation: &ConstraintEvaluation,
        norm: &ScaledNorm,
        slope: f64,
    ) -> Self {
        let center = known(point, objective, evaluation);
        let best = Best { point: point.clone(), objective, evaluation: evaluation.clone() };
        let count = kinds.len();
        let mut constraints = Self {
            kinds: kinds.to_vec(),
            units: vec![0.0; count],
            largest: vec![0.0; count],
            nonconvex: vec![false; count],
            penalty: slope,
            lowered_at: f64::INFINITY,
            sensitivity: 0.0,
            restoring: None,
            objective_slope: slope,
            center,
            newest: None,
            rejected: None,
            former: None,
            others: vec![],
            last_step: 0.0,
            visited: vec![],
            best,
            revision: 0,
        };
        constraints.look(objective, evaluation, norm);
        constraints.measure();
        constraints
    }

    /// Takes in the sizes of the constraints at the center. A trial point far away says nothing about them.
    fn measure(&mut self) {
        for (j, value) in self.center.evaluation.values.iter().enumerate() {
            self.largest[j] = self.largest[j].max(value.abs());
        }
    }

    /// Takes in an evaluation: units of constraints whose gradient has been zero so far, and the merit.
    fn look(&mut self, objective: f64, evaluation: &ConstraintEvaluation, norm: &ScaledNorm) {
        for j in 0..self.kinds.len() {
            if self.units[j] == 0.0 {
                self.units[j] = norm.dual_length(&evaluation.jacobian.row(j).transpose());
            }
        }
        self.visited.push((objective, evaluation.values.clone()));
    }

    /// Takes in an evaluation at a trial point.
    pub(crate) fn add(&mut self, point: &Vector, objective: f64, evaluation: &ConstraintEvaluation, norm: &ScaledNorm) {
        self.look(objective, evaluation, norm);
        let newest = known(point, objective, evaluation);
        let better = match (self.excess(&self.best.evaluation, &self.best.point), self.excess(evaluation, point)) {
            (old, new) if old <= 1.0 => new <= 1.0 && objective < self.best.objective,
            (old, new) => new < old,
        };
        if better {
            self.best = Best { point: point.clone(), objective, evaluation: evaluation.clone() };
        }
        self.newest = Some(newest);
    }

    /// The newest point becomes the center.
    pub(crate) fn move_center(&mut self, norm: &ScaledNorm) {
        let Some(newest) = self.newest.take() else { return };
        self.rejected = None;
        self.last_step = norm.length(&(&*newest.point - &*self.center.point));
        let old = std::mem::replace(&mut self.center, newest);
        self.measure();
        for (j, unit) in self.units.iter_mut().enumerate() {
            let length = norm.dual_length(&self.center.evaluation.jacobian.row(j).transpose());
            if *unit <= VANISHING * length {
                *unit = length;
            }
        }
        let violation = self.center_violation();
        if self.penalty > MAX_PENALTY_SHARE * self.sensitivity && violation <= 0.5 * self.lowered_at {
            self.penalty = (0.1 * self.penalty).max(2.0 * self.sensitivity);
            self.lowered_at = violation;
        }
        if self.last_step > 0.0 {
            self.keep(&old);
            self.former = Some(old);
        }
        self.prune(norm);
        self.revision += 1;
    }

    /// The newest point is no center: its linearizations are kept.
    pub(crate) fn reject(&mut self, norm: &ScaledNorm) {
        let Some(newest) = self.newest.take() else { return };
        self.keep(&newest);
        self.rejected = Some(newest);
        self.prune(norm);
        self.revision += 1;
    }

    /// Keeps the linearizations of inequalities at a point other than the center.
    fn keep(&mut self, other: &Known) {
        // Further pieces are worth their rows at the center only.
        let kept = other.tangents.iter().take(self.kinds.len()).filter(|t| match self.kinds[t.constraint] {
            ConstraintKind::Nonsmooth => true,
            ConstraintKind::Smooth => t.value > 0.0,
            ConstraintKind::SmoothEquality => false,
        });
        self.others.extend(kept.cloned());
    }

    /// Drops linearizations: of smooth nonconvex constraints those away from the center, then the oldest.
    fn prune(&mut self, norm: &ScaledNorm) {
        let center = &self.center.point;
        for t in &self.others {
            let error = self.center.evaluation.values[t.constraint] - t.at(center);
            let terms = t.slope.abs().dot(&(center.abs() + t.point.abs())) + t.value.abs();
            if error < -CONVEX_SHARE * terms {
                self.nonconvex[t.constraint] = true;
            }
        }
        let (near, center) = (2.0 * self.last_step, Rc::clone(center));
        let (nonconvex, kinds) = (&self.nonconvex, &self.kinds);
        let stays = |t: &Tangent| kinds[t.constraint] == ConstraintKind::Nonsmooth || !nonconvex[t.constraint];
        self.others.retain(|t| stays(t) || norm.length(&(&*t.point - &*center)) <= near);
        let most = EXTRA_TANGENTS + 3 * center.len();
        if self.others.len() > most {
            self.others.drain(..self.others.len() - most);
        }
    }

    /// Whether c_j is proved nonconvex, for every constraint.
    pub(crate) fn nonconvex(&self) -> &[bool] {
        &self.nonconvex
    }

    /// Changes whenever a linearization comes or goes.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// The kinds of the constraints.
    pub(crate) fn kinds(&self) -> &[ConstraintKind] {
        &self.kinds
    }

    /// σ_j; while only zero gradients have been seen, the largest |c_j|.
    pub(crate) fn unit(&self, j: usize) -> f64 {
        if self.units[j] > 0.0 { self.units[j] } else { self.largest[j] }
    }

    /// The linearizations at the center, and at other points.
    pub(crate) fn tangents(&self) -> (&[Tangent], &[Tangent]) {
        (&self.center.tangents, &self.others)
    }

    /// The linearizations at a point, if it is the last trial point and has not become the center.
    pub(crate) fn rejected_tangents(&self, point: &Vector) -> Option<&[Tangent]> {
        let known = self.rejected.as_ref().filter(|known| *known.point == *point)?;
        Some(&known.tangents)
    }

    /// The largest |c_j| at the centers.
    pub(crate) fn sizes(&self) -> Vector {
        Vector::from_column_slice(&self.largest)
    }

    /// The report of the constraints at a point, with the multipliers of its certificate.
    pub(crate) fn report(&self, values: &Vector, multipliers: Option<&Vector>) -> Vec<ConstraintReport> {
        let report = |j: usize| {
            let violation = self.kinds[j].violation(values[j]);
            ConstraintReport {
                kind: self.kinds[j],
                value: values[j],
                violation: if violation > 0.0 { violation / self.largest[j].max(violation) } else { 0.0 },
                satisfied: violation <= self.tolerance(j, &self.center.evaluation, &self.center.point),
                multiplier: multipliers.map_or(0.0, |multipliers| multipliers[j]),
            }
        };
        (0..self.kinds.len()).map(report).collect()
    }

    /// c_j at the center.
    pub(crate) fn at_center(&self) -> &Vector {
        &self.center.evaluation.values
    }

    /// The constraints at the center.
    pub(crate) fn center_evaluation(&self) -> &ConstraintEvaluation {
        &self.center.evaluation
    }

    /// The best point of the run: feasible and lowest, or the least infeasible one.
    pub(crate) fn best(&self) -> &Best {
        &self.best
    }

    /// Whether the best point is better than the center: feasible where the center is not, or feasible and lower by
    /// more than `small`.
    pub(crate) fn best_is_better(&self, small: f64) -> bool {
        let (own, best) = (self.center_excess(), self.excess(&self.best.evaluation, &self.best.point));
        if own <= 1.0 { best <= 1.0 && self.best.objective < self.center.objective - small } else { best < own }
    }

    /// Makes the best point the center.
    pub(crate) fn move_to_best(&mut self) {
        let Best { point, objective, evaluation } = &self.best;
        self.center = known(point, *objective, evaluation);
        self.revision += 1;
    }

    /// v for values of the constraints.
    pub(crate) fn violation(&self, values: &Vector) -> f64 {
        let relative = |j: usize| {
            let violation = self.kinds[j].violation(values[j]);
            if violation > 0.0 { violation / self.unit(j) } else { 0.0 }
        };
        (0..values.len()).map(relative).fold(0.0, f64::max)
    }

    /// The violation that counts as none. A start far away makes no violation small: what cancels in the linearization
    /// bounds the size that it is compared with.
    fn tolerance(&self, j: usize, evaluation: &ConstraintEvaluation, point: &Vector) -> f64 {
        let terms: f64 = evaluation.jacobian.row(j).iter().zip(point.iter()).map(|(h, x)| (h * x).abs()).sum();
        let largest = self.largest[j];
        let size = if terms > 0.0 { terms.min(largest) } else { largest };
        (TOLERANCE * size).max(ROUNDING * terms).max(f64::EPSILON * largest)
    }

    /// The largest violation in tolerances: the point is feasible up to 1.
    pub(crate) fn excess(&self, evaluation: &ConstraintEvaluation, point: &Vector) -> f64 {
        let relative = |j: usize| {
            let violation = self.kinds[j].violation(evaluation.values[j]);
            if violation > 0.0 { violation / self.tolerance(j, evaluation, point) } else { 0.0 }
        };
        (0..self.kinds.len()).map(relative).fold(0.0, f64::max)
    }

    /// The constraint whose violation at the center is largest in tolerances, and this violation.
    pub(crate) fn worst(&self) -> (usize, f64) {
        let Known { evaluation, point, .. } = &self.center;
        let violation = |j: usize| self.kinds[j].violation(evaluation.values[j]);
        let excess = |j: usize| violation(j) / self.tolerance(j, evaluation, point);
        let worst = (0..self.kinds.len()).max_by(|&i, &j| excess(i).total_cmp(&excess(j))).unwrap_or_default();
        (worst, violation(worst))
    }

    /// v at the center.
    pub(crate) fn center_violation(&self) -> f64 {
        self.violation(&self.center.evaluation.values)
    }

    /// The largest violation at the center in tolerances.
    pub(crate) fn center_excess(&self) -> f64 {
        self.excess(&self.center.evaluation, &self.center.point)
    }

    /// The highest merit P of the run less that of the center.
    pub(crate) fn merit_drop(&self) -> f64 {
        let merit = |(objective, values): &(f64, Vector)| objective + self.penalty * self.violation(values);
        let center = self.center.objective + self.penalty * self.center_violation();
        self.visited.iter().map(merit).fold(center, f64::max) - center
    }

    /// The Jacobian of the constraints at a point, if it is the center or the last trial point.
    pub(crate) fn jacobian_at(&self, point: &Vector) -> Option<&Matrix> {
        let at = |known: &&Known| *known.point == *point;
        let mut known = std::iter::once(&self.center).chain(&self.newest).chain(&self.rejected);
        Some(&known.find(at)?.evaluation.jacobian)
    }

    /// Whether constraints with multipliers μ_j are degenerate: their gradients all but cancel each other, or vanish at
    /// the center with all that they have changed on the last step.
    pub(crate) fn is_degenerate(&self, multipliers: &[f64], slope: f64, norm: &ScaledNorm, reach: f64) -> bool {
        let length = |known: &Known, j: usize| norm.dual_length(&known.evaluation.jacobian.row(j).transpose());
        let sum: f64 = (0..multipliers.len()).map(|j| multipliers[j].abs() * length(&self.center, j)).sum();
        let vanishes = |j: usize| {
            let Some(former) = self.former.as_ref().filter(|_| self.kinds[j] != ConstraintKind::Nonsmooth) else {
                return false;
            };
            let rows = [&self.center, former].map(|known| known.evaluation.jacobian.row(j));
            let change = norm.dual_length(&(rows[0] - rows[1]).transpose());
            let distance = norm.length(&(&*self.center.point - &*former.point));
            length(&self.center, j) * distance <= DEGENERATE * change * reach
        };
        sum > slope / DEGENERATE || (0..multipliers.len()).any(|j| multipliers[j] != 0.0 && vanishes(j))
    }

    /// Gives ρ a unit where the subgradient of the objective at the start is 0: that of the first point at which it is
    /// not, and as much as makes a step that reduces the violation a serious one. A constant objective has no unit; any
    /// ρ will do.
    pub(crate) fn learn_slope(&mut self, slope: f64, rise: f64, values: &Vector) {
        let drop = self.center_violation() - self.violation(values);
        self.objective_slope = slope;
        self.penalty = self.penalty.max(slope);
        if drop > 0.0 {
            self.penalty = self.penalty.max(2.0 * rise / drop);
            if self.penalty == 0.0 {
                self.penalty = 1.0;
            }
        }
    }

    /// Raises ρ above the sum of multipliers Σ σ_j |μ_j| of a subproblem.
    pub(crate) fn raise_penalty(&mut self, sum: f64, aggregate: f64) {
        // Where the violation forces a long step, its length drives the multipliers, in proportion to the weight.
        let slope = self.objective_slope;
        let sum = if slope > 0.0 { sum * slope / (slope + aggregate) } else { 0.0 };
        self.sensitivity = sum;
        if self.penalty < 1.1 * sum {
            self.penalty = 2.0 * sum;
        }
    }
}
