//! The composite model around a base point, and its subproblem, solved without evaluations of Θ.
//!
//! ```text
//! min over d   h(c + G d) + u‖d‖²/2,   x + d ∈ U
//! h smooth:    Newton's method, each step a quadratic program with Gᵀ∇²h G + u W, and a line search
//! of cones:    an interior-point method (cones.rs), judged by weak duality
//! else:        max_j h(c_j) + ⟨w_j, c + G d − c_j⟩ in place of h, cuts added until they meet h
//! w = Σ λ_j w_j:   Gᵀw + Aᵀμ + ν = −u W d,   error of w at c:  Σ λ_j (h(c) − h(c_j) − ⟨w_j, c − c_j⟩) ≥ 0
//! ```

#[cfg(feature = "interior-point")]
use super::cones::{self, ConeAnswer};
use crate::bundle::norm::{ScaledNorm, WeightedMetric};
#[cfg(feature = "interior-point")]
use crate::bundle::proposers::aggregate::slack_error;
use crate::bundle::proposers::proposal::SubproblemError;
use crate::bundle::proposers::subproblem::{self, Cuts};
#[cfg(feature = "interior-point")]
use crate::composite::Epigraph;
use crate::composite::{Linearization, OuterFunction};
use crate::interruption::interrupted;
#[cfg(feature = "interior-point")]
use crate::panics::without_panic;
use crate::qp::{EpigraphQpSolver, Metric, QpSolution, project};
use crate::{Matrix, Polyhedron, Vector};
use serde::{Deserialize, Serialize};

/// Largest number of Newton steps of one subproblem.
const MAX_NEWTON: usize = 100;
/// Largest number of cuts of h in one subproblem; with so many, the last step counts as the solution.
const MAX_CUTS: usize = 1000;
/// A subproblem counts as solved once a Newton step promises at most this share of the decrease so far.
const SOLVED: f64 = 1e-9;
/// The cuts of h meet h where the gap is at most this share of the promised decrease.
const MET: f64 = 1e-6;
/// Share of the promised decrease that the interior-point method may miss: a trial point needs no more accuracy, and a proof has a test
/// of its own.
#[cfg(feature = "interior-point")]
const MET_BY_CONES: f64 = 0.1;
/// Share of |h| that the method may miss besides: double precision does not take the method further where G is ill-conditioned.
#[cfg(feature = "interior-point")]
const LEFT_BY_CONES: f64 = 1e-10;
/// Rounding of h as a share of |h|.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// A cut above h by more than this share of the sizes of its terms is no rounding: h is not convex.
const MAX_EXCESS: f64 = 1e-9;
/// Largest number of halvings of a Newton step.
const MAX_HALVINGS: usize = 40;
/// Share of the promised decrease that a Newton step, shortened or not, must bring (Armijo's test).
const SUFFICIENT_DECREASE: f64 = 1e-4;

/// A subgradient of the outer function at some outputs, with its multiplier in an aggregate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct OuterCut {
    /// Outputs c_j, m entries.
    pub outputs: Vector,
    /// h(c_j), or ⟨w_j, c_j⟩ − h*(w_j) ≤ h(c_j).
    pub value: f64,
    /// w_j ∈ ∂h(c_j), m entries; where h is built from cones, any w_j with a finite conjugate h*(w_j).
    pub subgradient: Vector,
    /// λ_j ≥ 0; Σ λ_j = 1.
    pub multiplier: f64,
}

impl OuterCut {
    fn at(outer: &dyn OuterFunction, outputs: Vector) -> Result<Self, SubproblemError> {
        let (value, subgradient) = (outer.value(&outputs), outer.subgradient(&outputs));
        let (expected, found) = (outputs.len(), subgradient.len());
        if expected != found {
            return Err(SubproblemError::OuterSize { expected, found });
        }
        if !(value.is_finite() && subgradient.iter().all(|entry| entry.is_finite())) {
            return Err(SubproblemError::OuterNotFinite { at_base: false });
        }
        Ok(Self { value, subgradient, outputs, multiplier: 0.0 })
    }

    /// The linearization error h(c) − h(c_j) − ⟨w_j, c − c_j⟩ ≥ 0 at outputs c where h has the value given.
    pub fn error(&self, outputs: &Vector, value: f64) -> f64 {
        value - self.value - self.subgradient.dot(&(outputs - &self.outputs))
    }
}

/// The model at a base point.
pub(crate) struct CompositeModel<'a> {
    pub outer: &'a dyn OuterFunction,
    pub linearization: &'a Linearization,
    /// h(c) at the base.
    pub value: f64,
    pub base: &'a Vector,
    pub norm: &'a ScaledNorm,
    pub set: &'a Polyhedron,
    /// The weight u.
    pub weight: f64,
    /// B, the curvature of the outputs; none: 0.
    pub curvature: Option<&'a Matrix>,
    /// x̂ − x from the base to the point that ‖·‖ measures from; none: 0.
    pub origin: Option<&'a Vector>,
}

/// A solved subproblem.
#[derive(Debug, Clone)]
pub(crate) struct CompositeStep {
    pub step: Vector,
    /// h(c) − h(c + G d) − dᵀBd/2.
    pub decrease: f64,
    /// Cuts of h with a positive multiplier.
    pub cuts: Vec<OuterCut>,
    pub row_multipliers: Vector,
    pub bound_multipliers: Vector,
}

impl CompositeStep {
    /// w = Σ λ_j w_j.
    pub(crate) fn weights(&self) -> Vector {
        let mut cuts = self.cuts.iter();
        let first = cuts.next().map_or_else(|| Vector::zeros(0), |cut| &cut.subgradient * cut.multiplier);
        cuts.fold(first, |sum, cut| sum + &cut.subgradient * cut.multiplier)
    }
}

impl CompositeModel<'_> {
    pub(crate) fn solve(&self, solver: &mut EpigraphQpSolver) -> Result<CompositeStep, SubproblemError> {
        let Linearization { outputs, jacobian, .. } = self.linearization;
        solver.forget();
        match self.outer.curvature(outputs, jacobian) {
            Some(_) => self.solve_by_newton(solver),
            None => {
                #[cfg(feature = "interior-point")]
                if let Some(epigraph) = self.outer.epigraph() {
                    return self.solve_by_cones(solver, epigraph);
                }
                self.solve_by_cuts(solver, vec![])
            }
        }
    }

    /// The answer of the interior-point method where weak duality calls it good enough; otherwise the answer by cuts, beginning with
    /// those that the interior-point method has found.
    #[cfg(feature = "interior-point")]
    fn solve_by_cones(
        &self,
        solver: &mut EpigraphQpSolver,
        epigraph: Epigraph,
    ) -> Result<CompositeStep, SubproblemError> {
        // A failure of the interior-point method, even a panic, says nothing about h.
        let answer = without_panic(|| cones::solve(self, epigraph)).ok().flatten();
        let Some((ConeAnswer { weights, sides, .. }, point)) = answer
            .and_then(|answer| project(self.set, &(self.base + &answer.step)).ok().map(|point| (answer, point)))
            .filter(|(answer, _)| epigraph.conjugate(&answer.weights).is_finite())
        else {
            return self.solve_by_cuts(solver, vec![]);
        };
        let step = &point - self.base;
        let outputs = self.outputs(&step);
        let value = weights.dot(&outputs) - epigraph.conjugate(&weights);
        let cut = OuterCut { value, subgradient: weights, outputs, multiplier: 1.0 };
        self.error(&cut)?;
        let slope = self.linearization.jacobian.tr_mul(&cut.subgradient) + self.pull(&step);
        let residual = self.norm.dual_length(&(slope + self.set.rows().tr_mul(&sides.0) + &sides.1));
        // The optimum d' lies lower by at most what the residual ρ allows: ⟨ρ, d' − d⟩ + u‖d' − d‖²/2 ≥ −‖ρ‖*²/2u.
        let farthest = self.norm.length(&step).max(0.5 * residual / self.weight);
        let slack = slack_error((&sides.0, &sides.1), &point, self.set);
        let left = self.outer.value(&cut.outputs) - value + slack + residual * farthest;
        if left <= MET_BY_CONES * self.merit(&step).abs() + LEFT_BY_CONES * self.value.abs() {
            return Ok(self.solved(step, vec![cut], sides));
        }
        let there = OuterCut::at(self.outer, cut.outputs.clone())?;
        self.solve_by_cuts(solver, vec![cut, there])
    }

    /// B + u W.
    fn metric(&self) -> WeightedMetric {
        match self.curvature {
            Some(_) => WeightedMetric::Dense(self.with_metric(Matrix::zeros(self.base.len(), self.base.len()))),
            None => self.norm.weighted(self.weight),
        }
    }

    /// A matrix, and B + u W added to it.
    pub(super) fn with_metric(&self, mut matrix: Matrix) -> Matrix {
        self.norm.add_to(&mut matrix, self.weight);
        if let Some(curvature) = self.curvature {
            matrix += curvature;
        }
        matrix
    }

    /// c + G d.
    fn outputs(&self, step: &Vector) -> Vector {
        &self.linearization.outputs + &self.linearization.jacobian * step
    }

    /// h(c + G d) − h(c) + dᵀBd/2 + u(‖d − o‖² − ‖o‖²)/2 with the origin o.
    fn merit(&self, step: &Vector) -> f64 {
        let quadratic = self.bend(step) + self.weight * self.norm.squared(step);
        self.outer.value(&self.outputs(step)) - self.value + 0.5 * quadratic + self.pull_to_origin().dot(step)
    }

    /// −u W o.
    pub(super) fn pull_to_origin(&self) -> Vector {
        self.origin
            .map_or_else(|| Vector::zeros(self.base.len()), |origin| self.norm.lower_index(origin) * -self.weight)
    }

    /// dᵀBd.
    fn bend(&self, step: &Vector) -> f64 {
        self.curvature.map_or(0.0, |curvature| step.dot(&(curvature * step)))
    }

    /// (B + u W) d − u W o.
    fn pull(&self, step: &Vector) -> Vector {
        let pull = self.norm.lower_index(step) * self.weight + self.pull_to_origin();
        self.curvature.map_or(pull.clone(), |curvature| pull + curvature * step)
    }

    fn solve_by_newton(&self, solver: &mut EpigraphQpSolver) -> Result<CompositeStep, SubproblemError> {
        let jacobian = &self.linearization.jacobian;
        // Where the base lies outside the set, as before a closing step, the step of length 0 is not feasible.
        let mut step = project(self.set, self.base)? - self.base;
        let mut merit = self.merit(&step);
        for _ in 0..MAX_NEWTON {
            still_wanted()?;
            let at = OuterCut::at(self.outer, self.outputs(&step))?;
            self.error(&at)?;
            let Some(curvature) = self.outer.curvature(&at.outputs, jacobian) else { break };
            let metric = self.with_metric(curvature.clone());
            let slope = jacobian.tr_mul(&at.subgradient) + self.pull(&step);
            let (slopes, point) = ([slope], self.base + &step);
            let cuts = Cuts { slopes: &slopes, offsets: &[0.0], ids: &[0], gram: None };
            let solution = subproblem::solve(solver, self.set, &point, Metric::Dense(&metric), cuts)
                .map_err(|error| negative_curvature(curvature).unwrap_or_else(|| error.into()))?;
            let promised = -slopes[0].dot(&solution.step);
            if promised <= SOLVED * merit.abs() + ROUNDING * self.value.abs() {
                return Ok(self.solved(step, vec![OuterCut { multiplier: 1.0, ..at }], multipliers(&solution)));
            }
            let Some((next, lower)) = self.search(&step, &solution.step, merit, promised) else {
                return Ok(self.solved(step, vec![OuterCut { multiplier: 1.0, ..at }], multipliers(&solution)));
            };
            (step, merit) = (next, lower);
        }
        Err(SubproblemError::Unusable)
    }

    /// `from` plus `step`, which is halved until the merit falls enough, with the merit there; none where rounding hides any decrease.
    fn search(&self, from: &Vector, step: &Vector, merit: f64, promised: f64) -> Option<(Vector, f64)> {
        let mut length = 1.0;
        for _ in 0..MAX_HALVINGS {
            let trial = from + step * length;
            let value = self.merit(&trial);
            if value <= merit - SUFFICIENT_DECREASE * length * promised {
                return Some((trial, value));
            }
            length *= 0.5;
        }
        None
    }

    /// Solves the subproblem with cuts in place of h; `known` are cuts to begin with, besides that at the base.
    fn solve_by_cuts(
        &self,
        solver: &mut EpigraphQpSolver,
        known: Vec<OuterCut>,
    ) -> Result<CompositeStep, SubproblemError> {
        let linearization = self.linearization;
        let (metric, pull) = (self.metric(), self.pull_to_origin());
        let mut cuts = known;
        cuts.push(OuterCut::at(self.outer, linearization.outputs.clone()).map_err(SubproblemError::at_base)?);
        let (mut slopes, mut offsets, mut ids) = (vec![], vec![], vec![]);
        loop {
            still_wanted()?;
            for newest in &cuts[slopes.len()..] {
                slopes.push(linearization.jacobian.tr_mul(&newest.subgradient) + &pull);
                offsets.push(self.error(newest)?);
                ids.push(ids.len() as u64);
            }
            let view = Cuts { slopes: &slopes, offsets: &offsets, ids: &ids, gram: None };
            let solution = subproblem::solve(solver, self.set, self.base, metric.metric(), view)?;
            let next = OuterCut::at(self.outer, self.outputs(&solution.step))?;
            self.error(&next)?;
            let change = next.value - self.value + pull.dot(&solution.step);
            let (promised, gap) = (-solution.epigraph, change - solution.epigraph);
            if gap <= MET * promised.abs() + ROUNDING * self.value.abs() || cuts.len() >= MAX_CUTS {
                for (cut, multiplier) in cuts.iter_mut().zip(&solution.cut_multipliers) {
                    cut.multiplier = *multiplier;
                }
                cuts.retain(|cut| cut.multiplier > 0.0);
                return Ok(self.solved(solution.step.clone(), cuts, multipliers(&solution)));
            }
            cuts.push(next);
        }
    }

    /// The linearization error of a cut of h at the base. Fails if the cut lies above h at the base by more than rounding.
    fn error(&self, cut: &OuterCut) -> Result<f64, SubproblemError> {
        let outputs = &self.linearization.outputs;
        let error = cut.error(outputs, self.value);
        let terms = cut.subgradient.abs().dot(&(outputs.abs() + cut.outputs.abs()));
        let lies_below = error >= -MAX_EXCESS * (self.value.abs() + cut.value.abs() + terms);
        if !lies_below {
            return Err(SubproblemError::NotConvex { excess: -error });
        }
        Ok(error.max(0.0))
    }

    /// The solution at a step; `sides` are the multipliers of the rows and of the bounds.
    fn solved(&self, step: Vector, cuts: Vec<OuterCut>, sides: (Vector, Vector)) -> CompositeStep {
        let decrease = self.value - self.outer.value(&self.outputs(&step)) - 0.5 * self.bend(&step);
        CompositeStep { decrease, step, cuts, row_multipliers: sides.0, bound_multipliers: sides.1 }
    }
}

/// Fails where nobody waits for the answer any more.
fn still_wanted() -> Result<(), SubproblemError> {
    if interrupted() { Err(SubproblemError::Interrupted) } else { Ok(()) }
}

/// Multipliers of the rows and of the bounds.
fn multipliers(solution: &QpSolution) -> (Vector, Vector) {
    (Vector::from_column_slice(&solution.row_multipliers), Vector::from_column_slice(&solution.bound_multipliers))
}

/// The error of an outer function whose curvature has a negative eigenvalue that is no rounding.
fn negative_curvature(curvature: Matrix) -> Option<SubproblemError> {
    let finite = curvature.iter().all(|entry| entry.is_finite());
    let eigenvalues = finite.then(|| curvature.symmetric_eigenvalues())?;
    let eigenvalue = eigenvalues.min();
    (eigenvalue < -MAX_EXCESS * eigenvalues.amax()).then_some(SubproblemError::NegativeCurvature { eigenvalue })
}
