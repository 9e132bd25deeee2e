//! The linear system of one active set: projected GMRES with iterative refinement.
//!
//! ```text
//! Qᵀ F T y + Δ y − QᵀGᵀ a = r,   G T y = e                                                          method.md (4.5)
//! ```

use crate::error::ContactError;
use crate::linear::gmres::{Combination, PATIENCE, gmres};
use crate::linear::vector::{add_scaled, norm};
use crate::tfeti::ReducedRows;
use crate::tfeti::dual::coarse_space::CoarseProblem;
use crate::tfeti::newton::iteration::{Iterate, TornContact};
use crate::tfeti::newton::recycling::Recycled;

/// How accurately a reduced linear system is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearAccuracy {
    /// Norm of the projected residual aimed at, mm.
    pub target: f64,
    /// Reduction of its first value that is enough.
    pub reduction: f64,
    /// Krylov iterations allowed per cycle.
    pub max_krylov: usize,
    /// Krylov iterations in which the residual must halve.
    pub patience: usize,
    /// Cycles of iterative refinement: each recomputes the residual.
    pub cycles: usize,
}

impl LinearAccuracy {
    /// The start: one digit.
    pub const START: Self = Self { target: 0.0, reduction: 0.1, max_krylov: 200, patience: PATIENCE, cycles: 1 };
    /// All that rounding allows.
    pub const EXACT: Self = Self { target: 0.0, reduction: 1e-14, max_krylov: 400, patience: 400, cycles: 6 };

    /// One cycle to a given residual.
    pub fn to(target: f64, max_krylov: usize) -> Self {
        Self { target, reduction: 0.0, max_krylov, patience: PATIENCE, cycles: 1 }
    }
}

/// Reduction that another cycle of iterative refinement must have brought.
const REFINEMENT_PAYS: f64 = 0.5;

impl TornContact<'_> {
    /// Solves the reduced system for an active set, starting from given multipliers; its Krylov pairs join `pairs`, where
    /// somebody will use them.
    pub(crate) fn linear_solve(
        &self,
        rows: &ReducedRows<'_>,
        coarse: &CoarseProblem<'_>,
        start: &[f64],
        accuracy: LinearAccuracy,
        mut pairs: Option<&mut Recycled>,
    ) -> Result<Iterate, ContactError> {
        let mut unknowns = rows.initial(start);
        let (mut first, mut last) = (None, f64::INFINITY);
        let mut image = Vec::new();
        for _cycle in 0..accuracy.cycles {
            coarse.enforce(&mut unknowns, &self.space.resultants);
            image = self.operator.apply(&rows.expand(&unknowns, true));
            let mut projected = self.reduced_residual(rows, &unknowns, &image);
            coarse.project(&mut projected);
            let size = norm(&projected);
            let target = accuracy.target.max(accuracy.reduction * *first.get_or_insert(size));
            if size <= target || size > REFINEMENT_PAYS * last {
                break;
            }
            last = size;
            let krylov: Combination<Vec<f64>> = gmres(
                &projected,
                target,
                accuracy.max_krylov,
                accuracy.patience,
                |v| self.precondition(rows, v, |z| coarse.project(z)),
                |z| {
                    let product = self.operator.apply(&rows.expand(z, true));
                    let mut reduced = rows.restrict(&product, false);
                    rows.add_compliance(z, &mut reduced, 1.0);
                    coarse.project(&mut reduced);
                    (reduced, product)
                },
            );
            for ((coefficient, direction), product) in
                krylov.coefficients.iter().zip(&krylov.directions).zip(&krylov.payloads)
            {
                add_scaled(&mut unknowns, *coefficient, direction);
                add_scaled(&mut image, *coefficient, product);
            }
            if let Some(pairs) = pairs.as_deref_mut() {
                for (direction, product) in krylov.directions.iter().zip(krylov.payloads) {
                    let amplitudes = balancing_amplitudes(rows, coarse, direction, &product);
                    pairs.push(self, rows.expand(direction, true), product, amplitudes);
                }
            }
        }
        let amplitudes = coarse.amplitudes(&self.reduced_residual(rows, &unknowns, &image));
        Ok(self.iterate(rows.expand(&unknowns, true), image, amplitudes))
    }

    /// Qᵀ(d − F T y) − Δ y.
    fn reduced_residual(&self, rows: &ReducedRows<'_>, unknowns: &[f64], image: &[f64]) -> Vec<f64> {
        let rest: Vec<f64> = self.constant.iter().zip(image).map(|(d, image)| d - image).collect();
        let mut residual = rows.restrict(&rest, false);
        rows.add_compliance(unknowns, &mut residual, -1.0);
        residual
    }
}

/// Amplitudes that remove the rigid part of what a direction y with product F T y does to the reduced residual.
pub fn balancing_amplitudes(
    rows: &ReducedRows<'_>,
    coarse: &CoarseProblem<'_>,
    direction: &[f64],
    product: &[f64],
) -> Vec<f64> {
    let mut change: Vec<f64> = rows.restrict(product, false).into_iter().map(|entry| -entry).collect();
    rows.add_compliance(direction, &mut change, -1.0);
    coarse.amplitudes(&change)
}
