//! The convexified cutting-plane model around the center.
//!
//! ```text
//! m(d) = max_i { ⟨h_i, d⟩ − a_i },   h_i = g_i − 2c W p_i,   a_i = max(e_i + c‖p_i‖², |e_i|),   p_i = x̂ − y_i
//! c = max( quantile of −E_ij/‖y_i − y_j‖² over concave pairs,  −e_i/‖p_i‖² )
//! ```
//! c = 0 as long as no pair of cuts proves Θ nonconvex: m is then the plain cutting-plane model. The errors p that the
//! oracle promised are added to a_i; for Θ declared convex, a_i = |e_i + p|. References: \[SchrammZowe1992\]
//! (bundle-trust), \[HareSagastizabal2010\] (tilted cuts).

use crate::Vector;
use crate::bundle::config::{BundleTrustConfig, Convexity};
use crate::bundle::cut::offset;
use crate::bundle::kept_cuts::VALUE_ROUNDING;
use crate::bundle::proposers::subproblem::Cuts;
use crate::bundle::state::{BundleState, NOISE_MARGIN};
use crate::linalg::upper_median;
use crate::qp::Gram;

/// Slopes and offsets of the model, in the order of the cuts.
#[derive(Debug, Clone)]
pub(crate) struct Model {
    slopes: Vec<Vector>,
    offsets: Vec<f64>,
    ids: Vec<u64>,
    /// The curvature c added to make the model convex.
    pub convexification: f64,
    /// θ_i ≤ 1: share of cut i in the mixture that the subproblem takes in its place; the rest is the center's cut.
    shares: Vec<f64>,
    /// Position of the center's cut.
    center: Option<usize>,
    /// Inner products of the tilted slopes, by slots, if c > 0 and the subproblem is solved with them.
    tilted: Option<Vec<Vec<f64>>>,
}

/// A cut this much steeper than the median and the center's cut drowns the others in rounding, and is mixed with the
/// center's cut.
const MAX_RELATIVE_SLOPE: f64 = 1e7;
/// Quantile of the curvatures that pairs of cuts prove: at ½, runs of PBC3 hang on the last bit; at 1, the mean over
/// the collection rises by 5 %.
const QUANTILE: f64 = 0.8;
/// Number of variables from which subproblems are solved with the inner products of the slopes: with fewer, orthogonal
/// factors of the slopes cost little.
pub(super) const MANY_VARIABLES: usize = 100;

impl Model {
    /// Builds the model at the center. Slopes that stay are taken over from the `former` model.
    pub(crate) fn new(state: &mut BundleState, config: &BundleTrustConfig, former: Option<Self>) -> Self {
        let center = state.bundle.position(state.center_id);
        let (errors, distances) = state.errors_at_center(center.unwrap_or(0));
        let rounding = state.rounding();
        let convex = config.convexity == Convexity::Convex;
        let c = if convex { 0.0 } else { convexification(state, config, &errors, &distances) };
        let mut known = former.into_iter().flat_map(Self::into_plain_slopes).peekable();
        let mut model = Self {
            slopes: vec![],
            offsets: vec![],
            ids: vec![],
            convexification: c,
            shares: vec![],
            center,
            tilted: None,
        };
        for (cut, (&error, &distance)) in state.bundle.cuts().iter().zip(errors.iter().zip(&distances)) {
            // A value that may be too high by its promised error must not put the cut above Θ.
            let promised = if cut.id == state.center_id { 0.0 } else { cut.excess() + state.center_error_bound() };
            let excess = -(error + promised);
            if convex && excess > NOISE_MARGIN * (promised + rounding.max(cut.rounding_at(&state.center))) {
                state.noise = state.noise.max(excess);
            }
            model.slopes.push(if c > 0.0 {
                let tilt = state.norm.lower_index(&(&state.center - &cut.point));
                &cut.subgradient - tilt * (2.0 * c)
            } else {
                while known.next_if(|(id, _)| *id < cut.id).is_some() {}
                known.next_if(|(id, _)| *id == cut.id).map_or_else(|| cut.subgradient.clone(), |(_, slope)| slope)
            });
            model.offsets.push(offset(error, c * distance, promised, convex));
            model.ids.push(cut.id);
        }
        state.nonconvex |= c > 0.0;
        model.soften(state);
        let mixed = model.shares.iter().any(|share| *share < 1.0);
        if c > 0.0 && !mixed && state.center.len() >= MANY_VARIABLES {
            model.tilted = model.tilted_products(state);
        }
        model
    }

    /// The slopes that are subgradients as they are, with the identities of their cuts, which ascend.
    fn into_plain_slopes(self) -> impl Iterator<Item = (u64, Vector)> {
        let plain = self.convexification == 0.0;
        let slopes = self.ids.into_iter().zip(self.slopes).zip(self.shares);
        slopes.filter(move |(_, share)| plain && *share == 1.0).map(|(slope, _)| slope)
    }

    /// Replaces cuts of extreme slope by θ·cut + (1 − θ)·center's cut. The mixture lies below the model, and meets the
    /// center's cut where the cut itself does.
    fn soften(&mut self, state: &BundleState) {
        self.shares = vec![1.0; self.slopes.len()];
        let Some(center) = self.center else { return };
        let norms: Vec<f64> = if self.convexification > 0.0 {
            self.slopes.iter().map(|slope| state.norm.dual_length(slope)).collect()
        } else {
            state.bundle.dual_lengths().collect()
        };
        let median = upper_median(&mut norms.clone()).unwrap_or(0.0);
        let limit = MAX_RELATIVE_SLOPE * median.max(norms[center]);
        for (i, norm) in norms.iter().enumerate().filter(|(_, norm)| **norm > limit && limit > 0.0) {
            // The center's cut is below the limit.
            let share = limit / norm;
            self.slopes[i] = &self.slopes[i] * share + &self.slopes[center] * (1.0 - share);
            self.offsets[i] = share * self.offsets[i] + (1.0 - share) * self.offsets[center];
            self.shares[i] = share;
        }
    }

    /// Whether the cut at a position stands in the model alone, not mixed with the center's cut.
    pub(crate) fn is_whole(&self, position: usize) -> bool {
        self.shares[position] == 1.0
    }

    /// The inner products of the slopes with the weight of the run, formed from those of the bundle; none where a cut
    /// was mixed, or tilted without a table of its own.
    pub(crate) fn products<'s>(&'s self, state: &'s BundleState) -> Option<Gram<'s>> {
        let rows = match &self.tilted {
            Some(tilted) => tilted,
            None if self.convexification > 0.0 || self.shares.iter().any(|share| *share < 1.0) => return None,
            None => state.bundle.pairs().products(),
        };
        let (slots, lasting) = (state.bundle.pairs().slots(), self.tilted.is_none());
        Some(Gram { rows, slots, weight: state.weight, lasting })
    }

    /// Inner products of the tilted slopes by slots.
    ///
    /// ```text
    /// ⟨h_i, W⁻¹h_j⟩ = ⟨g_i, W⁻¹g_j⟩ − 2c (⟨g_i, p_j⟩ + ⟨g_j, p_i⟩) + 4c² p_iᵀW p_j
    /// ```
    fn tilted_products(&self, state: &BundleState) -> Option<Vec<Vec<f64>>> {
        let (pairs, c, center) = (state.bundle.pairs(), self.convexification, self.center?);
        let mut rows = pairs.products().to_vec();
        for (i, &row) in pairs.slots().iter().enumerate() {
            for (j, &column) in pairs.slots().iter().enumerate() {
                let crossed = pairs.slope(i, center) - pairs.slope(i, j) + pairs.slope(j, center) - pairs.slope(j, i);
                let distances = pairs.distance(i, center) + pairs.distance(j, center) - pairs.distance(i, j);
                rows[row][column] += 2.0 * c * (c * distances - crossed);
            }
        }
        Some(rows)
    }

    /// The cuts as the subproblem sees them.
    pub(crate) fn cuts(&self) -> Cuts<'_> {
        Cuts { slopes: &self.slopes, offsets: &self.offsets, ids: &self.ids, gram: None }
    }

    /// Multipliers of the cuts themselves from those of the subproblem.
    pub(crate) fn distribute(&self, multipliers: &mut [f64]) {
        let Some(center) = self.center else { return };
        let mut moved = 0.0;
        for (multiplier, share) in multipliers.iter_mut().zip(&self.shares) {
            moved += *multiplier * (1.0 - share);
            *multiplier *= share;
        }
        multipliers[center] += moved;
    }
}

/// The curvature c that the bundle proves to be necessary.
fn convexification(state: &BundleState, config: &BundleTrustConfig, errors: &[f64], distances: &[f64]) -> f64 {
    let resolution = VALUE_ROUNDING * state.value_scale(config) + NOISE_MARGIN * state.noise;
    let pairs = quantile(&state.bundle.proven_curvatures(resolution), QUANTILE);
    let cuts = state.bundle.cuts().iter().zip(errors.iter().zip(distances));
    let above = cuts.filter(|(cut, (error, distance))| {
        -**error > cut.excess() + state.center_error_bound() + resolution && **distance > 0.0
    });
    above.map(|(_, (error, distance))| -error / distance).fold(pairs, f64::max)
}

/// Linear interpolation in an ascending list; 0 for an empty one.
fn quantile(ascending: &[f64], share: f64) -> f64 {
    let Some(last) = ascending.len().checked_sub(1) else { return 0.0 };
    let position = share * last as f64;
    let (below, above) = (position.floor() as usize, position.ceil() as usize);
    ascending[below] + (ascending[above] - ascending[below]) * (position - below as f64)
}
