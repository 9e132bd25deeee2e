//! Programs with equalities: data, constants of the outer loop, warm starts, results.

use crate::qp::mpgp::setting;
use crate::qp::{LinearEqualities, MpgpSettings, QpError, SeparableSet, StepCounts, SymmetricOperator};

/// The data of a program.
#[derive(Clone, Copy)]
pub struct QuadraticProgram<'a> {
    /// H, positive definite on the kernel of C.
    pub hessian: &'a dyn SymmetricOperator,
    /// b.
    pub linear: &'a [f64],
    /// Ω.
    pub set: &'a SeparableSet,
    /// C x = e; C has no rows where there are no equalities.
    pub equalities: &'a dyn LinearEqualities,
}

impl QuadraticProgram<'_> {
    /// C x − e.
    pub(crate) fn defect(&self, x: &[f64]) -> Vec<f64> {
        let image = self.equalities.apply(x);
        image.iter().zip(self.equalities.right_side()).map(|(image, e)| image - e).collect()
    }
}

/// Constants of the outer loop; see [`smalse`](crate::qp::smalse) for ρ, M, β, η and μ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmalseSettings {
    /// ρ over |H|/|C|², > 0. Default 1.
    pub penalty: f64,
    /// First M over ρ|C|, > 0. Default 1.
    pub first_m: f64,
    /// β, the factor of M, in (0, 1). Default 0.8.
    pub beta: f64,
    /// η > 0. Default 1.
    pub eta: f64,
    /// Updates of μ allowed. Default 500.
    pub max_outer: usize,
    /// Lanczos steps for |H| when it is not known; a low estimate costs steps, not correctness. Default 5.
    pub norm_steps: usize,
    /// Constants of the inner solver.
    pub inner: MpgpSettings,
}

impl Default for SmalseSettings {
    fn default() -> Self {
        Self {
            penalty: 1.0,
            first_m: 1.0,
            beta: 0.8,
            eta: 1.0,
            max_outer: 500,
            norm_steps: 5,
            inner: MpgpSettings::default(),
        }
    }
}

impl SmalseSettings {
    /// Checks every constant.
    ///
    /// # Errors
    /// [`QpError::Setting`].
    pub fn validate(&self) -> Result<(), QpError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        setting("penalty", self.penalty, "finite and > 0", positive(self.penalty))?;
        setting("first_m", self.first_m, "finite and > 0", positive(self.first_m))?;
        setting("beta", self.beta, "in (0, 1)", self.beta > 0.0 && self.beta < 1.0)?;
        setting("eta", self.eta, "> 0", self.eta > 0.0)?;
        setting("norm_steps", self.norm_steps as f64, "at least 1", self.norm_steps > 0)?;
        self.inner.validate()
    }
}

/// What a similar program may start from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WarmStart {
    /// x; projected onto Ω.
    pub x: Vec<f64>,
    /// H x without the penalty, if known for exactly this x and x is feasible: saves one product.
    pub image: Option<Vec<f64>>,
    /// μ.
    pub multipliers: Vec<f64>,
    /// M, absolute; none for the default.
    pub m: Option<f64>,
    /// |H|; none to have it estimated.
    pub norm: Option<f64>,
}

/// The end of a run.
#[derive(Debug, Clone)]
pub struct SmalseSolution {
    /// What a similar program may start from; holds x and μ.
    pub warm: WarmStart,
    /// H x − b + Cᵀμ.
    pub gradient: Vec<f64>,
    /// |g̃|.
    pub reduced_gradient: f64,
    /// |C x − e|.
    pub infeasibility: f64,
    /// Updates of μ.
    pub outer: usize,
    /// Work.
    pub counts: StepCounts,
    /// Whether the accuracy asked for was reached (otherwise rounding stopped all progress).
    pub converged: bool,
}
