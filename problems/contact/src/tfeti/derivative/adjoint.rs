//! The adjoint system of a TFETI state.
//!
//! ```text
//! K p + Bᵀ Q q = 0,   Tᵀ B p − Δ q = Tᵀ j      ⇔      (Tᵀ F Q + Δ) q − G_Tᵀ b = −Tᵀ j,   Gq q = 0,   p = −K⁺ Bᵀ Q q + R b
//! dJ = −pᵀ (∂K u − ∂f) + (Q q)ᵀ ∂g
//! ```
//! The transpose of the Newton system (method.md section 5): GMRES with friction; without it the system is symmetric and
//! conjugate gradients do.

use crate::equilibrium::law::Linearization;
use crate::error::ContactError;
use crate::linear::gmres::{PATIENCE, gmres};
use crate::linear::pcg::pcg;
use crate::linear::vector::{add_scaled, norm};
use crate::tfeti::{Precision, TornContact};

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

/// Cycles of GMRES: each recomputes the residual, so that what rounding took from one the next gives back.
const MAX_CYCLES: usize = 12;
/// Residual reduction asked of a cycle with single precision products.
const CYCLE_REDUCTION: f64 = 3e-5;
/// Reduction by a cycle above which products are made in double precision.
const SLOW: f64 = 0.1;
/// Krylov iterations allowed per cycle.
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
        // Where equilibrium alone determines the forces, all of the right side is rigid and only rounding is left of it.
        let start = norm(&projected).max(ROUNDING * norm(&right));
        let mut precision = self.precision;
        let apply = |z: &[f64], precision: Precision| {
            let product = self.operator.apply_direction(&rows.expand(z, false), precision);
            let mut product = rows.restrict(&product, true);
            rows.add_compliance(z, &mut product, 1.0);
            product
        };
        let mut unknowns = vec![0.0; rows.dimension];
        let mut rest = right.clone();
        let mut residual = norm(&projected);
        for _cycle in 0..MAX_CYCLES {
            if residual <= tolerance * start {
                break;
            }
            let reduction = match precision {
                Precision::Double => 0.0,
                Precision::Mixed => CYCLE_REDUCTION,
            };
            let target = (0.5 * tolerance * start).max(reduction * residual);
            let patience = if precision == self.precision { PATIENCE } else { MAX_KRYLOV };
            let precondition = |v: &[f64]| self.precondition(&rows, v, |z| coarse.project_adjoint(z));
            let product = |z: &[f64]| {
                let product = apply(z, precision);
                let mut reduced = product.clone();
                coarse.project_adjoint(&mut reduced);
                (reduced, product)
            };
            if self.boundary.has_friction() {
                let krylov = gmres(&projected, target, MAX_KRYLOV, patience, precondition, product);
                for ((coefficient, z), product) in
                    krylov.coefficients.iter().zip(&krylov.directions).zip(&krylov.payloads)
                {
                    add_scaled(&mut unknowns, *coefficient, z);
                    add_scaled(&mut rest, -coefficient, product);
                }
            } else {
                let krylov = pcg(&projected, target, MAX_KRYLOV, precondition, product);
                add_scaled(&mut unknowns, 1.0, &krylov.solution);
                add_scaled(&mut rest, -1.0, &krylov.image);
            }
            // Residual replacement by one product in double precision.
            rest.clone_from(&right);
            add_scaled(&mut rest, -1.0, &apply(&unknowns, Precision::Double));
            projected.copy_from_slice(&rest);
            coarse.project_adjoint(&mut projected);
            let previous = residual;
            residual = norm(&projected);
            if residual.is_nan() || residual > SLOW * previous && residual > tolerance * start {
                // Single precision has little to say about a system as ill conditioned as this.
                if precision == Precision::Double && (residual.is_nan() || residual > 0.5 * previous) {
                    break;
                }
                precision = Precision::Double;
                if residual.is_nan() || residual > previous {
                    unknowns.fill(0.0);
                    rest.clone_from(&right);
                    projected.copy_from_slice(&rest);
                    coarse.project_adjoint(&mut projected);
                    residual = norm(&projected);
                }
            }
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

/// Share of the right side below which its projection is known to few digits: relative residuals refer to no less.
const ROUNDING: f64 = 1e-5;

/// Relative residual accepted when rounding stops all progress.
const ACCEPTABLE: f64 = 1e-8;
