//! What counts as small at a center: the tolerance in units of Θ, what rounding hides, and the noise of the oracle.

use super::config::{AccuracyPolicy, BundleTrustConfig};
use super::cut::Cut;
use super::state::BundleState;

/// Noise, or an error, below this share of the wanted decrease does not matter. A larger share calls small noise by its
/// name and ends runs earlier.
const NEGLIGIBLE_SHARE: f64 = 1e-3;
/// Noise explains decreases up to this many times the noise of two values.
const MAX_NOISY_DECREASES: f64 = 4.0;

/// The levels below which decreases of Θ at a center say nothing, in units of Θ.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Resolution {
    /// The tolerance times the scale of Θ.
    pub wanted: f64,
    /// Decreases that differences of the values behind the active cuts cannot resolve.
    pub rounding: f64,
    /// Noise seen in the values or promised by the oracle and not to be reduced by asking for more accuracy.
    pub noise_level: f64,
}

impl Resolution {
    pub(crate) fn new(state: &BundleState, config: &BundleTrustConfig) -> Self {
        Self {
            wanted: config.tolerance * state.natural_scale(config),
            rounding: state.rounding(),
            noise_level: noise_level(state, config),
        }
    }

    /// The tolerance in units of Θ, plus what rounding hides.
    pub(crate) fn tolerance(&self) -> f64 {
        self.wanted + self.rounding
    }

    /// A decrease that is negligible beside the wanted one, or hidden by rounding.
    pub(crate) fn negligible(&self) -> f64 {
        NEGLIGIBLE_SHARE * self.wanted + self.rounding
    }

    /// Noise of the oracle; none where it is negligible beside the wanted decrease.
    pub(crate) fn noise(&self) -> Option<f64> {
        (self.noise_level > NEGLIGIBLE_SHARE * self.wanted).then_some(self.noise_level)
    }

    /// Predicted decrease that counts as small: the noise where it is not negligible, otherwise the tolerance.
    pub(crate) fn small(&self) -> f64 {
        self.noise().unwrap_or_else(|| self.tolerance())
    }

    /// The decrease up to which noise explains what a model promises; 0 without noise.
    pub(crate) fn hidden_by_noise(&self) -> f64 {
        self.noise().map_or(0.0, |noise| MAX_NOISY_DECREASES * noise)
    }
}

fn noise_level(state: &BundleState, config: &BundleTrustConfig) -> f64 {
    let center = state.center_error_bound();
    let promised = match config.accuracy {
        AccuracyPolicy::Tightest => {
            let active = state.bundle.cuts().iter().filter(|cut| cut.is_active());
            center + active.map(Cut::excess).fold(0.0, f64::max)
        }
        AccuracyPolicy::OnDemand { tightest, .. } => {
            let asked = state.center_accuracy;
            let refused = center > 2.0 * asked * state.center_value.abs();
            if asked <= 2.0 * tightest || refused { center } else { 0.0 }
        }
    };
    state.noise.max(promised)
}
