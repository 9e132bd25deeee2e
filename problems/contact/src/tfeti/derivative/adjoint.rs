//! The adjoint system of a TFETI state.
//!
//! ```text
//! K p + Bᵀ Q q = l,   Tᵀ B p − Δ q = Tᵀ j
//!     ⇔   (Tᵀ F Q + Δ) q − G_Tᵀ b = Tᵀ (B K⁺ l − j),   Gq q = Rᵀ l,   p = K⁺ (l − Bᵀ Q q) + R b
//! dJ = ∂J − pᵀ (∂K u − ∂f) + (Q q)ᵀ ∂g
//! ```
//! The transpose of the Newton system (method.md section 5): GMRES with friction; without it the system is symmetric
//! and conjugate gradients do. Cycles follow each other until the residual, computed afresh, is small; products with
//! search directions are in single precision until a cycle shows that it is too coarse for the system.

use crate::equilibrium::law::{Friction, Linearization};
use crate::error::ContactError;
use crate::linear::gmres::{MAX_STALLED_ITERATIONS, gmres};
use crate::linear::pcg::pcg;
use crate::linear::vector::add_scaled;
use crate::tfeti::derivative::cycles::{
    CYCLE_REDUCTION, MAX_CYCLES, NextCycle, SMALLEST_PROJECTED_SHARE, TIGHTEST_ACCEPTABLE, next_cycle,
};
use crate::tfeti::derivative::displacement_load::DisplacementLoad;
use crate::tfeti::dual::{ActiveSet, Precision, TornContact};
use crate::tfeti::torn::{RowVector, TornVector};

#[derive(Debug, Clone)]
pub struct TornAdjoint {
    /// The adjoint displacement p.
    pub(crate) displacement: TornVector,
    /// Q q over all rows: the adjoint of the gap.
    pub(crate) multipliers: RowVector,
}

/// Krylov iterations allowed per cycle.
const MAX_KRYLOV: usize = 600;
/// Share of the natural residual accepted when rounding stops all progress: six digits of a sensitivity of its size.
const NATURAL_ACCEPTABLE: f64 = 1e-6;
/// Share of the natural residual below which the whole right side is rounding for the sensitivity.
const ROUNDING_SHARE: f64 = 1e-3;

/// The system (Tᵀ F Q + Δ) q = Tᵀ (B K⁺ l − j), projected by Pᵀ.
struct AdjointSystem<'a> {
    contact: &'a TornContact<'a>,
    active: ActiveSet<'a>,
    load: Option<&'a DisplacementLoad>,
    right: Vec<f64>,
}

/// Unknowns q with their residual, before and after the projection.
struct AdjointIterate {
    unknowns: Vec<f64>,
    rest: Vec<f64>,
    projected: Vec<f64>,
    residual: f64,
}

/// Solves the adjoint system at given derivatives; `direction` is j = ∂J/∂λ, `load` is l = ∂J/∂u where J depends on
/// u. `natural`: a residual, in the unit of j, that is rounding for the sensitivity however small that is.
/// `max_products`: products with F allowed in all.
///
/// # Errors
/// [`ContactError::NotConverged`] when the tolerance is not reached, [`ContactError::Unheld`].
pub fn adjoint(
    contact: &TornContact<'_>,
    linearizations: &[Linearization],
    direction: &RowVector,
    load: Option<&DisplacementLoad>,
    tolerance: f64,
    natural: f64,
    max_products: usize,
) -> Result<TornAdjoint, ContactError> {
    let active = contact.active_set(linearizations.to_vec(), Friction::Coulomb)?;
    let mut right: Vec<f64> = active.rows.trial_transposed(direction).into_iter().map(|entry| -entry).collect();
    if let Some(load) = load {
        add_scaled(&mut right, 1.0, &active.rows.trial_transposed(&load.jumps));
    }
    let system = AdjointSystem { contact, active, load, right };
    let mut iterate = system.at_start();
    // Where equilibrium alone determines the forces, the right side is rigid, and only rounding is left of it.
    let size = iterate.residual.max(SMALLEST_PROJECTED_SHARE * contact.norm(&system.right));
    let goal = if size < ROUNDING_SHARE * natural { TIGHTEST_ACCEPTABLE * natural } else { tolerance * size };
    let size = size.max(natural);
    let mut precision = contact.precision;
    for _cycle in 0..MAX_CYCLES {
        // The last one tells the residual.
        let left = max_products.saturating_sub(contact.operator.applications() + 1);
        if iterate.residual <= goal || left == 0 {
            break;
        }
        let previous = iterate.residual;
        system.adjoint_cycle(&mut iterate, goal, precision, left.min(MAX_KRYLOV));
        match next_cycle(precision, previous, iterate.residual, goal) {
            NextCycle::Continue => {}
            NextCycle::Double => precision = Precision::Double,
            NextCycle::DoubleFromZero => {
                precision = Precision::Double;
                iterate = system.at_start();
            }
            NextCycle::Stop => break,
        }
    }
    if iterate.residual.is_nan()
        || iterate.residual > (TIGHTEST_ACCEPTABLE.max(tolerance) * size).max(NATURAL_ACCEPTABLE * natural)
    {
        return Err(ContactError::NotConverged {
            solver: "adjoint GMRES on TFETI",
            residual: iterate.residual / size,
            tolerance,
            iterations: contact.operator.applications(),
            history: vec![iterate.residual / size],
        });
    }
    Ok(system.recover(&iterate))
}

impl AdjointSystem<'_> {
    /// (Tᵀ F Q + Δ) z.
    fn apply(&self, z: &[f64], precision: Precision) -> Vec<f64> {
        let rows = &self.active.rows;
        let mut product = rows.trial_transposed(&self.contact.operator.apply_direction(&rows.test(z), precision));
        rows.add_compliance(z, &mut product, 1.0);
        product
    }

    /// q = G_Tᵀ (Gq G_Tᵀ)⁻¹ Rᵀ l, with which Gq q = Rᵀ l: 0 without a load.
    fn at_start(&self) -> AdjointIterate {
        match self.load {
            None => self.with_residual(vec![0.0; self.right.len()], self.right.clone()),
            Some(load) => self.evaluated(self.active.carrying(load.resultants.clone())),
        }
    }

    /// Unknowns with their residual, by one product in double precision.
    fn evaluated(&self, unknowns: Vec<f64>) -> AdjointIterate {
        let mut rest = self.right.clone();
        add_scaled(&mut rest, -1.0, &self.apply(&unknowns, Precision::Double));
        self.with_residual(unknowns, rest)
    }

    fn with_residual(&self, unknowns: Vec<f64>, rest: Vec<f64>) -> AdjointIterate {
        let mut projected = rest.clone();
        self.active.project_adjoint(&mut projected);
        AdjointIterate { residual: self.contact.norm(&projected), unknowns, rest, projected }
    }

    /// One run of a Krylov method with products in a given precision, towards a residual of `goal`; then the residual
    /// by one product in double precision.
    fn adjoint_cycle(&self, iterate: &mut AdjointIterate, goal: f64, precision: Precision, max_krylov: usize) {
        let reduction = match precision {
            Precision::Double => 0.0,
            Precision::Mixed => CYCLE_REDUCTION,
        };
        let target = (0.5 * goal).max(reduction * iterate.residual);
        // Once single precision has failed, the system is so ill conditioned that its residual may rest for long.
        let patience = if precision == self.contact.precision { MAX_STALLED_ITERATIONS } else { MAX_KRYLOV };
        let project = |v: &mut [f64]| self.active.project_adjoint(v);
        let precondition = |v: &[f64]| {
            let mut z = self.contact.precondition(&self.active.rows, v);
            project(&mut z);
            z
        };
        let product = |z: &[f64]| {
            let mut projected = self.apply(z, precision);
            project(&mut projected);
            projected
        };
        let sums = self.contact.operator.model.sums();
        if self.contact.boundary.has_friction() {
            let krylov =
                gmres(&sums, &iterate.projected, target, max_krylov, patience, precondition, |z| (product(z), ()));
            for (coefficient, z) in krylov.coefficients.iter().zip(&krylov.directions) {
                add_scaled(&mut iterate.unknowns, *coefficient, z);
            }
        } else {
            let krylov = pcg(&sums, &iterate.projected, target, max_krylov, precondition, product);
            add_scaled(&mut iterate.unknowns, 1.0, &krylov.solution);
        }
        *iterate = self.evaluated(std::mem::take(&mut iterate.unknowns));
    }

    /// The adjoint state of solved unknowns: amplitudes b, then Q q and p.
    fn recover(&self, iterate: &AdjointIterate) -> TornAdjoint {
        let operator = &self.contact.operator;
        let amplitudes = self.active.adjoint_amplitudes(&iterate.rest);
        let multipliers = self.active.rows.test(&iterate.unknowns);
        let response = self.load.map_or_else(|| operator.model.zeros(), |load| load.response.clone());
        let displacement = operator.displacement(response, &multipliers, &amplitudes);
        TornAdjoint { displacement, multipliers }
    }
}
