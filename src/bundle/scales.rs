//! The sizes that "small" refers to, from the data seen: values, subgradients, distances travelled.
//!
//! ```text
//! reach_i = max(|x̂_i|, |x̂_i − x⁰_i|)        size_i = max(|x̂_i|, 1e-8 reach_i)
//! variation = max( min( highest − Θ(x̂),  median of Σ_i |g_i| size_i over the cuts within ‖size‖ of x̂ ),
//!                  Σ_k size_k Σ_i |w_i| |G_ik| of a composite Θ )
//!             then times 10 variation/|Θ(x̂)|, clamped to [0.02, 1]
//! scale     = |Θ(x̂)| clamped to [1e-6 least, variation], or to [1e-7 least, variation] for a Θ declared convex
//! least     = min( highest − Θ(x̂),  max( Σ_j λ_j Σ_i |g_ji| reach_i,  h(c ± |G| reach) − h(c) of a composite Θ ) )
//! ```
//! Here `highest` is the highest value at the start and in the bundle. Decreases and sums do not change if Θ is
//! shifted, and the sums do not depend on the units of the variables. Cuts farther away than the variables are large
//! tell nothing about the values near x̂. A run that has not gone anywhere has seen no variation, unless outputs tell
//! it: nothing is small yet.

use super::config::{BundleTrustConfig, Convexity};
use super::kept_cuts::Spread;
use super::state::{BundleState, Lengths, OutputScales};
use crate::Vector;
use crate::linalg::upper_median;
use crate::qp::kernels::{dot_terms, two_dot_terms};
use std::rc::Rc;

/// Sizes of a variable below this share of its reach are not told from zero.
const LEAST_SHARE: f64 = 1e-8;
/// The least scale of Θ, as a share of what the active cuts vary within reach.
const LEAST_VALUE_SHARE: f64 = 1e-6;
/// The least scale of a Θ that is declared convex, as a share of what the active cuts vary within reach. A termination
/// of a convex Θ rests on a bound, which needs a smaller share: with 1e-6, bounds of 2e-5 counted as small after starts
/// 1e6 times too far.
const LEAST_CONVEX_SHARE: f64 = 1e-7;
/// Values beyond this many times their variation carry a shift.
const MAX_VALUE_SHARE: f64 = 10.0;
/// Where values carry a shift, the variation alone tells the scale, and only this share of it counts: without a shift
/// the values near a minimum are that much smaller than the terms of their linearizations.
const SHIFTED_SHARE: f64 = 0.02;

impl BundleState {
    /// How far a variable lies from zero or from its start, whichever is more.
    pub(crate) fn reach(&self, i: usize) -> f64 {
        self.center[i].abs().max((self.center[i] - self.start[i]).abs())
    }

    /// How far each variable lies from zero or from its start.
    pub(crate) fn reaches(&self) -> Vector {
        Vector::from_fn(self.center.len(), |i, _| self.reach(i))
    }

    /// The lengths that belong to the center; formed once per center.
    fn lengths(&self) -> Rc<Lengths> {
        let mut known = self.lengths.borrow_mut();
        match &*known {
            Some((center, lengths)) if *center == self.center_id => Rc::clone(lengths),
            _ => {
                let reach = self.reaches();
                let size = self.center.zip_map(&reach, |x, reach| x.abs().max(LEAST_SHARE * reach));
                let lengths = Rc::new(Lengths { squared: self.norm.squared(&size), size, reach });
                *known = Some((self.center_id, Rc::clone(&lengths)));
                lengths
            }
        }
    }

    /// The scale of Θ near the center that relative tolerances refer to.
    pub(crate) fn natural_scale(&self, config: &BundleTrustConfig) -> f64 {
        config.objective_scale.unwrap_or_else(|| {
            let drop = self.drop_from(self.highest_kept());
            let outputs = self.output_variation();
            let mut variation = drop.min(self.linear_variation()).max(outputs.size);
            let size = self.center_value.abs();
            if size > 0.0 {
                variation *= (MAX_VALUE_SHARE * variation / size).clamp(SHIFTED_SHARE, 1.0);
            }
            let convex = config.convexity == Convexity::Convex;
            let share = if convex { LEAST_CONVEX_SHARE } else { LEAST_VALUE_SHARE };
            let least = share * drop.min(self.active_variation().max(outputs.reach));
            size.clamp(least.min(variation), variation)
        })
    }

    /// Σ |g_i| size_i and Σ |g_i| reach_i of the cut at a position.
    fn spread(&self, position: usize, lengths: &Lengths) -> Spread {
        self.bundle.spread(position, self.center_id, |cut| {
            let slope = cut.subgradient.as_slice();
            let [size, reach] = two_dot_terms(slope, lengths.size.as_slice(), lengths.reach.as_slice());
            Spread { size, reach }
        })
    }

    /// Median of Σ |g_i| size_i over the cuts within the size of the variables.
    fn linear_variation(&self) -> f64 {
        let lengths = self.lengths();
        let Some(center) = self.bundle.position(self.center_id) else { return 0.0 };
        let near = |i: &usize| self.bundle.pairs().distance(*i, center) <= lengths.squared;
        let mut terms: Vec<f64> =
            (0..self.bundle.cuts().len()).filter(near).map(|i| self.spread(i, &lengths).size).collect();
        upper_median(&mut terms).unwrap_or(0.0)
    }

    /// How far Θ varies by its outputs, also where its subgradients vanish, as at a smooth minimum.
    fn output_variation(&self) -> Spread {
        let Some(OutputScales { slopes, within_reach }) = &self.output_scales else {
            return Spread { size: 0.0, reach: 0.0 };
        };
        Spread { size: dot_terms(slopes.as_slice(), self.lengths().size.as_slice()), reach: *within_reach }
    }

    /// Σ λ_j Σ |g_ji| reach_i: the terms that cancel in the aggregate subgradient.
    pub(crate) fn active_variation(&self) -> f64 {
        let lengths = self.lengths();
        let cuts = self.bundle.cuts().iter().enumerate().filter(|(_, cut)| cut.is_active());
        cuts.map(|(i, cut)| cut.multiplier * self.spread(i, &lengths).reach).sum()
    }
}
