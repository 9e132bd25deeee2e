//! Preconditioners of the dual operator.
//!
//! ```text
//! Dirichlet:  B_D S B_Dᵀ,  S = K_BB − K_BI K_II⁻¹ K_IB   (B: dofs with rows, I: the others)
//! lumped:     B_D K_BB B_Dᵀ
//! ```

use crate::linear::vector::add_scaled;
use crate::tfeti::torn::{PreconditionerKind, RowVector, SubdomainFactors, TornModel, TornSystem};
use rayon::prelude::*;

/// A preconditioner of one factored system.
#[derive(Debug)]
pub struct Preconditioner<'a> {
    model: &'a TornModel,
    system: &'a TornSystem,
    kind: PreconditionerKind,
    stiffness: f64,
}

impl<'a> Preconditioner<'a> {
    /// A preconditioner; `stiffness` scales the identity of [`PreconditionerKind::None`], N/mm.
    pub fn new(model: &'a TornModel, system: &'a TornSystem, kind: PreconditionerKind, stiffness: f64) -> Self {
        Self { model, system, kind, stiffness }
    }

    /// The product with a residual (mm) over all rows; result in N.
    pub fn apply(&self, residual: &RowVector) -> RowVector {
        if self.kind == PreconditionerKind::None {
            let mut result = residual.clone();
            result.iter_mut().for_each(|entry| *entry *= self.stiffness);
            return result;
        }
        let model = self.model;
        let mut torn = model.zeros();
        model.constraints.weighted_transposed.multiply(residual, &mut torn.0);
        let size = model.pattern.pattern.dimension();
        torn.0.par_chunks_mut(size).zip(&self.system.parts).enumerate().for_each(|(index, (values, part))| match &part
            .factors
        {
            Some(factors) if values.iter().any(|entry| *entry != 0.0) => self.apply_subdomain(index, factors, values),
            Some(_) => {}
            None => values.fill(0.0),
        });
        let mut result = model.constraints.zeros();
        model.constraints.weighted.multiply(&torn.0, &mut result);
        model.communication.exchange(&mut result);
        result
    }

    /// S or K_BB times the boundary part. Entries of the interior come out meaningless; nothing reads them, since B_D has no
    /// rows there.
    fn apply_subdomain(&self, index: usize, factors: &SubdomainFactors, part: &mut [f64]) {
        let pattern = &self.model.pattern.pattern;
        let boundary = part.to_vec();
        pattern.multiply(&factors.stiffness, &boundary, part);
        let (Some(interior), Some(factor)) = (self.model.interior(index), &factors.interior) else { return };
        let mut inner: Vec<f64> = interior.kept.iter().map(|&dof| part[dof]).collect();
        factor.solve_in_place(&mut inner);
        let (mut extended, mut image) = (vec![0.0; part.len()], vec![0.0; part.len()]);
        for (&dof, value) in interior.kept.iter().zip(&inner) {
            extended[dof] = *value;
        }
        pattern.multiply(&factors.stiffness, &extended, &mut image);
        add_scaled(part, -1.0, &image);
    }
}
