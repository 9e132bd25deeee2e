//! The natural coarse space: what forces on the rows do to the rigid motions of the subdomains.
//!
//! ```text
//! G = Rᵀ Bᵀ,   e = Rᵀ f:      G λ = e is the equilibrium of all subdomains,      Gᵀ a are the jumps of rigid amplitudes a
//! ```

use crate::linear::csr::Csr;
use crate::linear::entry::Entry;
use crate::tfeti::torn::{RowVector, TornModel, TornSystem};
use faer::Mat;
use rayon::prelude::*;

/// G, e and the part of the coarse matrix that all active sets share.
#[derive(Debug)]
pub struct CoarseSpace {
    /// Gᵀ: rows of B × rigid amplitudes.
    rows: Csr,
    transposed: Csr,
    resultants: Vec<f64>,
    /// G_E G_Eᵀ, and the grounded motions.
    fixed_part: Mat<f64>,
    equality_count: usize,
}

impl CoarseSpace {
    /// The coarse space of a factored system. `grounded`: amplitude vectors of motions that nothing holds.
    pub fn new(model: &TornModel, system: &TornSystem, grounded: &[Vec<f64>]) -> Self {
        let coarse_count = 6 * system.parts.len();
        let row_count = model.constraints.row_count();
        let entries: Vec<Vec<(usize, f64)>> =
            (0..row_count).into_par_iter().map(|row| coarse_row(model, system, row)).collect();
        let resultants = system.parts.iter().flat_map(|part| part.rigid.resultants.iter().copied()).collect();
        let rows = Csr::from_rows(coarse_count, entries);
        let mut fixed_part = Mat::<f64>::zeros(coarse_count, coarse_count);
        let equality_count = model.constraints.equality_count;
        add_gram(&rows, 0..equality_count, &mut fixed_part);
        for amplitudes in grounded {
            // Amplitudes and G are dimensionless, so a unit weight is of the size of G Gᵀ.
            for (j, right) in amplitudes.iter().enumerate() {
                for (i, left) in amplitudes.iter().enumerate() {
                    fixed_part[(i, j)] += left * right;
                }
            }
        }
        Self { transposed: rows.transpose(), rows, resultants, fixed_part, equality_count }
    }

    /// Number of rows of B.
    pub fn row_count(&self) -> usize {
        self.rows.row_count()
    }

    /// e.
    pub fn resultants(&self) -> &[f64] {
        &self.resultants
    }

    /// The matrix to which an active set adds the products of its contact rows.
    pub fn fixed_part(&self) -> &Mat<f64> {
        &self.fixed_part
    }

    /// Σ weight·(row of Gᵀ) of a combination of rows, as entries (amplitude, value) that may repeat an amplitude.
    pub fn combine(&self, combination: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let mut combined: Vec<(usize, f64)> = Vec::with_capacity(48);
        for &(row, weight) in combination {
            combined.extend(self.rows.row(row).map(|(index, value)| (index, weight * value)));
        }
        combined
    }

    /// G Gᵀ over all rows, with the grounded motions.
    pub fn gram(&self) -> Mat<f64> {
        let mut matrix = self.fixed_part.clone();
        add_gram(&self.rows, self.equality_count..self.row_count(), &mut matrix);
        matrix
    }

    /// G λ of multipliers over all rows.
    pub fn resultant<V: Entry>(&self, multipliers: &[V]) -> Vec<V> {
        let mut result = vec![V::ZERO; self.rows.column_count()];
        self.transposed.multiply(multipliers, &mut result);
        result
    }

    /// Gᵀ a.
    pub fn jumps<V: Entry>(&self, amplitudes: &[V]) -> RowVector<V> {
        let mut result = vec![V::ZERO; self.row_count()];
        self.rows.multiply(amplitudes, &mut result);
        RowVector::new(result, self.equality_count)
    }
}

/// One row of Gᵀ: the row of B on the rigid modes of the subdomains it touches.
fn coarse_row(model: &TornModel, system: &TornSystem, row: usize) -> Vec<(usize, f64)> {
    let size = model.pattern.pattern.dimension();
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
            entry.1 += value * mode[dof - subdomain * size];
        }
    }
    entries
}

/// matrix += Σ over a range of rows of (row of Gᵀ)ᵀ(row of Gᵀ).
fn add_gram(rows: &Csr, range: std::ops::Range<usize>, matrix: &mut Mat<f64>) {
    for row in range {
        for (i, left) in rows.row(row) {
            for (j, right) in rows.row(row) {
                matrix[(j, i)] += left * right;
            }
        }
    }
}
