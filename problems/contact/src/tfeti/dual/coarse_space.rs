//! The natural coarse space and the oblique projector of an active set.
//!
//! ```text
//! P = I − Gqᵀ (G_T Gqᵀ)⁻¹ G_T,   Gq = G Q,  G_T = G T      (the orthogonal projector when T = Q)
//! ```
//! One projector serves both sides: it removes the rigid amplitudes on the left and keeps G T y = 0 on the right.

use crate::linear::csr::Csr;
use crate::linear::dense::DenseLu;
use crate::tfeti::{DualOperator, ReducedRows};
use faer::Mat;
use rayon::prelude::*;

/// G, e and the part of the coarse matrix that does not depend on the active set.
#[derive(Debug)]
pub struct CoarseSpace {
    /// Gᵀ: rows of B × rigid amplitudes.
    pub rows: Csr,
    transposed: Csr,
    /// e = Rᵀ f.
    pub resultants: Vec<f64>,
    fixed_part: Mat<f64>,
    equality_count: usize,
}

impl CoarseSpace {
    /// The coarse space of a factored system. `grounded`: amplitude vectors of motions that nothing holds.
    pub fn new(operator: &DualOperator<'_>, grounded: &[Vec<f64>]) -> Self {
        let (model, system) = (operator.model, operator.system);
        let size = model.pattern.pattern.dimension();
        let coarse_count = 6 * system.parts.len();
        let entries: Vec<Vec<(usize, f64)>> = (0..model.constraints.row_count())
            .into_par_iter()
            .map(|row| {
                let mut entries: Vec<(usize, f64)> = Vec::with_capacity(48);
                for (dof, value) in model.constraints.rows.row(row) {
                    let subdomain = dof / size;
                    let first = 6 * subdomain;
                    // Dofs of one row that belong to one subdomain are rare; they are simply added up.
                    let position = entries.iter().position(|(index, _)| *index == first).unwrap_or_else(|| {
                        entries.extend((first..first + 6).map(|index| (index, 0.0)));
                        entries.len() - 6
                    });
                    for (entry, mode) in entries[position..].iter_mut().zip(&system.parts[subdomain].rigid.modes) {
                        entry.1 += value * mode[dof - first / 6 * size];
                    }
                }
                entries
            })
            .collect();
        let resultants = system.parts.iter().flat_map(|part| part.rigid.resultants.iter().copied()).collect();
        let rows = Csr::from_rows(coarse_count, entries);
        let mut fixed_part = Mat::<f64>::zeros(coarse_count, coarse_count);
        for row in 0..model.constraints.equality_count {
            for (i, left) in rows.row(row) {
                for (j, right) in rows.row(row) {
                    fixed_part[(j, i)] += left * right;
                }
            }
        }
        for amplitudes in grounded {
            // Amplitudes and G are dimensionless, so a unit weight is of the size of G Gᵀ.
            for (j, right) in amplitudes.iter().enumerate() {
                for (i, left) in amplitudes.iter().enumerate() {
                    fixed_part[(i, j)] += left * right;
                }
            }
        }
        let equality_count = model.constraints.equality_count;
        Self { transposed: rows.transpose(), rows, resultants, fixed_part, equality_count }
    }

    /// G Gᵀ over all rows, with the grounded motions.
    pub(crate) fn gram(&self) -> Mat<f64> {
        let mut matrix = self.fixed_part.clone();
        for row in self.equality_count..self.rows.row_count() {
            for (i, left) in self.rows.row(row) {
                for (j, right) in self.rows.row(row) {
                    matrix[(j, i)] += left * right;
                }
            }
        }
        matrix
    }

    /// G_E G_Eᵀ with the grounded motions: the part of the coarse matrix that all active sets share.
    pub fn equality_gram(&self) -> &Mat<f64> {
        &self.fixed_part
    }

    /// G λ.
    pub fn resultant(&self, multipliers: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; self.rows.column_count()];
        self.transposed.multiply(multipliers, &mut result);
        result
    }

    /// Gᵀ a.
    pub fn jumps(&self, amplitudes: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; self.rows.row_count()];
        self.rows.multiply(amplitudes, &mut result);
        result
    }
}

/// The coarse problem of one active set.
#[derive(Debug)]
pub struct CoarseProblem<'a> {
    space: &'a CoarseSpace,
    rows: ReducedRows<'a>,
    factors: DenseLu,
    coulomb: bool,
}

impl<'a> CoarseProblem<'a> {
    /// Factors G_T Gqᵀ (with `coulomb`) or Gq Gqᵀ.
    pub fn new(space: &'a CoarseSpace, rows: ReducedRows<'a>, coulomb: bool) -> Self {
        let mut matrix = space.fixed_part.clone();
        let combine = |column: &[(usize, f64)]| {
            let mut combined: Vec<(usize, f64)> = Vec::with_capacity(48);
            for &(row, weight) in column {
                combined.extend(space.rows.row(row).map(|(index, value)| (index, weight * value)));
            }
            combined
        };
        rows.contact_columns(coulomb, |left, right| {
            let (left, right) = (combine(left), combine(right));
            for &(j, right) in &right {
                for &(i, left) in &left {
                    matrix[(i, j)] += left * right;
                }
            }
        });
        Self { space, rows, factors: DenseLu::new(&matrix), coulomb }
    }

    /// Near 0 when the active set leaves a rigid motion free.
    pub fn pivot_ratio(&self) -> f64 {
        self.factors.pivot_ratio()
    }

    /// a with Gqᵀ a closest to −r: the amplitudes of a reduced residual r.
    pub fn amplitudes(&self, residual: &[f64]) -> Vec<f64> {
        let mut amplitudes = self.space.resultant(&self.rows.expand(residual, self.coulomb));
        self.factors.solve_in_place(&mut amplitudes);
        amplitudes.iter_mut().for_each(|entry| *entry = -*entry);
        amplitudes
    }

    /// P v.
    pub fn project(&self, v: &mut [f64]) {
        let amplitudes = self.amplitudes(v);
        self.add_rigid(&amplitudes, v);
    }

    /// v += Gqᵀ a.
    pub fn add_rigid(&self, amplitudes: &[f64], v: &mut [f64]) {
        let rigid = self.rows.restrict(&self.space.jumps(amplitudes), false);
        for (v, rigid) in v.iter_mut().zip(&rigid) {
            *v += rigid;
        }
    }

    /// y += Gqᵀ (G_T Gqᵀ)⁻¹ (target − G T y): the smallest change that brings about the resultants.
    pub fn enforce(&self, y: &mut [f64], target: &[f64]) {
        let mut defect = self.space.resultant(&self.rows.expand(y, self.coulomb));
        for (defect, target) in defect.iter_mut().zip(target) {
            *defect = target - *defect;
        }
        self.factors.solve_in_place(&mut defect);
        self.add_rigid(&defect, y);
    }

    /// Amplitudes b of the adjoint: (Gq G_Tᵀ)⁻¹ of −Gq r.
    pub fn adjoint_amplitudes(&self, residual: &[f64]) -> Vec<f64> {
        let mut amplitudes = self.space.resultant(&self.rows.expand(residual, false));
        self.factors.solve_transpose_in_place(&mut amplitudes);
        amplitudes.iter_mut().for_each(|entry| *entry = -*entry);
        amplitudes
    }

    /// v += G_Tᵀ b.
    pub fn add_adjoint_rigid(&self, amplitudes: &[f64], v: &mut [f64]) {
        let rigid = self.rows.restrict(&self.space.jumps(amplitudes), self.coulomb);
        for (v, rigid) in v.iter_mut().zip(&rigid) {
            *v += rigid;
        }
    }

    /// Pᵀ v.
    pub fn project_adjoint(&self, v: &mut [f64]) {
        let amplitudes = self.adjoint_amplitudes(v);
        self.add_adjoint_rigid(&amplitudes, v);
    }
}
