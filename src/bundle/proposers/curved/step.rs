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

/// The solution of the quadratic program of one round.
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

#[cfg(test)]
mod tests {
    //! The step of the curved model has the value of closed forms, and no tangent leaves room for a lower one.

    use super::super::pieces::Curvature;
    use super::*;
    use proptest::prelude::*;
    use testset::kit::Random;

    fn vector(values: &[f64]) -> Vector {
        Vector::from_column_slice(values)
    }

    /// The step around the origin in a set.
    fn minimum(model: &CurvedModel, weight: f64, set: &Polyhedron) -> Vector {
        minimum_within(f64::INFINITY, model, weight, set)
    }

    /// The minimum of the model among the steps of at most the length given.
    fn minimum_within(radius: f64, model: &CurvedModel, weight: f64, set: &Polyhedron) -> Vector {
        let center = Vector::zeros(set.dimension());
        let norm = ScaledNorm::euclidean(set.dimension());
        let penalised = Penalised { model, weight, radius, norm: &norm, set, center: &center };
        let mut multipliers = vec![0.0; model.ids().len()];
        multipliers[0] = 1.0;
        penalised.minimum(multipliers, &mut EpigraphQpSolver::new()).expect("feasible")
    }

    #[test]
    fn pieces_of_different_curvature_meet_at_their_crossing() {
        // −d + d²/2 and 5d − 1 + 25d² meet at 24.5 d² + 6 d = 1, and fall towards it from both sides.
        let curvature = |factor| Curvature::from_terms(vec![(factor, vector(&[1.0]))]);
        let pieces = vec![(vector(&[-1.0]), 0.0, curvature(1.0)), (vector(&[5.0]), 1.0, curvature(50.0))];
        let step = minimum(&CurvedModel::from_pieces(pieces), 1e-9, &Polyhedron::unbounded(1));
        let crossing = (134.0_f64.sqrt() - 6.0) / 49.0;
        assert!((step[0] - crossing).abs() <= 1e-7 * crossing, "{} {crossing}", step[0]);
    }

    #[test]
    fn one_quadratic_has_the_step_of_newton() {
        // min ⟨h, d⟩ + ½ dᵀ(B + w) d with B = diag(3, 0), w = 1.
        let curvature = Curvature::from_terms(vec![(3.0, vector(&[1.0, 0.0]))]);
        let model = CurvedModel::from_pieces(vec![(vector(&[4.0, -2.0]), 0.0, curvature)]);
        let step = minimum(&model, 1.0, &Polyhedron::unbounded(2));
        assert!((step - vector(&[-1.0, 2.0])).amax() <= 1e-12);
        let set = Polyhedron::boxed(vector(&[-0.5, -9.0]), vector(&[9.0, 9.0])).expect("a box");
        assert!((minimum(&model, 1.0, &set) - vector(&[-0.5, 2.0])).amax() <= 1e-12);
    }

    #[test]
    fn a_step_follows_a_valley_with_one_concave_side() {
        // 4 |y − x²| − x: the minimum with ½ w‖d‖² over the valley y = x² solves 1 = w (x + 2x³).
        let curvature = |factor| Curvature::from_terms(vec![(factor, vector(&[1.0, 0.0]))]);
        let pieces = vec![(vector(&[-1.0, 4.0]), 0.0, curvature(-8.0)), (vector(&[-1.0, -4.0]), 0.0, curvature(8.0))];
        let step = minimum_within(10.0, &CurvedModel::from_pieces(pieces), 1.0 / 3.0, &Polyhedron::unbounded(2));
        assert!((&step - vector(&[1.0, 1.0])).amax() <= 1e-3, "{step}");
    }

    #[test]
    fn an_unbounded_concave_piece_gives_a_step_within_the_radius() {
        let curvature = Curvature::from_terms(vec![(-2.0, vector(&[1.0, 0.0]))]);
        let model = CurvedModel::from_pieces(vec![(vector(&[-1.0, 1.0]), 0.0, curvature)]);
        let step = minimum_within(3.0, &model, 1.0, &Polyhedron::unbounded(2));
        assert!(step.norm() <= 3.0 && step.norm() > 1.0 && step[0] > 0.0 && step[1] < 0.0, "{step}");
    }

    /// A model of random pieces, the first of them through zero, in a box around the origin.
    fn random_model(seed: u64, (n, pieces): (usize, usize), curvature: f64) -> (CurvedModel, Polyhedron) {
        let mut random = Random(seed);
        let mut draw = |length: f64| Vector::from_fn(n, |_, _| length * random.signed());
        let pieces = (0..pieces).map(|i| {
            let offset = if i == 0 { 0.0 } else { draw(0.3)[0].abs() };
            let slope = draw(1.0);
            let terms = (0..n).map(|k| (curvature * 0.1_f64.powi(k as i32), draw(1.0))).collect();
            (slope, offset, Curvature::from_terms(terms))
        });
        let model = CurvedModel::from_pieces(pieces.collect());
        let (lower, upper) = (draw(1.0).map(|side| -side.abs()), draw(1.0).map(f64::abs));
        (model, Polyhedron::boxed(lower, upper).expect("a box"))
    }

    /// The value of the step, and by how much the tangents at the step, which bound the model from below, can be
    /// lowered from it with ½ w‖·‖². The bound comes from one quadratic program that knows neither curvatures nor
    /// multipliers of the search.
    fn value_and_room(model: &CurvedModel, set: &Polyhedron) -> (f64, f64) {
        let n = set.dimension();
        let (center, norm, weight) = (Vector::zeros(n), ScaledNorm::euclidean(n), 0.1);
        let step = minimum(model, weight, set);
        assert!(set.violation(&step) <= 1e-12);
        let penalised = Penalised { model, weight, radius: f64::INFINITY, norm: &norm, set, center: &center };
        let (mut slopes, values) = model.tangents(&step);
        slopes.iter_mut().for_each(|slope| *slope += &step * weight);
        let top = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let offsets: Vec<f64> = values.iter().map(|value| top - value).collect();
        let cuts = Cuts { slopes: &slopes, offsets: &offsets, ids: model.ids(), gram: None };
        let metric = norm.weighted(weight);
        let bound =
            subproblem::solve(&mut EpigraphQpSolver::new(), set, &step, metric.metric(), cuts).expect("feasible");
        (penalised.value(&step), -(cuts.change(&bound.step) + 0.5 * weight * norm.squared(&bound.step)))
    }

    /// The third round of this model gains 1e-6 of its value with a full step, and a fourth gains 5e-2 of it.
    #[test]
    fn a_round_that_gains_little_is_not_the_end() {
        let (model, set) = random_model(388_190, (5, 2), 10f64.powf(1.734_118_395_571_973_4));
        let (value, room) = value_and_room(&model, &set);
        assert!(room <= 1e-4 * value.abs(), "room {room:e} below {value:e}");
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, cases: 256, ..ProptestConfig::default() })]

        #[test]
        fn the_tangents_at_the_step_leave_no_room(
            seed: u64,
            n in 1usize..6,
            pieces in 1usize..8,
            power in -2.0..2.0f64,
        ) {
            let (model, set) = random_model(seed, (n, pieces), 10f64.powf(power));
            let (value, room) = value_and_room(&model, &set);
            prop_assert!(value <= 0.0);
            prop_assert!(room <= 1e-4 * value.abs().max(1e-12), "room {room:e} below {value:e}");
        }

        /// Central differences of a quadratic are exact.
        #[test]
        fn tangents_are_the_derivatives_of_the_pieces(seed: u64, n in 1usize..6) {
            let (model, _) = random_model(seed, (n, 4), 1.0);
            let mut random = Random(seed ^ 1);
            let (d, e) = (Vector::from_fn(n, |_, _| random.signed()), Vector::from_fn(n, |_, _| random.signed()));
            let (slopes, values) = model.tangents(&d);
            prop_assert_eq!(model.change(&d), values.iter().copied().fold(f64::NEG_INFINITY, f64::max));
            let (ahead, behind) = (model.tangents(&(&d + &e)).1, model.tangents(&(&d - &e)).1);
            for ((slope, value), (ahead, behind)) in slopes.iter().zip(values).zip(ahead.into_iter().zip(behind)) {
                let rounding = 1e-12 * (1.0 + ahead.abs() + behind.abs());
                prop_assert!((slope.dot(&e) - 0.5 * (ahead - behind)).abs() <= rounding);
                // The pieces are convex.
                prop_assert!(ahead + behind - 2.0 * value >= -rounding);
            }
        }
    }

    #[test]
    fn the_matrix_of_the_multipliers_is_the_mean_of_the_curvatures() {
        let terms = [vec![(2.0, vector(&[1.0, 1.0]))], vec![]];
        let pieces = terms.map(|terms| (Vector::zeros(2), 0.0, Curvature::from_terms(terms)));
        let matrix = CurvedModel::from_pieces(pieces.into()).matrix(2, &[0.25, 0.75]);
        assert_eq!(matrix, Matrix::from_element(2, 2, 0.5));
        assert_eq!(Curvature::from_terms(vec![(2.0, vector(&[1.0, 1.0]))]).along(&vector(&[1.0, 0.0])), 2.0);
    }
}
