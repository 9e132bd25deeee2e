//! The adjoint system of a TFETI state.
//!
//! ```text
//! K p + Bᵀ Q q = 0,   Tᵀ B p − Δ q = Tᵀ j      ⇔      (Tᵀ F Q + Δ) q − G_Tᵀ b = −Tᵀ j,   Gq q = 0,   p = −K⁺ Bᵀ Q q + R b
//! dJ = −pᵀ (∂K u − ∂f) + (Q q)ᵀ ∂g
//! ```
//! The transpose of the Newton system (method.md section 5): GMRES with friction; without it the system is symmetric and
//! conjugate gradients do. Cycles follow each other until the residual, computed afresh, is small; products with search
//! directions are in single precision until a cycle shows that it is too coarse for the system.

use crate::equilibrium::law::Linearization;
use crate::error::ContactError;
use crate::linear::gmres::{MAX_STALLED_ITERATIONS, gmres};
use crate::linear::pcg::pcg;
use crate::linear::vector::{add_scaled, norm};
use crate::tfeti::dual::{ActiveSet, Friction, Precision, TornContact};
use crate::tfeti::torn::{RowVector, TornVector};

/// The adjoint state.
#[derive(Debug, Clone)]
pub struct TornAdjoint {
    /// p.
    pub(crate) displacement: TornVector,
    /// Q q over all rows: the adjoint of the gap.
    pub(crate) multipliers: RowVector,
}

/// Cycles allowed: each recomputes the residual, so that the next one regains what rounding has taken.
const MAX_CYCLES: usize = 12;
/// Residual reduction asked of a cycle with single precision products.
const CYCLE_REDUCTION: f64 = 3e-5;
/// Residual reduction by a cycle that is too little for products in single precision.
const SLOW_REDUCTION: f64 = 0.1;
/// Residual reduction by a cycle that is too little for another one in double precision.
const STALLED_REDUCTION: f64 = 0.5;
/// Krylov iterations allowed per cycle.
const MAX_KRYLOV: usize = 600;
/// Share of the right side below which its projection is known to few digits: relative residuals refer to no less.
const SMALLEST_PROJECTED_SHARE: f64 = 1e-5;
/// Share of the natural residual accepted when rounding stops all progress: six digits of a sensitivity of its size.
const NATURAL_ACCEPTABLE: f64 = 1e-6;
/// Share of the natural residual below which the whole right side is rounding for the sensitivity.
const ROUNDING_SHARE: f64 = 1e-3;
/// Relative residual accepted when rounding stops all progress.
const TIGHTEST_ACCEPTABLE: f64 = 1e-8;

/// The system (Tᵀ F Q + Δ) q = −Tᵀ j, projected by Pᵀ.
struct AdjointSystem<'a> {
    contact: &'a TornContact<'a>,
    active: ActiveSet<'a>,
    right: Vec<f64>,
}

/// Unknowns q with their residual, before and after the projection.
struct AdjointIterate {
    unknowns: Vec<f64>,
    rest: Vec<f64>,
    projected: Vec<f64>,
    residual: f64,
}

/// What follows a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NextCycle {
    /// Another cycle in the same precision, or the end if the residual is small enough.
    Continue,
    /// Another cycle with products in double precision.
    Double,
    /// The same, from the beginning: the cycle has made things worse.
    DoubleFromZero,
    /// Rounding has stopped all progress.
    Stop,
}

impl TornContact<'_> {
    /// Solves the adjoint system at given derivatives; `direction` is j = ∂J/∂λ. `natural`: a residual, in the unit of j, that
    /// is rounding for the sensitivity however small that is.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] when the tolerance is not reached, [`ContactError::Unheld`].
    pub fn adjoint(
        &self,
        linearizations: &[Linearization],
        direction: &RowVector,
        tolerance: f64,
        natural: f64,
    ) -> Result<TornAdjoint, ContactError> {
        let active = self.active_set(linearizations.to_vec(), Friction::Coulomb)?;
        let right = active.rows.trial_transposed(direction).into_iter().map(|entry| -entry).collect();
        let system = AdjointSystem { contact: self, active, right };
        let mut iterate = system.at_zero();
        // Where equilibrium alone determines the forces, all of the right side is rigid and only rounding is left of it.
        let size = iterate.residual.max(SMALLEST_PROJECTED_SHARE * norm(&system.right));
        let goal = if size < ROUNDING_SHARE * natural { TIGHTEST_ACCEPTABLE * natural } else { tolerance * size };
        let size = size.max(natural);
        let mut precision = self.precision;
        for _cycle in 0..MAX_CYCLES {
            if iterate.residual <= goal {
                break;
            }
            let previous = iterate.residual;
            system.adjoint_cycle(&mut iterate, goal, precision);
            match next_cycle(precision, previous, iterate.residual, goal) {
                NextCycle::Continue => {}
                NextCycle::Double => precision = Precision::Double,
                NextCycle::DoubleFromZero => {
                    precision = Precision::Double;
                    iterate = system.at_zero();
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
                iterations: MAX_KRYLOV,
                history: vec![iterate.residual / size],
            });
        }
        Ok(system.recover(&iterate))
    }
}

impl AdjointSystem<'_> {
    /// (Tᵀ F Q + Δ) z.
    fn apply(&self, z: &[f64], precision: Precision) -> Vec<f64> {
        let rows = &self.active.rows;
        let mut product = rows.trial_transposed(&self.contact.operator.apply_direction(&rows.test(z), precision));
        rows.add_compliance(z, &mut product, 1.0);
        product
    }

    /// q = 0.
    fn at_zero(&self) -> AdjointIterate {
        self.with_residual(vec![0.0; self.right.len()], self.right.clone())
    }

    fn with_residual(&self, unknowns: Vec<f64>, rest: Vec<f64>) -> AdjointIterate {
        let mut projected = rest.clone();
        self.active.project_adjoint(&mut projected);
        AdjointIterate { residual: norm(&projected), unknowns, rest, projected }
    }

    /// One run of a Krylov method with products in a given precision, towards a residual of `goal`; then the residual by one
    /// product in double precision.
    fn adjoint_cycle(&self, iterate: &mut AdjointIterate, goal: f64, precision: Precision) {
        let reduction = match precision {
            Precision::Double => 0.0,
            Precision::Mixed => CYCLE_REDUCTION,
        };
        let target = (0.5 * goal).max(reduction * iterate.residual);
        // Once single precision has failed, the system is so ill conditioned that its residual may rest for long.
        let patience = if precision == self.contact.precision { MAX_STALLED_ITERATIONS } else { MAX_KRYLOV };
        let project = |v: &mut [f64]| self.active.project_adjoint(v);
        let precondition = |v: &[f64]| self.contact.precondition(&self.active.rows, v, project);
        let product = |z: &[f64]| {
            let mut projected = self.apply(z, precision);
            project(&mut projected);
            projected
        };
        if self.contact.boundary.has_friction() {
            let krylov = gmres(&iterate.projected, target, MAX_KRYLOV, patience, precondition, |z| (product(z), ()));
            for (coefficient, z) in krylov.coefficients.iter().zip(&krylov.directions) {
                add_scaled(&mut iterate.unknowns, *coefficient, z);
            }
        } else {
            let krylov = pcg(&iterate.projected, target, MAX_KRYLOV, precondition, product);
            add_scaled(&mut iterate.unknowns, 1.0, &krylov.solution);
        }
        let mut rest = self.right.clone();
        add_scaled(&mut rest, -1.0, &self.apply(&iterate.unknowns, Precision::Double));
        *iterate = self.with_residual(std::mem::take(&mut iterate.unknowns), rest);
    }

    /// The adjoint state of solved unknowns: amplitudes b, then Q q and p.
    fn recover(&self, iterate: &AdjointIterate) -> TornAdjoint {
        let operator = &self.contact.operator;
        let amplitudes = self.active.adjoint_amplitudes(&iterate.rest);
        let multipliers = self.active.rows.test(&iterate.unknowns);
        let displacement = operator.displacement(operator.model.zeros(), &multipliers, &amplitudes);
        TornAdjoint { displacement, multipliers }
    }
}

/// Judges a cycle by the residual before and after it.
fn next_cycle(precision: Precision, previous: f64, residual: f64, goal: f64) -> NextCycle {
    let within = |share: f64| residual <= share * previous;
    if residual <= goal || within(SLOW_REDUCTION) {
        NextCycle::Continue
    } else if precision == Precision::Double && !within(STALLED_REDUCTION) {
        NextCycle::Stop
    } else if within(1.0) {
        NextCycle::Double
    } else {
        NextCycle::DoubleFromZero
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOAL: f64 = 1e-10;

    #[test]
    fn a_cycle_that_pays_or_reaches_the_goal_is_followed_by_the_same() {
        for precision in [Precision::Mixed, Precision::Double] {
            assert_eq!(next_cycle(precision, 1.0, 0.05, GOAL), NextCycle::Continue);
            assert_eq!(next_cycle(precision, 1.5 * GOAL, GOAL, GOAL), NextCycle::Continue);
        }
    }

    #[test]
    fn a_slow_cycle_in_single_precision_is_followed_by_double_precision() {
        assert_eq!(next_cycle(Precision::Mixed, 1.0, 0.2, GOAL), NextCycle::Double);
        assert_eq!(next_cycle(Precision::Mixed, 1.0, 1.0, GOAL), NextCycle::Double);
    }

    #[test]
    fn a_harmful_cycle_in_single_precision_is_undone() {
        assert_eq!(next_cycle(Precision::Mixed, 1.0, 1.1, GOAL), NextCycle::DoubleFromZero);
        assert_eq!(next_cycle(Precision::Mixed, 1.0, f64::NAN, GOAL), NextCycle::DoubleFromZero);
    }

    #[test]
    fn double_precision_goes_on_while_the_residual_halves() {
        assert_eq!(next_cycle(Precision::Double, 1.0, 0.4, GOAL), NextCycle::Double);
        assert_eq!(next_cycle(Precision::Double, 1.0, 0.6, GOAL), NextCycle::Stop);
        assert_eq!(next_cycle(Precision::Double, 1.0, f64::NAN, GOAL), NextCycle::Stop);
    }
}
