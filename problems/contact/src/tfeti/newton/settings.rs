//! Settings of Newton's method on the dual problem.

use crate::tfeti::dual::CoarseSpace;
use crate::work_estimate::MAX_PRODUCTS;

/// When to stop, and whether directions are recycled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonSettings {
    /// Relative residual aimed at.
    pub tolerance: f64,
    /// Relative residual that is accepted when rounding stops all progress.
    pub acceptable: f64,
    /// Newton steps allowed.
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
}

/// Use of the dual directions that a solve has already multiplied with F.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Recycling {
    /// On unless the coarse problem is so large that its repeated factorisation outweighs the products saved.
    #[default]
    Auto,
    /// Every product serves all later iterates: fewest products with F, more dense algebra.
    On,
    /// Newton steps with a GMRES of their own.
    Off,
}

/// Coarse unknowns up to which recycling is used. Up to 7³ subdomains its coarse factorisations were measured to be affordable;
/// beyond, their cubic cost is expected to outweigh the products saved (not measured).
const MAX_RECYCLED_COARSE_UNKNOWNS: usize = 2100;

impl Recycling {
    /// Whether directions are recycled over a coarse space.
    pub fn pays(self, space: &CoarseSpace) -> bool {
        match self {
            Self::Auto => space.resultants().len() <= MAX_RECYCLED_COARSE_UNKNOWNS,
            Self::On => true,
            Self::Off => false,
        }
    }
}
