//! The adjoint system of a TFETI state.
//!
//! ```text
//! K p + Bᵀ Q q = 0,   Tᵀ B p − Δ q = Tᵀ j      ⇔      (Tᵀ F Q + Δ) q − G_Tᵀ b = −Tᵀ j,   Gq q = 0,   p = −K⁺ Bᵀ Q q + R b
//! dJ = −pᵀ (∂K u − ∂f) + (Q q)ᵀ ∂g
//! ```
//! The transpose of the Newton system (method.md section 5); symmetric without friction.

use crate::contact::law::Linearization;
use crate::error::ContactError;
use crate::linear::gmres::gmres;
use crate::linear::vector::{add_scaled, norm};
use crate::tfeti::TornContact;

/// The adjoint state.
#[derive(Debug, Clone)]
pub struct TornAdjoint {
    /// p over torn dofs.
    pub displacement: Vec<f64>,
    /// Q q over all rows: the adjoint of the gap.
    pub multipliers: Vec<f64>,
    /// Relative residual of the adjoint system.
    pub residual: f64,
}

/// Krylov iterations allowed.
const MAX_KRYLOV: usize = 600;

impl TornContact<'_> {
    /// Solves the adjoint system at given derivatives; `direction` is j = ∂J/∂λ over all (scaled) rows.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] when GMRES does not reach the tolerance.
    pub fn adjoint(
        &self,
        linearizations: &[Linearization],
        direction: &[f64],
        tolerance: f64,
    ) -> Result<TornAdjoint, ContactError> {
        let rows = self.reduced(linearizations.to_vec());
        let coarse = self.coarse(&rows, true)?;
        let right: Vec<f64> = rows.restrict(direction, true).into_iter().map(|entry| -entry).collect();
        let mut projected = right.clone();
        coarse.project_adjoint(&mut projected);
        let start = norm(&projected);
        let apply = |z: &[f64]| {
            let mut product = rows.restrict(&self.operator.apply(&rows.expand(z, false)), true);
            rows.add_compliance(z, &mut product, 1.0);
            product
        };
        let mut unknowns = vec![0.0; rows.dimension];
        let mut rest = right;
        let mut residual = start;
        // A second pass recomputes the residual: what rounding took from the first, it gives back.
        for _pass in 0..2 {
            if residual <= tolerance * start {
                break;
            }
            let krylov = gmres(
                &projected,
                0.5 * tolerance * start,
                MAX_KRYLOV,
                |v| self.precondition(&rows, v, |z| coarse.project_adjoint(z)),
                |z| {
                    let product = apply(z);
                    let mut reduced = product.clone();
                    coarse.project_adjoint(&mut reduced);
                    (reduced, product)
                },
            );
            for ((coefficient, z), product) in krylov.coefficients.iter().zip(&krylov.directions).zip(&krylov.payloads)
            {
                add_scaled(&mut unknowns, *coefficient, z);
                add_scaled(&mut rest, -coefficient, product);
            }
            projected.copy_from_slice(&rest);
            coarse.project_adjoint(&mut projected);
            residual = norm(&projected);
        }
        if residual.is_nan() || residual > ACCEPTABLE.max(tolerance) * start {
            return Err(ContactError::NotConverged {
                solver: "adjoint GMRES on TFETI",
                residual: residual / start,
                tolerance,
                iterations: MAX_KRYLOV,
                history: vec![residual / start],
            });
        }
        let amplitudes = coarse.adjoint_amplitudes(&rest);
        let multipliers = rows.expand(&unknowns, false);
        let displacement = self.operator.displacement(&multipliers, &amplitudes, false);
        let residual = if start > 0.0 { residual / start } else { 0.0 };
        Ok(TornAdjoint { displacement, multipliers, residual })
    }
}

/// Relative residual accepted when rounding stops all progress.
const ACCEPTABLE: f64 = 1e-8;
