//! The entry point: configuration, admissible set, observers, stopping rules.

use super::config::BundleTrustConfig;
use crate::report::{Observer, StopRule};
use crate::{InputError, Polyhedron};

/// The bundle-trust method with its settings.
///
/// ```
/// use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Polyhedron, Vector};
/// // |x₁| + 2x₂² over x₁ ≥ 1
/// let theta = FnObjective::new(2, |x: &Vector| {
///     (x[0].abs() + 2.0 * x[1] * x[1], Vector::from_vec(vec![x[0].signum(), 4.0 * x[1]]))
/// });
/// let lower = Vector::from_vec(vec![1.0, f64::NEG_INFINITY]);
/// let set = Polyhedron::boxed(lower, Vector::from_element(2, f64::INFINITY))?;
/// let report = BundleTrust::new(BundleTrustConfig::default())?
///     .constraints(set)
///     .minimize(&theta, Vector::from_vec(vec![3.0, 2.0]))?;
/// assert!((report.value - 1.0).abs() < 1e-6);
/// assert!(report.termination.is_stationary());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct BundleTrust<'o> {
    pub(super) config: BundleTrustConfig,
    pub(super) constraints: Option<Polyhedron>,
    pub(super) observers: Vec<Box<dyn Observer + 'o>>,
    pub(super) stop: Option<StopRule>,
}

impl std::fmt::Debug for BundleTrust<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("BundleTrust")
            .field("config", &self.config)
            .field("constraints", &self.constraints)
            .field("observers", &self.observers.len())
            .field("stop", &self.stop)
            .finish()
    }
}

impl<'o> BundleTrust<'o> {
    /// The method with validated settings, without constraints and observers.
    ///
    /// # Errors
    /// As [`BundleTrustConfig::validate`].
    pub fn new(config: BundleTrustConfig) -> Result<Self, InputError> {
        config.validate()?;
        Ok(Self { config, constraints: None, observers: vec![], stop: None })
    }

    /// The admissible set; the whole space if never called.
    #[must_use]
    pub fn constraints(mut self, set: Polyhedron) -> Self {
        self.constraints = Some(set);
        self
    }

    /// Adds an observer, which sees every evaluation and may end the run.
    #[must_use]
    pub fn observer(mut self, observer: impl Observer + 'o) -> Self {
        self.observers.push(Box::new(observer));
        self
    }

    /// Adds a stopping rule; the run ends as soon as one of the added rules holds.
    #[must_use]
    pub fn stop_when(mut self, rule: StopRule) -> Self {
        self.stop = Some(match self.stop.take() {
            Some(first) => first | rule,
            None => rule,
        });
        self
    }

    /// The settings with which this method runs.
    pub fn config(&self) -> &BundleTrustConfig {
        &self.config
    }
}
