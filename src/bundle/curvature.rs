//! A second model with curvature, rebuilt from the bundle at every step, and the right to use it.
//!
//! ```text
//! q(d) = max_i { ⟨h_i + B_i p_i, d⟩ − (a_i − ½ p_iᵀB_i p_i)₊ + ½ dᵀB_i d }      over the center and the cuts that contradict it
//! min over d   max_i { slope_i·d − offset_i } + ½ dᵀ(Σ λ_i B_i + w W) d       λ: multipliers of the solve before, a few times
//! S = Σ z zᵀ/⟨z, s⟩                                      more than the curvature seen, none where no subgradient changed
//! ```
//! Every piece has its own curvature B_i (pieces.rs); with the multipliers the subproblem has the Hessian of the Lagrangian of
//! the epigraph problem, as in sequential quadratic programming for minimax. Both models predict every trial; the curved one
//! proposes only while its record of predictions is clearly better, so that kinks turn it off. When the decrease promised has
//! become tiny beside what the run has gained, one trial with the metric S looks along directions in which no subgradient
//! changes: long flat valleys. Failures double the pause before either is used again.
//! References: \[LuksanVlcek1998\] (cuts transported by their own curvature), symmetric rank one from below.

use super::model::Model;
use super::pieces::Curvature;
use super::state::State;
use super::weight::Comparison;
use crate::{Matrix, Vector};

/// More variables than this make the dense matrix too dear.
pub(super) const LARGEST_DIMENSION: usize = 200;
/// Smaller over larger of the two errors of a pair with the center; below, the pair has a kink in between.
const SAME_PIECE: f64 = 0.2;
/// The same for the other pieces, whose curvature bends cuts from afar: only what is quadratic for sure.
const SURELY_SAME_PIECE: f64 = 0.97;
/// Solves of the subproblem with the multipliers of the one before.
const MULTIPLIER_ROUNDS: usize = 3;
/// Least cosine of z and s in S.
const LEAST_SEEN_COSINE: f64 = 1e-2;
/// A cut above the quadratic by this share of the sizes involved contradicts it.
const CONTRADICTION: f64 = 0.2;
/// Mean log ratio of the prediction errors from which the curved model is trusted.
const TRUSTED: f64 = 1.0;
/// Share of the newest comparison in that mean.
const NEWEST: f64 = 0.5;
/// Null steps in a row after which the curved model pauses.
const PATIENCE: usize = 3;
/// Longest pause.
const LONGEST_PAUSE: usize = 64;
/// Factor between the weights of two explorations, and at least below the weight of the run.
pub(super) const EXPLORATION: f64 = 100.0;
/// An exploration must promise this many times more than the step it replaces.
pub(super) const WORTHWHILE: f64 = 10.0;
/// Promised decrease times evaluations, relative to the decrease so far, below which a run counts as stalled.
const STALL: f64 = 0.01;

/// Which model a proposal comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The cutting-plane model.
    Plain,
    /// The curved model.
    Curved,
    /// The cutting-plane model with the metric S.
    Exploration,
}

/// A pause that doubles with every failure.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pause {
    left: usize,
    failures: u32,
}

impl Pause {
    fn is_over(self) -> bool {
        self.left == 0
    }

    fn succeed(&mut self) {
        self.failures = 0;
    }

    fn fail(&mut self) {
        self.left = (1 << self.failures.min(16)).min(LONGEST_PAUSE);
        self.failures += 1;
    }
}

/// Record of the curved model and of the explorations.
#[derive(Debug, Clone)]
pub(crate) struct CurvatureRecord {
    /// Weight added to B.
    pub weight: f64,
    /// Weight added to S in the next exploration.
    pub exploration_weight: f64,
    score: f64,
    nulls: usize,
    curved: Pause,
    exploration: Pause,
}

impl CurvatureRecord {
    pub(crate) fn new(weight: f64) -> Self {
        let pause = Pause::default();
        Self { weight, exploration_weight: weight, score: 0.0, nulls: 0, curved: pause, exploration: pause }
    }

    /// Whether the curved model may propose the next trial.
    pub(crate) fn is_trusted(&self) -> bool {
        self.curved.is_over() && self.score > TRUSTED
    }

    /// Whether an exploration may replace the next trial.
    pub(crate) fn may_explore(&self) -> bool {
        self.exploration.is_over()
    }

    /// One more evaluation: pauses run off.
    pub(crate) fn count_down(&mut self) {
        self.curved.left = self.curved.left.saturating_sub(1);
        self.exploration.left = self.exploration.left.saturating_sub(1);
    }

    /// Judges both predictions by what happened.
    pub(crate) fn compare(&mut self, change: f64, plain: f64, curved: f64) {
        let floor = 1e-3 * (change.abs() + plain.abs());
        // Models that agree say nothing about each other.
        if floor > 0.0 && plain != curved {
            let gain = (((change - plain).abs() + floor) / ((change - curved).abs() + floor)).ln();
            self.score += NEWEST * (gain.clamp(-2.0, 2.0) - self.score);
        }
    }

    /// A trial of the curved model and what became of it.
    pub(crate) fn after_curved(&mut self, serious: bool) {
        if serious {
            self.nulls = 0;
            self.curved.succeed();
        } else {
            self.nulls += 1;
            if self.nulls >= PATIENCE {
                self.nulls = 0;
                self.curved.fail();
            }
        }
    }

    /// An exploration with a weight and what became of it.
    pub(crate) fn after_exploration(&mut self, weight: f64, serious: bool) {
        if serious {
            self.exploration_weight = weight / EXPLORATION;
            self.exploration.succeed();
        } else {
            self.exploration_weight = weight * EXPLORATION;
            self.exploration.fail();
        }
    }
}

/// Where the quadratic part of a model comes from.
#[derive(Debug, Clone)]
pub(crate) enum Quadratic {
    /// One matrix for all cuts.
    Common(Matrix),
    /// One per cut.
    Pieces(Vec<Curvature>),
}

/// Slopes, offsets and quadratic part of a model.
#[derive(Debug, Clone)]
pub(crate) struct CurvedModel {
    pub quadratic: Quadratic,
    pub slopes: Vec<Vector>,
    pub offsets: Vec<f64>,
    pub ids: Vec<u64>,
}

impl CurvedModel {
    /// The model q at the center.
    pub(crate) fn new(state: &State, plain: &Model) -> Self {
        let (mut slopes, mut offsets, mut ids, mut pieces) = (vec![], vec![], vec![], vec![]);
        let center = state.bundle.cut(state.center_id);
        let around = center.map(|center| Curvature::around(center, state, SAME_PIECE)).unwrap_or_default();
        for ((cut, slope), &offset) in state.bundle.cuts().iter().zip(&plain.slopes).zip(&plain.offsets) {
            let Some(center) = center else { break };
            let p = &state.center - &cut.point;
            let half = 0.5 * around.along(&p);
            let error = center.linearization_error(&cut.point, cut.value);
            let is_center = cut.id == center.id;
            if !is_center && !cut.certified && error - half <= CONTRADICTION * (half + error.abs()) {
                continue;
            }
            let piece = if is_center { around.clone() } else { Curvature::around(cut, state, SURELY_SAME_PIECE) };
            slopes.push(slope + piece.apply(&p));
            offsets.push((offset - 0.5 * piece.along(&p)).max(0.0));
            ids.push(cut.id);
            pieces.push(piece);
        }
        Self { quadratic: Quadratic::Pieces(pieces), slopes, offsets, ids }
    }

    /// Σ λ_i B_i.
    pub(crate) fn matrix(&self, dimension: usize, multipliers: &[f64]) -> Matrix {
        match &self.quadratic {
            Quadratic::Common(matrix) => matrix.clone(),
            Quadratic::Pieces(pieces) => {
                let mut sum = Matrix::zeros(dimension, dimension);
                for (piece, &multiplier) in pieces.iter().zip(multipliers).filter(|(_, l)| **l > 0.0) {
                    piece.add_to(&mut sum, multiplier);
                }
                symmetric(&sum)
            }
        }
    }

    /// Predicted change of Θ.
    pub(crate) fn change(&self, d: &Vector) -> f64 {
        match &self.quadratic {
            Quadratic::Common(matrix) => largest(&self.slopes, &self.offsets, d) + 0.5 * d.dot(&(matrix * d)),
            Quadratic::Pieces(pieces) => {
                let values = self.slopes.iter().zip(&self.offsets).zip(pieces);
                values.map(|((h, a), b)| h.dot(d) - a + 0.5 * b.along(d)).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }

    /// Solves of the subproblem that a trial is worth.
    pub(crate) fn rounds(&self) -> usize {
        match self.quadratic {
            Quadratic::Common(_) => 1,
            Quadratic::Pieces(_) => MULTIPLIER_ROUNDS,
        }
    }
}

/// max_i ⟨h_i, d⟩ − a_i.
pub(crate) fn largest(slopes: &[Vector], offsets: &[f64], d: &Vector) -> f64 {
    slopes.iter().zip(offsets).map(|(h, a)| h.dot(d) - a).fold(f64::NEG_INFINITY, f64::max)
}

/// The matrix S.
pub(crate) fn seen_curvature(state: &State) -> Matrix {
    let n = state.center.len();
    let mut matrix = Matrix::zeros(n, n);
    let Some(center) = state.bundle.cut(state.center_id) else { return matrix };
    for cut in state.bundle.cuts() {
        let s = &cut.point - &center.point;
        let z = &cut.subgradient - &center.subgradient;
        let along = z.dot(&s).max(LEAST_SEEN_COSINE * state.norm.dual_length(&z) * state.norm.length(&s));
        if along > 0.0 {
            matrix.ger(1.0 / along, &z, &z, 1.0);
        }
    }
    symmetric(&matrix)
}

/// Removes what rounding made unsymmetric.
fn symmetric(matrix: &Matrix) -> Matrix {
    (matrix + matrix.transpose()) * 0.5
}

/// Whether the promised decrease is tiny beside what the run has gained per evaluation.
pub(crate) fn is_stalled(state: &State, predicted_decrease: f64) -> bool {
    predicted_decrease * (state.counts.evaluations as f64) < STALL * (state.start_value - state.center_value)
}

/// The weight beside B that the observed change asks for.
pub(crate) fn missing_weight(comparison: &Comparison, step_length: f64) -> f64 {
    2.0 * (comparison.change - comparison.model_change) / (step_length * step_length)
}
