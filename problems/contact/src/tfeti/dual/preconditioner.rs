//! Preconditioners of the dual operator.
//!
//! ```text
//! Dirichlet:  B_D S B_Dᵀ,  S = K_BB − K_BI K_II⁻¹ K_IB   (B: dofs with rows, I: the others)
//! lumped:     B_D K_BB B_Dᵀ
//! ```
//! K is the boundary stiffness of a subdomain: for nearly incompressible material, that of its compressible neighbour.

use crate::linear::entry::vectorized;
use crate::linear::parallel::for_parts;
use crate::linear::right_side::RightSide;
use crate::tfeti::torn::{PreconditionerKind, RowVector, SubdomainFactors, TornModel, TornSystem, parts_mut};

/// A preconditioner of one factored system.
#[derive(Debug, Clone)]
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

    /// The product with a residual (mm) over the rows of this process; result in N.
    pub fn apply(&self, residual: &RowVector) -> RowVector {
        self.apply_columns(residual, &mut self.model.zeros().0)
    }

    /// [`apply`](Self::apply) for a vector or a block of columns, in its own precision. `torn`: room for a torn vector.
    pub(crate) fn apply_columns<V: RightSide>(&self, residual: &RowVector<V>, torn: &mut [V]) -> RowVector<V> {
        if self.kind == PreconditionerKind::None {
            let mut result = residual.clone();
            result.iter_mut().for_each(|entry| entry.scale(self.stiffness));
            return result;
        }
        let (rows, starts) = (&self.system.rows, &self.system.starts);
        for_parts(parts_mut(torn, starts), &|index, values| {
            rows.weighted_transposed.multiply_rows(starts[index], residual, values);
            if values.iter().any(|entry| *entry != V::ZERO) {
                self.apply_subdomain(index, &self.system.parts[index], values);
            }
        });
        self.model.rows_times(&rows.weighted, torn)
    }

    /// S or K_BB times the boundary part. Entries of the interior are meaningless and not read: B_D has no rows there.
    fn apply_subdomain<V: RightSide>(&self, index: usize, factors: &SubdomainFactors, part: &mut [V]) {
        let stiffness = factors.boundary_stiffness();
        let Some(class) = self.model.interior(index) else {
            let whole = part.to_vec();
            self.model.piece(index).1.pattern.lower.multiply(stiffness, &whole, part);
            return;
        };
        let boundary: Vec<V> = class.boundary.iter().map(|&dof| part[dof]).collect();
        let mut image = vec![V::ZERO; boundary.len()];
        vectorized(
            #[inline(always)]
            || class.boundary_block.add_product(stiffness, 1.0, &boundary, &mut image),
        );
        if let Some(factor) = &factors.interior {
            let mut inner = vec![V::ZERO; class.submatrix.kept.len()];
            vectorized(
                #[inline(always)]
                || class.coupling.add_product(stiffness, 1.0, &boundary, &mut inner),
            );
            V::solve(factor, &mut inner);
            vectorized(
                #[inline(always)]
                || class.coupling_transposed.add_product(stiffness, -1.0, &inner, &mut image),
            );
        }
        for (&dof, image) in class.boundary.iter().zip(image) {
            part[dof] = image;
        }
    }
}
