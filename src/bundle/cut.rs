//! Cuts: what one evaluation leaves behind, and the bundle that keeps them.
//!
//! ```text
//! e_i = Θ(x̂) − Θ(y_i) − ⟨g_i, x̂ − y_i⟩        linearization error at the center x̂
//! E_ij = Θ(y_j) − Θ(y_i) − ⟨g_i, y_j − y_i⟩     the same at another cut's point; all ≥ 0 if Θ is convex
//! ```

use super::norm::ScaledNorm;
use super::pairs::Pairs;
use crate::Vector;
use crate::qp::kernels::difference_dot;
use serde::{Deserialize, Serialize};
use std::cell::Cell;

/// A cut is active if its multiplier exceeds this, where Σ λ = 1: stopping test, noise, scales and certificate count active cuts only.
/// A smaller multiplier is rounding of the subproblem: the cut is idle, and the longest idle cut leaves the bundle first.
pub(crate) const LEAST_ACTIVE_MULTIPLIER: f64 = 1e-9;

/// One evaluation kept in the bundle, or several merged into one cut.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Cut {
    /// Number of the cut in the order in which cuts were made; unique in a run.
    pub id: u64,
    /// Where Θ was evaluated, y; of merged cuts, the point of the one with the larger multiplier.
    pub point: Vector,
    /// Largest distance from `point` of a point that the cut stems from; 0 for a cut that is not merged.
    #[serde(default)]
    pub radius: f64,
    /// Θ(y), or a lower bound of it.
    pub value: f64,
    /// One subgradient of Θ at y.
    pub subgradient: Vector,
    /// Bound or estimate of the error of `value` that the oracle promised, in units of Θ.
    pub error_bound: f64,
    /// Whether the oracle certified the cut to lie below Θ (an answer [`NoDescent`](crate::Answer::NoDescent)), or the cut is
    /// merged: it holds, but its value bounds Θ(y) from below only.
    pub certified: bool,
    /// Multiplier λ ≥ 0 in the last subproblem; Σ λ = 1 over all cuts.
    pub multiplier: f64,
    /// Subproblems in a row in which the cut was not active.
    pub idle: usize,
}

impl Cut {
    /// Whether the multiplier is more than rounding of the subproblem: above 1e-9.
    pub fn is_active(&self) -> bool {
        self.multiplier > LEAST_ACTIVE_MULTIPLIER
    }

    /// How far the points behind the cut lie from a point at most.
    pub(crate) fn farthest_from(&self, x: &Vector, norm: &ScaledNorm) -> f64 {
        norm.squared_distance(x, &self.point).sqrt() + self.radius
    }

    /// The mean of two cuts, weighted by their multipliers. The last subproblem has the same answer with it as with both.
    fn merged(&self, lighter: &Self, id: u64, norm: &ScaledNorm) -> Self {
        let multiplier = self.multiplier + lighter.multiplier;
        let share = lighter.multiplier / multiplier;
        let distance = norm.squared_distance(&self.point, &lighter.point).sqrt();
        let here = |cut: &Self| {
            let slope = cut.subgradient.as_slice();
            cut.value - cut.excess() + difference_dot(slope, self.point.as_slice(), cut.point.as_slice())
        };
        Self {
            id,
            point: self.point.clone(),
            radius: self.radius.max(distance + lighter.radius),
            value: (1.0 - share) * here(self) + share * here(lighter),
            subgradient: &self.subgradient * (1.0 - share) + &lighter.subgradient * share,
            error_bound: 0.0,
            certified: true,
            multiplier,
            idle: 0,
        }
    }

    /// How far the cut may lie above a convex Θ: the promised error of its value, 0 if it is certified.
    pub fn excess(&self) -> f64 {
        if self.certified { 0.0 } else { self.error_bound }
    }

    /// e = value − Θ(y) − ⟨g, x − y⟩: the linearization error at a point x where Θ has the value given.
    pub fn linearization_error(&self, x: &Vector, value: f64) -> f64 {
        value - self.value - difference_dot(self.subgradient.as_slice(), x.as_slice(), self.point.as_slice())
    }
}

/// A pair of cuts of which one lies above the other's point: Θ is not convex between them.
#[derive(Debug, Clone, Copy)]
struct ConcavePair {
    ids: (u64, u64),
    error: f64,
    squared_distance: f64,
    /// What promised errors and rounding of the two values explain of the error.
    allowance: f64,
}

/// ‖g‖* and ‖y‖ of a cut, and how far its linearization varies, with the center for which this spread was formed.
#[derive(Debug, Clone)]
struct Sizes {
    dual_length: f64,
    point_length: f64,
    spread: Cell<Option<(u64, Spread)>>,
}

/// Σ |g_k| size_k and Σ |g_k| reach_k of a cut, with the lengths of `scales.rs`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spread {
    pub size: f64,
    pub reach: f64,
}

/// The cuts of a run and the pairs of them that prove nonconvexity.
#[derive(Debug, Clone, Default)]
pub(crate) struct Bundle {
    cuts: Vec<Cut>,
    sizes: Vec<Sizes>,
    concave: Vec<ConcavePair>,
    pairs: Pairs,
}

impl Bundle {
    pub(crate) fn cuts(&self) -> &[Cut] {
        &self.cuts
    }

    pub(crate) fn cut(&self, id: u64) -> Option<&Cut> {
        self.cuts.iter().find(|cut| cut.id == id)
    }

    /// Takes in a cut and compares it with all others.
    pub(crate) fn push(&mut self, cut: Cut, norm: &ScaledNorm) {
        let (dual_length, point_length) = (norm.dual_length(&cut.subgradient), norm.length(&cut.point));
        self.sizes.push(Sizes { dual_length, point_length, spread: Cell::new(None) });
        self.cuts.push(cut);
        self.pairs.push(&self.cuts, norm);
        self.note_concave_pairs();
    }

    /// ‖g‖* of the cuts in their order.
    pub(crate) fn dual_lengths(&self) -> impl Iterator<Item = f64> {
        self.sizes.iter().map(|sizes| sizes.dual_length)
    }

    /// ‖y‖ of the cuts in their order.
    pub(crate) fn point_lengths(&self) -> impl Iterator<Item = f64> {
        self.sizes.iter().map(|sizes| sizes.point_length)
    }

    /// How far the linearization of the cut at a position varies at a center; formed once per center.
    pub(crate) fn spread(&self, position: usize, center: u64, form: impl FnOnce(&Cut) -> Spread) -> Spread {
        let known = &self.sizes[position].spread;
        match known.get() {
            Some((id, spread)) if id == center => spread,
            _ => {
                let spread = form(&self.cuts[position]);
                known.set(Some((center, spread)));
                spread
            }
        }
    }

    /// Makes one more cut fit into `size` without touching the protected one. The cut idle longest leaves. Where every cut is active, the
    /// two of smallest multipliers become one, so that the model keeps its minimiser; it is numbered by `next_id`.
    pub(crate) fn make_room(&mut self, size: usize, protected: u64, next_id: &mut u64, norm: &ScaledNorm) {
        while self.cuts.len() >= size {
            let candidates = || self.cuts.iter().enumerate().filter(|(_, cut)| cut.id != protected);
            let idle = candidates().filter(|(_, cut)| cut.idle > 0).max_by_key(|(i, cut)| (cut.idle, usize::MAX - i));
            if let Some((index, _)) = idle {
                self.remove(index);
                continue;
            }
            let mut weakest: Vec<usize> = candidates().map(|(index, _)| index).collect();
            weakest.sort_by(|&a, &b| self.cuts[a].multiplier.total_cmp(&self.cuts[b].multiplier));
            match weakest[..] {
                [lighter, heavier, ..] if self.cuts[lighter].is_active() => {
                    let merged = self.cuts[heavier].merged(&self.cuts[lighter], *next_id, norm);
                    *next_id += 1;
                    self.remove(lighter.max(heavier));
                    self.remove(lighter.min(heavier));
                    self.push(merged, norm);
                }
                [index, ..] => self.remove(index),
                [] => return,
            }
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
        self.sizes.remove(index);
        self.concave.retain(|pair| pair.ids.0 != cut.id && pair.ids.1 != cut.id);
        self.pairs.remove(index);
    }

    /// Stores the multipliers of a subproblem, given in the order of the cuts.
    pub(crate) fn set_multipliers(&mut self, multipliers: &[f64]) {
        for (cut, &multiplier) in self.cuts.iter_mut().zip(multipliers) {
            cut.multiplier = multiplier;
            cut.idle = if cut.is_active() { 0 } else { cut.idle + 1 };
        }
    }

    /// Looks for concave pairs with the newest cut.
    fn note_concave_pairs(&mut self) {
        let newest = self.cuts.len() - 1;
        for i in 0..newest {
            let squared_distance = self.pairs.distance(i, newest);
            for (i, j) in [(i, newest), (newest, i)].into_iter().filter(|(_, j)| !self.cuts[*j].certified) {
                let (error, from, to) = (self.pair_error(i, j), &self.cuts[i], &self.cuts[j]);
                if error < 0.0 {
                    let allowance = from.error_bound + to.error_bound + 1e-9 * (from.value.abs() + to.value.abs());
                    self.concave.push(ConcavePair { ids: (from.id, to.id), error, squared_distance, allowance });
                }
            }
        }
    }

    /// What every two cuts have in common.
    pub(crate) fn pairs(&self) -> &Pairs {
        &self.pairs
    }

    /// E_ij of two cuts, given by their positions.
    pub(crate) fn pair_error(&self, i: usize, j: usize) -> f64 {
        self.cuts[j].value - self.cuts[i].value - self.pairs.slope(i, j)
    }

    /// The position of a cut.
    pub(crate) fn position(&self, id: u64) -> Option<usize> {
        self.cuts.iter().position(|cut| cut.id == id)
    }

    /// Curvatures −E_ij/‖y_i − y_j‖², ascending, proven by pairs that are farther apart than `resolution` and whose error exceeds its
    /// allowance by more than `value_resolution`.
    pub(crate) fn proven_curvatures(&self, resolution: f64, value_resolution: f64) -> Vec<f64> {
        let mut curvatures: Vec<f64> = self
            .concave
            .iter()
            .filter(|pair| -pair.error > pair.allowance + value_resolution)
            .filter(|pair| pair.squared_distance > resolution * resolution)
            .map(|pair| -pair.error / pair.squared_distance)
            .collect();
        curvatures.sort_by(f64::total_cmp);
        curvatures
    }
}
