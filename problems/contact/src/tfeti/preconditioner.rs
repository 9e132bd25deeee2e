//! Preconditioners of the dual operator.
//!
//! ```text
//! Dirichlet:  B_D S B_Dᵀ,  S = K_BB − K_BI K_II⁻¹ K_IB   (B: dofs with rows, I: the others)
//! lumped:     B_D K_BB B_Dᵀ
//! ```

use crate::tfeti::{DualOperator, SubdomainFactors};
use rayon::prelude::*;

/// Which preconditioner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "PreconditionerName", transform = crate::schema::names_only))]
#[non_exhaustive]
pub enum PreconditionerKind {
    /// Schur complements: fewest products with F.
    #[default]
    Dirichlet,
    /// Boundary stiffness: no interior factorisation.
    Lumped,
    /// The identity, scaled.
    None,
}

/// A preconditioner of one factored system.
#[derive(Debug)]
pub struct Preconditioner<'a> {
    operator: &'a DualOperator<'a>,
    kind: PreconditionerKind,
    stiffness: f64,
}

impl<'a> Preconditioner<'a> {
    /// A preconditioner; `stiffness` scales the identity of [`PreconditionerKind::None`], N/mm.
    pub fn new(operator: &'a DualOperator<'a>, kind: PreconditionerKind, stiffness: f64) -> Self {
        Self { operator, kind, stiffness }
    }

    /// The product with all rows of a residual (mm); result in N.
    pub fn apply(&self, residual: &[f64]) -> Vec<f64> {
        if self.kind == PreconditionerKind::None {
            return residual.iter().map(|entry| self.stiffness * entry).collect();
        }
        let model = self.operator.model;
        let mut torn = vec![0.0; model.dof_count];
        model.constraints.weighted_transposed.multiply(residual, &mut torn);
        let size = model.pattern.pattern.dimension();
        torn.par_chunks_mut(size).zip(&self.operator.system.parts).enumerate().for_each(|(index, (values, part))| {
            match &part.factors {
                Some(factors) if values.iter().any(|entry| *entry != 0.0) => {
                    self.apply_subdomain(index, factors, values)
                }
                Some(_) => {}
                None => values.fill(0.0),
            }
        });
        let mut result = vec![0.0; model.constraints.row_count()];
        model.constraints.weighted.multiply(&torn, &mut result);
        model.communication.exchange(&mut result);
        result
    }

    /// S or K_BB times the boundary part; entries of the interior come out meaningless and are not read (B_D has no rows
    /// there).
    fn apply_subdomain(&self, index: usize, factors: &SubdomainFactors, part: &mut [f64]) {
        let pattern = &self.operator.model.pattern.pattern;
        let boundary = part.to_vec();
        pattern.multiply(&factors.stiffness, &boundary, part);
        let (Some(interior), Some(factor)) = (self.operator.model.interior(index), &factors.interior) else { return };
        let mut inner: Vec<f64> = interior.kept.iter().map(|&dof| part[dof]).collect();
        factor.solve_in_place(&mut inner);
        let (mut extended, mut image) = (vec![0.0; part.len()], vec![0.0; part.len()]);
        for (&dof, value) in interior.kept.iter().zip(&inner) {
            extended[dof] = *value;
        }
        pattern.multiply(&factors.stiffness, &extended, &mut image);
        for (part, image) in part.iter_mut().zip(&image) {
            *part -= image;
        }
    }
}
