//! The natural coarse space: what forces on the rows do to the rigid motions of the subdomains.
//!
//! ```text
//! G = Rᵀ Bᵀ,   e = Rᵀ f:      G λ = e is the equilibrium of all subdomains,      Gᵀ a are the jumps of rigid amplitudes a
//! ```

use crate::equilibrium::modes::MOTIONS;
use crate::error::ContactError;
use crate::linear::cholesky::NumericFactor;
use crate::linear::csr::Csr;
use crate::linear::entry::Entry;
use crate::tfeti::dual::coarse_matrix::CondensedCoarse;
use crate::tfeti::torn::{CoarsePattern, RowVector, TornModel, TornSystem};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// G, e and the part of the coarse matrix that all active sets share.
#[derive(Debug)]
pub struct CoarseSpace {
    /// Gᵀ: rows of B × rigid amplitudes.
    rows: Csr,
    transposed: Csr,
    resultants: Vec<f64>,
    pattern: Arc<CoarsePattern>,
    /// Motions that nothing holds.
    grounded: Vec<Vec<f64>>,
    /// G_E G_Eᵀ, and the grounded motions.
    condensed: CondensedCoarse,
    equality_count: usize,
    /// Nanoseconds spent on it after it was built.
    spent: AtomicU64,
}

impl CoarseSpace {
    /// The coarse space of a factored system. `grounded`: amplitude vectors of motions that nothing holds.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the constant part of the coarse matrix is not positive semidefinite to rounding.
    pub fn new(model: &TornModel, system: &TornSystem, grounded: Vec<Vec<f64>>) -> Result<Self, ContactError> {
        let entries: Vec<Vec<(usize, f64)>> =
            (0..model.constraints.row_count()).into_par_iter().map(|row| coarse_row(model, system, row)).collect();
        let resultants = system.parts.iter().flat_map(|part| part.rigid.resultants.iter().copied()).collect();
        let rows = Csr::from_rows(MOTIONS * system.parts.len(), entries);
        let (transposed, pattern) = (rows.transpose(), Arc::clone(&model.coarse));
        let equality_count = model.constraints.equality_count;
        let condensed =
            CondensedCoarse::new(&pattern, gram(&pattern, [&rows, &transposed], equality_count), &grounded)?;
        let spent = AtomicU64::new(0);
        Ok(Self { transposed, rows, resultants, pattern, grounded, condensed, equality_count, spent })
    }

    /// Does a part of the coarse work, and counts its wall-clock time.
    pub fn timed<R>(&self, work: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = work();
        let nanoseconds = u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.spent.fetch_add(nanoseconds, Ordering::Relaxed);
        result
    }

    /// Seconds that [`CoarseSpace::timed`] has counted: factors, solves and projections.
    pub fn seconds(&self) -> f64 {
        Duration::from_nanos(self.spent.load(Ordering::Relaxed)).as_secs_f64()
    }

    /// Number of rows of B.
    pub fn row_count(&self) -> usize {
        self.rows.row_count()
    }

    /// e.
    pub fn resultants(&self) -> &[f64] {
        &self.resultants
    }

    /// The part of the coarse matrix that all active sets share.
    pub fn condensed(&self) -> &CondensedCoarse {
        &self.condensed
    }

    /// Σ weight·(row of Gᵀ) of a combination of contact rows, as entries (place of the amplitude within C, value) that may repeat
    /// a place.
    pub fn combine(&self, combination: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let mut combined: Vec<(usize, f64)> = Vec::with_capacity(48);
        for &(row, weight) in combination {
            let entries = self.rows.row(row);
            combined.extend(entries.map(|(index, value)| (self.pattern.contact_place(index), weight * value)));
        }
        combined
    }

    /// The factor of G Gᵀ over all rows, with the grounded motions.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the rows leave a rigid motion free.
    pub fn gram_factor(&self) -> Result<NumericFactor, ContactError> {
        let mut values = gram(&self.pattern, [&self.rows, &self.transposed], self.row_count());
        let (lower, contact) = (&self.pattern.lower, self.pattern.contact_amplitudes());
        for motion in &self.grounded {
            for (index, &column) in contact.iter().enumerate() {
                for &row in &contact[index..] {
                    let position = lower.position(row, column).expect("invariant: all amplitudes of C are coupled");
                    values[position] += motion[row] * motion[column];
                }
            }
        }
        self.pattern.symbolic.factorize(&values).map_err(|error| ContactError::Factorization {
            what: "coarse matrix of all rows".into(),
            reason: format!("{}: the rows leave a rigid motion free", error.reason),
        })
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

/// Σ (row of Gᵀ)ᵀ(row of Gᵀ) over the first `count` rows of Gᵀ, as lower values over the coarse pattern.
fn gram(pattern: &CoarsePattern, [rows, transposed]: [&Csr; 2], count: usize) -> Vec<f64> {
    let (starts, pattern_rows) = (pattern.lower.starts(), pattern.lower.rows());
    let columns_of = |own: usize| {
        let mut blocks: BTreeMap<usize, [[f64; MOTIONS]; MOTIONS]> = BTreeMap::new();
        for (row, _) in transposed.row(MOTIONS * own).take_while(|(row, _)| *row < count) {
            // A row holds the six amplitudes of a subdomain side by side.
            let entries: Vec<(usize, f64)> = rows.row(row).collect();
            let of_own = entries.chunks_exact(MOTIONS).find(|six| six[0].0 == MOTIONS * own).into_iter().flatten();
            for (column, &(_, right)) in of_own.enumerate() {
                for six in entries.chunks_exact(MOTIONS).filter(|six| six[0].0 >= MOTIONS * own) {
                    let block = blocks.entry(six[0].0).or_default();
                    six.iter().enumerate().for_each(|(i, (_, left))| block[column][i] += left * right);
                }
            }
        }
        let value = |column: usize, row: usize| {
            blocks.get(&(row - row % MOTIONS)).map_or(0.0, |block| block[column][row % MOTIONS])
        };
        (0..MOTIONS)
            .flat_map(|column| {
                let range = starts[MOTIONS * own + column]..starts[MOTIONS * own + column + 1];
                pattern_rows[range].iter().map(|&row| value(column, row)).collect::<Vec<f64>>()
            })
            .collect::<Vec<f64>>()
    };
    let columns: Vec<Vec<f64>> = (0..rows.column_count() / MOTIONS).into_par_iter().map(columns_of).collect();
    columns.concat()
}
