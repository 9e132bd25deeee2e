//! Cuts: what one evaluation leaves behind, and the bundle that keeps them.
//!
//! ```text
//! e_i = Θ(x̂) − Θ(y_i) − ⟨g_i, x̂ − y_i⟩        linearization error at the center x̂
//! E_ij = Θ(y_j) − Θ(y_i) − ⟨g_i, y_j − y_i⟩     the same at another cut's point; all ≥ 0 if Θ is convex
//! ```

use super::norm::ScaledNorm;
use crate::Vector;
use serde::{Deserialize, Serialize};

/// A multiplier above this makes a cut active: stopping test, noise and certificate speak of it. Σ λ = 1.
pub(crate) const LEAST_ACTIVE_MULTIPLIER: f64 = 1e-9;
/// A multiplier up to this is rounding of the subproblem: the cut is idle, and the first to leave the bundle.
const LARGEST_IDLE_MULTIPLIER: f64 = 1e-10;

/// One evaluation kept in the bundle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Cut {
    /// Number of the evaluation that made the cut; unique in a run.
    pub id: u64,
    /// Where Θ was evaluated, y.
    pub point: Vector,
    /// Θ(y), or a lower bound of it.
    pub value: f64,
    /// One subgradient of Θ at y.
    pub subgradient: Vector,
    /// Error that the oracle promised for `value`.
    pub error_bound: f64,
    /// Whether the oracle certified the cut to lie below Θ (an answer [`NoDescent`](crate::Answer::NoDescent)): it holds, but its
    /// value tells nothing about Θ(y) from above.
    pub certified: bool,
    /// Multiplier in the last subproblem.
    pub multiplier: f64,
    /// Subproblems in a row in which the multiplier was zero.
    pub idle: usize,
}

impl Cut {
    /// Whether the cut carried a positive multiplier in the last subproblem.
    pub fn is_active(&self) -> bool {
        self.multiplier > LEAST_ACTIVE_MULTIPLIER
    }

    /// Whether the last subproblem made no use of the cut, not even in its rounding.
    pub(crate) fn is_idle(&self) -> bool {
        self.multiplier <= LARGEST_IDLE_MULTIPLIER
    }

    /// How far the cut may lie above a convex Θ: the promised error of its value, nothing if it is certified.
    pub fn excess(&self) -> f64 {
        if self.certified { 0.0 } else { self.error_bound }
    }

    /// e = value − Θ(y) − ⟨g, x − y⟩, the linearization error at a point x with the value given.
    pub fn linearization_error(&self, x: &Vector, value: f64) -> f64 {
        let mut slope = 0.0;
        for (g, (x, y)) in self.subgradient.iter().zip(x.iter().zip(self.point.iter())) {
            slope += g * (x - y);
        }
        value - self.value - slope
    }
}

/// A pair of cuts of which one lies above the other's point: Θ is not convex between them.
#[derive(Debug, Clone, Copy)]
struct ConcavePair {
    ids: (u64, u64),
    error: f64,
    squared_distance: f64,
    allowance: f64,
}

/// The cuts of a run and the pairs of them that prove nonconvexity.
#[derive(Debug, Clone, Default)]
pub(crate) struct Bundle {
    cuts: Vec<Cut>,
    pairs: Vec<ConcavePair>,
    /// How many of `cuts` have been compared with all before them.
    compared: usize,
}

impl From<Vec<Cut>> for Bundle {
    fn from(cuts: Vec<Cut>) -> Self {
        Self { cuts, ..Self::default() }
    }
}

impl Bundle {
    pub(crate) fn cuts(&self) -> &[Cut] {
        &self.cuts
    }

    pub(crate) fn cut(&self, id: u64) -> Option<&Cut> {
        self.cuts.iter().find(|cut| cut.id == id)
    }

    pub(crate) fn push(&mut self, cut: Cut) {
        self.cuts.push(cut);
    }

    /// Removes the cut that has been idle longest, or the one of smallest multiplier; never the protected one.
    pub(crate) fn make_room(&mut self, size: usize, protected: u64) {
        while self.cuts.len() >= size.max(2) {
            let candidates = || self.cuts.iter().enumerate().filter(|(_, cut)| cut.id != protected);
            let idle = candidates().filter(|(_, cut)| cut.idle > 0).max_by_key(|(i, cut)| (cut.idle, usize::MAX - i));
            let weakest = || candidates().min_by(|a, b| a.1.multiplier.total_cmp(&b.1.multiplier));
            let Some((index, _)) = idle.or_else(weakest) else { return };
            self.remove(index);
        }
    }

    /// Keeps the cuts for which `keep` holds.
    pub(crate) fn retain(&mut self, mut keep: impl FnMut(&Cut) -> bool) {
        for index in (0..self.cuts.len()).rev() {
            if !keep(&self.cuts[index]) {
                self.remove(index);
            }
        }
    }

    fn remove(&mut self, index: usize) {
        let cut = self.cuts.remove(index);
        self.pairs.retain(|pair| pair.ids.0 != cut.id && pair.ids.1 != cut.id);
        if index < self.compared {
            self.compared -= 1;
        }
    }

    /// Stores the multipliers of a subproblem, given in the order of the cuts.
    pub(crate) fn set_multipliers(&mut self, multipliers: &[f64]) {
        for (cut, &multiplier) in self.cuts.iter_mut().zip(multipliers) {
            cut.multiplier = multiplier;
            cut.idle = if cut.is_idle() { cut.idle + 1 } else { 0 };
        }
    }

    /// Compares new cuts with all others.
    pub(crate) fn compare_pairs(&mut self, norm: &ScaledNorm) {
        for j in self.compared..self.cuts.len() {
            for i in 0..j {
                let (a, b) = (&self.cuts[i], &self.cuts[j]);
                let squared_distance = norm.squared_distance(&a.point, &b.point);
                for (from, to) in [(a, b), (b, a)].into_iter().filter(|(_, to)| !to.certified) {
                    let error = from.linearization_error(&to.point, to.value);
                    if error < 0.0 {
                        let allowance = from.error_bound + to.error_bound + 1e-9 * (from.value.abs() + to.value.abs());
                        self.pairs.push(ConcavePair { ids: (from.id, to.id), error, squared_distance, allowance });
                    }
                }
            }
        }
        self.compared = self.cuts.len();
    }

    /// Curvatures −E_ij/‖y_i − y_j‖² proven by pairs farther apart than `resolution`, ascending.
    pub(crate) fn proven_curvatures(&self, resolution: f64, value_resolution: f64) -> Vec<f64> {
        let mut curvatures: Vec<f64> = self
            .pairs
            .iter()
            .filter(|pair| -pair.error > pair.allowance + value_resolution)
            .filter(|pair| pair.squared_distance > resolution * resolution)
            .map(|pair| -pair.error / pair.squared_distance)
            .collect();
        curvatures.sort_by(f64::total_cmp);
        curvatures
    }
}
