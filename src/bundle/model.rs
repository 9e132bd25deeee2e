//! The convexified cutting-plane model around the center.
//!
//! ```text
//! m(d) = max_i { ⟨h_i, d⟩ − a_i },   h_i = g_i − 2c W p_i,   a_i = max(e_i + c‖p_i‖², |e_i|),   p_i = x̂ − y_i
//! c = max( quantile of −E_ij/‖y_i − y_j‖² over concave pairs,  −e_i/‖p_i‖² )
//! ```
//! c = 0 as long as no pair of cuts proves Θ nonconvex: then this is the plain model of a convex function.
//! References: [SchrammZowe1992] (bundle-trust), [HareSagastizabal2010] (tilted cuts).

use super::config::Convexity;
use super::state::State;
use crate::{BundleTrustConfig, Vector};

/// Slopes and offsets of the model, in the order of the cuts.
#[derive(Debug, Clone)]
pub(crate) struct Model {
    pub slopes: Vec<Vector>,
    pub offsets: Vec<f64>,
    pub ids: Vec<u64>,
    /// The curvature c added to make the model convex.
    pub convexification: f64,
}

impl Model {
    /// Builds the model at the center.
    pub(crate) fn new(state: &mut State, config: &BundleTrustConfig) -> Self {
        state.bundle.compare_pairs(&state.norm);
        let errors: Vec<f64> = state.errors_at_center();
        let distances: Vec<f64> =
            state.bundle.cuts().iter().map(|cut| state.norm.squared_distance(&state.center, &cut.point)).collect();
        let c = match config.convexity {
            Convexity::Unknown => convexification(state, config, &errors, &distances),
            Convexity::Convex => 0.0,
        };
        let mut model = Self { slopes: vec![], offsets: vec![], ids: vec![], convexification: c };
        for (cut, (&error, &distance)) in state.bundle.cuts().iter().zip(errors.iter().zip(&distances)) {
            let offset = (error + c * distance).max(error.abs());
            let tilt = state.norm.lower_index(&(&state.center - &cut.point));
            model.slopes.push(if c > 0.0 { &cut.subgradient - tilt * (2.0 * c) } else { cut.subgradient.clone() });
            model.offsets.push(offset);
            model.ids.push(cut.id);
        }
        state.nonconvex |= c > 0.0;
        model
    }
}

/// The curvature c that the bundle proves to be necessary.
fn convexification(state: &State, config: &BundleTrustConfig, errors: &[f64], distances: &[f64]) -> f64 {
    let resolution = 1e-6 * state.length_scale();
    let value_resolution = 1e-9 * state.value_scale(config);
    let curvatures = state.bundle.proven_curvatures(resolution, value_resolution);
    let pairs = quantile(&curvatures, config.curvature_quantile);
    let mut at_center = 0.0_f64;
    for (cut, (error, distance)) in state.bundle.cuts().iter().zip(errors.iter().zip(distances)) {
        let allowance = cut.error_bound + state.center_error_bound();
        if *error < -0.1 * value_resolution - allowance && *distance > 0.0 {
            at_center = at_center.max(-error / distance);
        }
    }
    pairs.max(at_center)
}

/// Linear interpolation in an ascending list; 0 for an empty one.
fn quantile(ascending: &[f64], share: f64) -> f64 {
    let Some(last) = ascending.len().checked_sub(1) else { return 0.0 };
    let position = share * last as f64;
    let (below, above) = (position.floor() as usize, position.ceil() as usize);
    ascending[below] + (ascending[above] - ascending[below]) * (position - below as f64)
}
