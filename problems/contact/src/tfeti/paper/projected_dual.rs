//! The orthonormalised projected dual operator, as an operator of the QP solver.
//!
//! ```text
//! C = L⁻¹G,  LLᵀ = GGᵀ in the elimination order,   Q = CᵀC,   P = I − Q        H = P F P,   preconditioner of H + ρQ:  P M P + Q/ρ
//! ```
//! Vectors of the QP solver go over the rows of all processes, and every process has them; products with F, M and G are
//! shared.

use crate::error::ContactError;
use crate::linear::cholesky::NumericFactor;
use crate::linear::vector::add_scaled;
use crate::qp::{LinearEqualities, SymmetricOperator};
use crate::tfeti::dual::{CoarseSpace, DualOperator, Preconditioner};
use crate::tfeti::torn::{RowVector, TornModel};

/// Rows C and right side L⁻¹e of the equilibrium of all subdomains.
#[derive(Debug)]
pub struct OrthonormalCoarse<'a> {
    space: &'a CoarseSpace,
    model: &'a TornModel,
    factor: NumericFactor,
    right_side: Vec<f64>,
}

impl<'a> OrthonormalCoarse<'a> {
    /// Orthonormalises the rows of G.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the rows leave a rigid motion free.
    pub fn new(space: &'a CoarseSpace, model: &'a TornModel) -> Result<Self, ContactError> {
        let factor = space.timed(|| space.gram_factor())?;
        let mut coarse = Self { space, model, factor, right_side: Vec::new() };
        coarse.right_side = coarse.lower_solve(space.resultants());
        Ok(coarse)
    }

    /// Number of rows of all processes.
    fn row_count(&self) -> usize {
        self.model.constraints.total_equality_count + self.model.problem.boundary.row_count
    }

    /// L⁻¹ v, in the elimination order of the factor.
    fn lower_solve(&self, v: &[f64]) -> Vec<f64> {
        self.space.timed(|| {
            let mut ordered: Vec<f64> = self.factor.order().iter().map(|&old| v[old]).collect();
            self.factor.eliminate(v.len(), &mut ordered);
            ordered
        })
    }

    /// The jumps Cᵀ y.
    fn jumps(&self, y: &[f64]) -> Vec<f64> {
        self.space.timed(|| {
            let mut ordered = y.to_vec();
            self.factor.substitute(y.len(), &mut ordered);
            let mut amplitudes = vec![0.0; y.len()];
            for (&old, entry) in self.factor.order().iter().zip(ordered) {
                amplitudes[old] = entry;
            }
            self.whole(&self.space.jumps(&amplitudes))
        })
    }

    /// Over all rows, from the rows of this process.
    pub fn whole(&self, own: &RowVector) -> Vec<f64> {
        self.model.constraints.whole(own, &self.model.distribution)
    }

    /// The rows of this process.
    fn own(&self, whole: &[f64]) -> RowVector {
        self.model.constraints.own_rows(whole)
    }

    /// The product Q v.
    fn rigid_part(&self, v: &[f64]) -> Vec<f64> {
        self.jumps(&self.apply(v))
    }

    /// The product P v.
    fn projected(&self, v: &[f64]) -> Vec<f64> {
        difference(v, self.rigid_part(v))
    }
}

/// The difference v − removed.
fn difference(v: &[f64], mut removed: Vec<f64>) -> Vec<f64> {
    removed.iter_mut().zip(v).for_each(|(removed, v)| *removed = v - *removed);
    removed
}

impl LinearEqualities for OrthonormalCoarse<'_> {
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        self.lower_solve(&self.space.resultant(&self.own(x)))
    }

    fn apply_transposed(&self, y: &[f64]) -> Vec<f64> {
        self.jumps(y)
    }

    fn right_side(&self) -> &[f64] {
        &self.right_side
    }
}

/// The operator P F P.
#[derive(Debug)]
pub struct ProjectedDual<'a> {
    /// F of one shape.
    pub operator: &'a DualOperator<'a>,
    /// The matrix C.
    pub coarse: &'a OrthonormalCoarse<'a>,
}

impl ProjectedDual<'_> {
    fn product(&self, v: &[f64]) -> Vec<f64> {
        self.coarse.whole(&self.operator.apply(&self.coarse.own(v)))
    }

    /// P (d − F λ₀) with λ₀ = Gᵀ(GGᵀ)⁻¹e.
    pub fn homogenised(&self, constant: &RowVector) -> Vec<f64> {
        let mut rest = self.coarse.whole(constant);
        add_scaled(&mut rest, -1.0, &self.product(&self.coarse.jumps(self.coarse.right_side())));
        self.coarse.projected(&rest)
    }
}

impl SymmetricOperator for ProjectedDual<'_> {
    fn dimension(&self) -> usize {
        self.coarse.row_count()
    }

    fn apply(&self, x: &[f64], result: &mut [f64]) {
        let image = self.product(&self.coarse.projected(x));
        result.copy_from_slice(&self.coarse.projected(&image));
    }
}

/// P M P + Q/ρ for a penalty ρ.
pub fn projected_preconditioner(
    preconditioner: &Preconditioner<'_>,
    coarse: &OrthonormalCoarse<'_>,
    rho: f64,
) -> impl SymmetricOperator {
    (coarse.row_count(), move |x: &[f64], result: &mut [f64]| {
        let rigid = coarse.rigid_part(x);
        let elastic = difference(x, rigid.clone());
        let image = coarse.whole(&preconditioner.apply(&coarse.own(&elastic)));
        result.copy_from_slice(&coarse.projected(&image));
        add_scaled(result, 1.0 / rho, &rigid);
    })
}
