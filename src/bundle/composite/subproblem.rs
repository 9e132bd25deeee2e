//! The subproblem of the composite model, solved without evaluations of Θ.
//!
//! ```text
//! min over d   h(c + G d) + u‖d‖²/2,   x + d ∈ U
//! h smooth:    Newton's method, each step a quadratic program with Gᵀ∇²h G + u W, and a line search
//! h = max h_k: with smooth h_k, each step a quadratic program with all of them and Σ λ_k Gᵀ∇²h_k G + u W
//! of cones:    an interior-point method (cones.rs), checked by weak duality
//! else:        max_j h(c_j) + ⟨w_j, c + G d − c_j⟩ in place of h, cuts added until they meet h
//! w = Σ λ_j w_j:   Gᵀw + Aᵀμ + ν = −u W d,   error of w at c:  Σ λ_j (h(c) − h(c_j) − ⟨w_j, c − c_j⟩) ≥ 0
//! ```

#[cfg(feature = "interior-point")]
use super::cones;
use super::model::{CompositeModel, CompositeStep, MAX_EXCESS, OuterCut};
#[cfg(feature = "interior-point")]
use super::scaled_program::ConeAnswer;
use crate::bundle::cut::MAX_RELATIVE_SLOPE;
#[cfg(feature = "interior-point")]
use crate::bundle::proposers::aggregate::slack_error;
use crate::bundle::proposers::proposal::SubproblemError;
use crate::bundle::proposers::subproblem::{self, Cuts};
#[cfg(feature = "interior-point")]
use crate::composite::Epigraph;
use crate::interruption::interrupted;
#[cfg(feature = "interior-point")]
use crate::panics::without_panic;
use crate::qp::{EpigraphQpSolver, Metric, QpSolution, project};
use crate::{Matrix, Vector};

/// Largest number of Newton steps of one subproblem.
const MAX_NEWTON: usize = 100;
/// Largest number of cuts of h in one subproblem; with so many, the last step counts as the solution.
const MAX_CUTS: usize = 1000;
/// Number of variables up to which cuts take over what the interior-point method has not solved accurately. With more,
/// they need far longer; its answer is a trial point like any other, and a proof has a test of its own.
#[cfg(feature = "interior-point")]
const MAX_VARIABLES_OF_CUTS: usize = 50;
/// A subproblem counts as solved once a Newton step promises at most this share of the decrease so far.
const SOLVED: f64 = 1e-9;
/// The cuts of h meet h where the gap is at most this share of the promised decrease.
const MET: f64 = 1e-6;
/// Share of the promised decrease that the interior-point method may miss: a trial point needs no more accuracy, and a
/// proof has a test of its own.
#[cfg(feature = "interior-point")]
const MET_BY_CONES: f64 = 0.1;
/// Share of |h| that the method may miss besides: double precision does not take the method further where G is
/// ill-conditioned.
#[cfg(feature = "interior-point")]
const LEFT_BY_CONES: f64 = 1e-10;
/// Rounding of h as a share of |h|.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Largest number of halvings of a Newton step.
const MAX_HALVINGS: usize = 40;
/// Share of the promised decrease that a Newton step, shortened or not, must bring (Armijo's test).
const SUFFICIENT_DECREASE: f64 = 1e-4;

impl CompositeModel<'_> {
    pub(crate) fn solve(&self, solver: &mut EpigraphQpSolver) -> Result<CompositeStep, SubproblemError> {
        let outputs = &self.linearization.outputs;
        solver.forget();
        let parts = self.outer.parts(outputs).len();
        match self.curvature(outputs, &vec![1.0 / parts as f64; parts]) {
            Some(_) if parts == 0 => self.solve_by_newton(solver),
            // Steps may become too short along a curved edge of h.
            Some(_) => self.solve_by_newton(solver).or_else(|error| match error {
                SubproblemError::Unusable => self.solve_by_cuts(solver, vec![]),
                error => Err(error),
            }),
            None => {
                #[cfg(feature = "interior-point")]
                if let Some(epigraph) = self.outer.epigraph(outputs.len()).filter(|epigraph| !epigraph.is_maximum()) {
                    return self.solve_by_cones(solver, &epigraph);
                }
                self.solve_by_cuts(solver, vec![])
            }
        }
    }

    /// The answer of the interior-point method where weak duality calls it good enough; otherwise the answer by cuts,
    /// beginning with those that the interior-point method has found.
    #[cfg(feature = "interior-point")]
    fn solve_by_cones(
        &self,
        solver: &mut EpigraphQpSolver,
        epigraph: &Epigraph,
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
        let (here, there) = (self.linearization.outputs.clone(), self.outputs(&step));
        let conjugate = epigraph.conjugate(&weights);
        // By the conjugate, w is a cut of h at any outputs; at those of the base, its error carries no rounding of
        // larger numbers.
        let value = weights.dot(&here) - conjugate;
        let missed = self.outer.value(&there) - (weights.dot(&there) - conjugate);
        let cut = OuterCut { value, subgradient: weights, outputs: here, multiplier: 1.0 };
        self.error(&cut)?;
        let slope = self.linearization.jacobian.tr_mul(&cut.subgradient) + self.pull(&step);
        let residual = self.norm.dual_length(&(slope + self.set.rows().tr_mul(&sides.0) + &sides.1));
        // The optimum d' lies lower by at most what the residual ρ allows: ⟨ρ, d' − d⟩ + u‖d' − d‖²/2 ≥ −‖ρ‖*²/2u.
        let farthest = self.norm.length(&step).max(0.5 * residual / self.weight);
        let slack = slack_error(&sides.0, &sides.1, &point, self.set);
        let left = missed + slack + residual * farthest;
        let solved = left <= MET_BY_CONES * self.merit(&step).abs() + LEFT_BY_CONES * self.value.abs();
        if solved || self.base.len() > MAX_VARIABLES_OF_CUTS {
            return Ok(self.solved(step, vec![cut], sides));
        }
        let there = OuterCut::at(self.outer, there)?;
        self.solve_by_cuts(solver, vec![cut, there])
    }

    /// The curvature of h, or that of its parts with weights.
    fn curvature(&self, outputs: &Vector, weights: &[f64]) -> Option<Matrix> {
        let jacobian = &self.linearization.jacobian;
        match weights {
            [] => self.outer.curvature(outputs, jacobian),
            weights => self.outer.parts_curvature(outputs, jacobian, weights),
        }
    }

    fn solve_by_newton(&self, solver: &mut EpigraphQpSolver) -> Result<CompositeStep, SubproblemError> {
        let jacobian = &self.linearization.jacobian;
        // Where the base lies outside the set, as before a closing step, the step of length 0 is not feasible.
        let mut step = project(self.set, self.base)? - self.base;
        let mut merit = self.merit(&step);
        // Multipliers of the parts in the last step, where h has some.
        let mut weights: Option<Vec<f64>> = None;
        for _ in 0..MAX_NEWTON {
            still_wanted()?;
            let (parts, is_whole) = self.parts(&step)?;
            let ids: Vec<u64> = (0..parts.len() as u64).collect();
            let highest = parts.iter().map(|part| part.value).fold(f64::NEG_INFINITY, f64::max);
            let offsets: Vec<f64> = parts.iter().map(|part| highest - part.value).collect();
            let of_highest = || offsets.iter().map(|offset| f64::from(u8::from(*offset == 0.0))).collect();
            let own = if is_whole { vec![] } else { weights.take().unwrap_or_else(of_highest) };
            let Some(curvature) = self.curvature(&parts[0].outputs, &own) else { break };
            let metric = self.with_metric(curvature.clone());
            let slope = |part: &OuterCut| jacobian.tr_mul(&part.subgradient) + self.pull(&step);
            let slopes: Vec<Vector> = parts.iter().map(slope).collect();
            let point = self.base + &step;
            let cuts = Cuts { slopes: &slopes, offsets: &offsets, ids: &ids, gram: None };
            let solution = subproblem::solve(solver, self.set, &point, Metric::Dense(&metric), cuts)
                .map_err(|error| negative_curvature(curvature).unwrap_or_else(|| error.into()))?;
            let rise = |(slope, offset): (&Vector, &f64)| slope.dot(&solution.step) - offset;
            let promised = -slopes.iter().zip(&offsets).map(rise).fold(f64::NEG_INFINITY, f64::max);
            let ends = promised <= SOLVED * merit.abs() + ROUNDING * self.value.abs();
            let next = if ends { None } else { self.search(&step, &solution.step, merit, promised) };
            let Some((next, lower)) = next else {
                let mut cuts = parts;
                let own = |index: usize| if is_whole { 1.0 } else { solution.cut_multipliers[index] };
                cuts.iter_mut().enumerate().for_each(|(index, cut)| cut.multiplier = own(index));
                cuts.retain(|cut| cut.multiplier > 0.0);
                return Ok(self.solved(step, cuts, multipliers(&solution)));
            };
            weights = Some(solution.cut_multipliers.clone());
            (step, merit) = (next, lower);
        }
        Err(SubproblemError::Unusable)
    }

    /// The parts of h at a step as cuts of it; h itself where it has none, and whether that is so.
    fn parts(&self, step: &Vector) -> Result<(Vec<OuterCut>, bool), SubproblemError> {
        let outputs = self.outputs(step);
        let parts = self.outer.parts(&outputs).into_iter();
        let mut cuts = parts.map(|part| OuterCut::of_part(part, outputs.clone())).collect::<Result<Vec<_>, _>>()?;
        let is_whole = cuts.is_empty();
        if is_whole {
            cuts.push(OuterCut::at(self.outer, outputs)?);
        }
        cuts.iter().try_for_each(|cut| self.error(cut).map(|_| ()))?;
        Ok((cuts, is_whole))
    }

    /// `from` plus `step`, which is halved until the merit falls enough, with the merit there; none where rounding
    /// hides any decrease.
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
        let (mut slopes, mut offsets, mut ids, mut longest) = (vec![], vec![], vec![], 0.0_f64);
        loop {
            still_wanted()?;
            for newest in &cuts[slopes.len()..] {
                let slope = linearization.jacobian.tr_mul(&newest.subgradient) + &pull;
                let length = slope.norm();
                // Such a cut of h says no more than an evaluation with such a subgradient: the step that led there was
                // too long.
                if longest > 0.0 && length > MAX_RELATIVE_SLOPE * longest {
                    return Err(SubproblemError::Unusable);
                }
                longest = length.max(longest);
                slopes.push(slope);
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
            cuts.push(next.shrunk(self.outer, linearization.outputs.amax()));
        }
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
