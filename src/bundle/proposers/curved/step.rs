//! The step of the curved model: its minimum with the penalty, by sequential quadratic programming for minimax.
//!
//! ```text
//! m(d) = max_i { h_i·d − a_i + ½ dᵀB_i d } + ½ w‖d‖²                                          x̂ + d ∈ U
//! round:  p minimises  max_i { (h_i + B_i d + w W d)·p − (m(d) − m_i(d)) } + ½ pᵀ(Σ λ_i B_i + w W) p       x̂ + d + p ∈ U
//!         d ← d + t p,  t = 1, ½, ¼ … until m falls;   λ: multipliers of the round before
//! ```
//! If m is convex, every p ≠ 0 is a direction of descent. Concave pieces may make it nonconvex: where Σ λ_i B_i + w W
//! is not positive definite, its eigenvalues (relative to W) are replaced by their absolute values, and the step stays
//! within a radius: what was seen of a concave piece says nothing about points far beyond. The tangents are taken at
//! the newest step: multipliers alone, with the pieces always transported to d = 0, leave a step that raises m wherever
//! the curvatures of the active pieces differ.

use super::model::CurvedModel;
use crate::bundle::norm::ScaledNorm;
use crate::bundle::proposers::subproblem::{self, Cuts};
use crate::qp::{EpigraphQpSolver, Metric, QpError};
use crate::{Matrix, Polyhedron, Vector};
use nalgebra::{Cholesky, SymmetricEigen};

/// Quadratic programs for one trial point at most.
const MAX_ROUNDS: usize = 30;
/// The step is accurate enough once a round promises to lower the model by at most this share of its value.
const ACCURACY: f64 = 1e-6;

/// The function m around a center.
pub(super) struct Penalised<'a> {
    pub model: &'a CurvedModel,
    pub weight: f64,
    /// The longest step; infinite where no piece is concave.
    pub radius: f64,
    pub norm: &'a ScaledNorm,
    pub set: &'a Polyhedron,
    pub center: &'a Vector,
}

/// What the quadratic program of one round gives.
struct Round {
    /// p.
    correction: Vector,
    /// By how much p lowers the objective of the program.
    promise: f64,
    multipliers: Vec<f64>,
}

impl Penalised<'_> {
    /// m(d).
    pub(super) fn value(&self, step: &Vector) -> f64 {
        self.model.change(step) + 0.5 * self.weight * self.norm.squared(step)
    }

    /// The step that minimises m, and zero where no round finds a lower value. A round that cannot be solved ends the
    /// search; it is an error where nothing has been found before.
    pub(super) fn minimum(&self, mut multipliers: Vec<f64>, solver: &mut EpigraphQpSolver) -> Result<Vector, QpError> {
        let mut step = Vector::zeros(self.center.len());
        let mut value = self.value(&step);
        let (mut moved, mut failed) = (false, false);
        for _ in 0..MAX_ROUNDS {
            let Round { correction, promise, multipliers: next } = match self.round(&step, &multipliers, solver) {
                Ok(round) => round,
                Err(_) if moved => break,
                Err(error) => return Err(error),
            };
            multipliers = next;
            if let Some((lower, lower_value)) = self.lower(&step, value, &correction) {
                (step, value, moved, failed) = (lower, lower_value, true, false);
            } else if std::mem::replace(&mut failed, true) {
                // One round may fail because its multipliers are those of pieces that have left; not two in a row.
                break;
            }
            if promise <= ACCURACY * value.abs() {
                break;
            }
        }
        Ok(step)
    }

    /// The correction p of one round, and its multipliers.
    fn round(&self, step: &Vector, multipliers: &[f64], solver: &mut EpigraphQpSolver) -> Result<Round, QpError> {
        let metric = self.metric(multipliers)?;
        let (mut slopes, values) = self.model.tangents(step);
        let pull = self.norm.lower_index(step) * self.weight;
        slopes.iter_mut().for_each(|slope| *slope += &pull);
        let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let offsets: Vec<f64> = values.iter().map(|value| highest - value).collect();
        let cuts = Cuts { slopes: &slopes, offsets: &offsets, ids: self.model.ids(), gram: None };
        let base = self.center + step;
        let solution = subproblem::solve(solver, self.set, &base, Metric::Dense(&metric), cuts)?;
        let promise = -solution.epigraph - 0.5 * solution.step.dot(&(&metric * &solution.step));
        Ok(Round { correction: solution.step, promise, multipliers: solution.cut_multipliers })
    }

    /// Σ λ_i B_i + w W, made positive definite.
    fn metric(&self, multipliers: &[f64]) -> Result<Matrix, QpError> {
        let mut metric = self.model.matrix(self.center.len(), multipliers);
        self.norm.add_to(&mut metric, self.weight);
        if self.radius == f64::INFINITY || Cholesky::new(metric.clone()).is_some() {
            return Ok(metric);
        }
        let form = self.norm.form_in_coordinates(metric);
        let finite = form.iter().all(|entry| entry.is_finite());
        let rotations = 10 * form.nrows();
        let eigen = finite.then(|| SymmetricEigen::try_new(form, f64::EPSILON, rotations)).flatten();
        let mut eigen = eigen.ok_or(QpError::NotSolved { kkt_residual: f64::INFINITY })?;
        eigen.eigenvalues.apply(|value| *value = value.abs().max(self.weight));
        Ok(self.norm.form_of_coordinates(eigen.recompose()))
    }

    /// The first of the halved steps within the radius that lowers m, and its value.
    fn lower(&self, step: &Vector, value: f64, correction: &Vector) -> Option<(Vector, f64)> {
        (0..=10).find_map(|halvings| {
            let trial = step + correction * 0.5_f64.powi(halvings);
            let lower = self.value(&trial);
            (lower < value && self.norm.length(&trial) <= self.radius).then_some((trial, lower))
        })
    }
}
