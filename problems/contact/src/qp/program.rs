//! Programs with equalities: data, limits, warm starts, results.

use crate::qp::{LinearEqualities, SeparableSet, StepCounts, SymmetricOperator};

/// The data of a program.
#[derive(Clone, Copy)]
pub struct QuadraticProgram<'a> {
    /// H, positive definite on the kernel of C.
    pub hessian: &'a dyn SymmetricOperator,
    /// The linear term b.
    pub linear: &'a [f64],
    /// The feasible set Ω.
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

/// Limits on the work for one program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QpLimits {
    /// Updates of μ. Default 500.
    pub outer: usize,
    /// Products with H of the inner solver. Default 20 000.
    pub products: usize,
}

impl Default for QpLimits {
    fn default() -> Self {
        Self { outer: 500, products: 20_000 }
    }
}

/// What a similar program may start from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WarmStart {
    /// x; projected onto Ω.
    pub x: Vec<f64>,
    /// H x without the penalty, if known for exactly this x and x is feasible: saves one product.
    pub image: Option<Vec<f64>>,
    /// Multipliers μ of the equalities.
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
    /// Norm |g̃| of the reduced gradient.
    pub reduced_gradient: f64,
    /// |C x − e|.
    pub infeasibility: f64,
    /// Number of updates of μ.
    pub outer: usize,
    /// Steps of the inner method.
    pub counts: StepCounts,
    /// Whether the accuracy asked for was reached (otherwise rounding stopped all progress).
    pub converged: bool,
}
