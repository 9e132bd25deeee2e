//! The bundle: the cuts that are kept, and what every two of them prove.
//!
//! ```text
//! E_ij = Θ(y_j) − Θ(y_i) − ⟨g_i, y_j − y_i⟩     linearization error at another cut's point; all ≥ 0 if Θ is convex
//! ```

use super::cut::Cut;
use super::norm::ScaledNorm;
use super::pairs::Pairs;
use crate::Vector;
use crate::qp::kernels::dot_terms;
use std::cell::Cell;

/// Linearization errors below this share of the values, or of the size of Θ, may be rounding.
pub(crate) const VALUE_ROUNDING: f64 = 1e-9;

/// A pair of cuts of which one lies above the other's point: Θ is not convex between them.
#[derive(Debug, Clone, Copy)]
struct ConcavePair {
    ids: (u64, u64),
    error: f64,
    squared_distance: f64,
    /// What promised errors and rounding of the two values explain of the error.
    allowance: f64,
}

/// What promised errors and rounding of the values of two cuts explain of their linearization errors.
pub(crate) fn allowance(one: &Cut, other: &Cut) -> f64 {
    one.error_bound + other.error_bound + VALUE_ROUNDING * (one.value.abs() + other.value.abs())
}

/// ‖g‖* and Σ |g_i y_i| of a cut, and how far its linearization varies, with the center for which this spread was
/// formed.
#[derive(Debug, Clone)]
struct Sizes {
    dual_length: f64,
    terms: f64,
    spread: Cell<Option<(u64, Spread)>>,
}

/// Σ |g_k| size_k and Σ |g_k| reach_k of a cut, with the lengths at a center.
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
    /// Grows whenever a cut comes or goes.
    revision: u64,
}

impl Bundle {
    pub(crate) fn cuts(&self) -> &[Cut] {
        &self.cuts
    }

    /// Changes whenever a cut comes or goes.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    pub(crate) fn cut(&self, id: u64) -> Option<&Cut> {
        self.cuts.iter().find(|cut| cut.id == id)
    }

    /// Whether a cut knows a point, with a promised error of at most the one given: an evaluation would tell nothing
    /// new.
    pub(crate) fn knows(&self, point: &Vector, largest_error: f64) -> bool {
        let known = |cut: &Cut| !cut.certified && cut.point == *point && cut.error_bound <= largest_error;
        self.cuts.iter().any(known)
    }

    /// Takes in a cut and compares it with all others.
    pub(crate) fn push(&mut self, cut: Cut, norm: &ScaledNorm) {
        let dual_length = norm.dual_length(&cut.subgradient);
        let terms = dot_terms(cut.subgradient.as_slice(), cut.point.as_slice());
        self.revision += 1;
        self.sizes.push(Sizes { dual_length, terms, spread: Cell::new(None) });
        self.cuts.push(cut);
        self.pairs.push(&self.cuts, norm);
        self.note_concave_pairs();
    }

    /// ‖g‖* of the cuts in their order.
    pub(crate) fn dual_lengths(&self) -> impl Iterator<Item = f64> {
        self.sizes.iter().map(|sizes| sizes.dual_length)
    }

    /// Σ |g_i y_i| of the cuts in their order: the terms that cancel in a linearization.
    pub(crate) fn terms(&self) -> impl Iterator<Item = f64> {
        self.sizes.iter().map(|sizes| sizes.terms)
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

    /// Makes one more cut fit into `size` without touching the protected one. The cut idle longest leaves. Where every
    /// cut is active, the two of smallest multipliers become one, so that the model keeps its minimiser; it is numbered
    /// by `next_id`.
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
        self.revision += 1;
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
                    let allowance = allowance(from, to);
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

    /// Curvatures −E_ij/‖y_i − y_j‖², ascending, proven by pairs whose error exceeds its allowance by more than
    /// `resolution`.
    pub(crate) fn proven_curvatures(&self, resolution: f64) -> Vec<f64> {
        let mut curvatures: Vec<f64> = self
            .concave
            .iter()
            .filter(|pair| -pair.error > pair.allowance + resolution)
            .filter(|pair| pair.squared_distance > 0.0)
            .map(|pair| -pair.error / pair.squared_distance)
            .collect();
        curvatures.sort_by(f64::total_cmp);
        curvatures
    }
}
