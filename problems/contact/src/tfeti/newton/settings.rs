//! Settings of Newton's method on the dual problem.

use crate::work_estimate::MAX_PRODUCTS;

/// When to stop, and whether directions are recycled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonSettings {
    /// Relative residual aimed at.
    pub tolerance: f64,
    /// Relative residual that is accepted when rounding stops all progress.
    pub acceptable: f64,
    pub max_steps: usize,
    /// Krylov iterations allowed per Newton step; the descent ends with twice as many directions.
    pub max_krylov: usize,
    /// Products with F allowed in all.
    pub max_products: usize,
    /// Whether dual directions are kept over a whole solve.
    pub recycling: Recycling,
}

/// Tightest relative residual aimed at: below it rounding decides.
const TIGHTEST_TOLERANCE: f64 = 2e-13;

/// Tightest relative residual that is insisted on.
const TIGHTEST_ACCEPTABLE: f64 = 1e-9;

impl NewtonSettings {
    /// Settings for a relative residual; 0 asks for all that rounding allows.
    pub fn to(tolerance: f64) -> Self {
        Self {
            tolerance: tolerance.max(TIGHTEST_TOLERANCE),
            acceptable: tolerance.max(TIGHTEST_ACCEPTABLE),
            max_steps: 60,
            max_krylov: 400,
            max_products: MAX_PRODUCTS,
            recycling: Recycling::default(),
        }
    }

    /// Products with F that are left after so many.
    pub(crate) fn products_left(&self, applications: usize) -> usize {
        self.max_products.saturating_sub(applications)
    }
}

/// Rigid amplitudes of subdomains at the contact boundary up to which directions are recycled: with more, the repeated
/// factorisation of their dense matrix outweighs the products saved.
const MAX_CONTACT_AMPLITUDES: usize = 2100;

/// Use of the dual directions that a solve has already multiplied with F.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Recycling {
    /// Every product serves all later iterates: fewest products with F, more dense algebra. Beyond 2100 rigid
    /// amplitudes of subdomains at the contact boundary, whose dense matrix every active set factors, it counts as
    /// [`Recycling::Off`].
    #[default]
    On,
    /// Newton steps with a GMRES of their own.
    Off,
}

impl Recycling {
    /// Whether directions are recycled with so many rigid amplitudes at the contact boundary.
    pub(crate) fn pays(self, contact_amplitudes: usize) -> bool {
        self == Self::On && contact_amplitudes <= MAX_CONTACT_AMPLITUDES
    }
}
