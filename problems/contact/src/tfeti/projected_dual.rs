//! The orthonormalised projected dual operator, as the QP solver sees it.
//!
//! ```text
//! C = L⁻¹G,  LLᵀ = GGᵀ,   Q = CᵀC,   P = I − Q        H = P F P,   preconditioner of H + ρQ:  P M P + Q/ρ
//! ```

use crate::error::ContactError;
use crate::linear::dense::DenseCholesky;
use crate::linear::vector::add_scaled;
use crate::qp::{LinearEqualities, SymmetricOperator};
use crate::tfeti::{CoarseSpace, DualOperator, Preconditioner};

/// Rows C and right side L⁻¹e of the equilibrium of all subdomains.
#[derive(Debug)]
pub struct OrthonormalCoarse<'a> {
    space: &'a CoarseSpace,
    factor: DenseCholesky,
    right_side: Vec<f64>,
}

impl<'a> OrthonormalCoarse<'a> {
    /// Orthonormalises the rows of G.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the rows leave a rigid motion free.
    pub fn new(space: &'a CoarseSpace) -> Result<Self, ContactError> {
        let factor = DenseCholesky::new(space.gram()).map_err(|error| ContactError::Factorization {
            what: "coarse matrix of all rows".into(),
            reason: format!("{}: the rows leave a rigid motion free", error.reason),
        })?;
        let mut coarse = Self { space, factor, right_side: Vec::new() };
        coarse.right_side = coarse.lower_solve(space.resultants.clone());
        Ok(coarse)
    }

    fn lower_solve(&self, mut v: Vec<f64>) -> Vec<f64> {
        self.factor.solve_lower_in_place(&mut v);
        v
    }

    /// v ← P v.
    pub fn project(&self, v: &mut [f64]) {
        let removed = self.apply_transposed(&self.apply(v));
        add_scaled(v, -1.0, &removed);
    }
}

impl LinearEqualities for OrthonormalCoarse<'_> {
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        self.lower_solve(self.space.resultant(x))
    }

    fn apply_transposed(&self, y: &[f64]) -> Vec<f64> {
        let mut amplitudes = y.to_vec();
        self.factor.solve_upper_in_place(&mut amplitudes);
        self.space.jumps(&amplitudes)
    }

    fn right_side(&self) -> &[f64] {
        &self.right_side
    }
}

/// P F P.
#[derive(Debug)]
pub struct ProjectedDual<'a> {
    operator: &'a DualOperator<'a>,
    coarse: &'a OrthonormalCoarse<'a>,
}

impl<'a> ProjectedDual<'a> {
    /// The operator of one shape.
    pub fn new(operator: &'a DualOperator<'a>, coarse: &'a OrthonormalCoarse<'a>) -> Self {
        Self { operator, coarse }
    }

    /// P (d − F λ₀) with λ₀ = Gᵀ(GGᵀ)⁻¹e.
    pub fn homogenised(&self, constant: &[f64]) -> Vec<f64> {
        let image = self.operator.apply(&self.coarse.apply_transposed(self.coarse.right_side()));
        let mut linear: Vec<f64> = constant.iter().zip(&image).map(|(d, image)| d - image).collect();
        self.coarse.project(&mut linear);
        linear
    }
}

impl SymmetricOperator for ProjectedDual<'_> {
    fn dimension(&self) -> usize {
        self.operator.model.constraints.row_count()
    }

    fn apply(&self, x: &[f64], result: &mut [f64]) {
        let mut projected = x.to_vec();
        self.coarse.project(&mut projected);
        result.copy_from_slice(&self.operator.apply(&projected));
        self.coarse.project(result);
    }
}

/// P M P + Q/ρ.
#[derive(Debug)]
pub struct ProjectedPreconditioner<'a> {
    preconditioner: &'a Preconditioner<'a>,
    coarse: &'a OrthonormalCoarse<'a>,
    rho: f64,
}

impl<'a> ProjectedPreconditioner<'a> {
    /// The preconditioner for a penalty ρ.
    pub fn new(preconditioner: &'a Preconditioner<'a>, coarse: &'a OrthonormalCoarse<'a>, rho: f64) -> Self {
        Self { preconditioner, coarse, rho }
    }
}

impl SymmetricOperator for ProjectedPreconditioner<'_> {
    fn dimension(&self) -> usize {
        self.preconditioner_rows()
    }

    fn apply(&self, x: &[f64], result: &mut [f64]) {
        let rigid = self.coarse.apply_transposed(&self.coarse.apply(x));
        let elastic: Vec<f64> = x.iter().zip(&rigid).map(|(x, rigid)| x - rigid).collect();
        result.copy_from_slice(&self.preconditioner.apply(&elastic));
        self.coarse.project(result);
        add_scaled(result, 1.0 / self.rho, &rigid);
    }
}

impl ProjectedPreconditioner<'_> {
    fn preconditioner_rows(&self) -> usize {
        self.coarse.space.rows.row_count()
    }
}
