//! The natural coarse space: what forces on the rows do to the rigid motions of the clusters. In total FETI every
//! subdomain is a cluster of its own.
//!
//! ```text
//! G = Rᵀ Bᵀ,   e = Rᵀ f:      G λ = e is the equilibrium of all clusters,      Gᵀ a are the jumps of rigid amplitudes a
//! ```

use crate::body::MOTIONS;
use crate::error::ContactError;
use crate::linear::cholesky::NumericFactor;
use crate::linear::entry::Entry;
use crate::linear::parallel;
use crate::linear::vector::add_scaled;
use crate::tfeti::dual::coarse_matrix::CondensedCoarse;
use crate::tfeti::dual::coarse_rows::TornModes;
use crate::tfeti::dual::rigid_rows::RigidRows;
use crate::tfeti::torn::{CoarsePattern, Distribution, RowVector, TornModel, TornSystem};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// G, e and the part of the coarse matrix that all active sets share.
#[derive(Debug)]
pub struct CoarseSpace {
    /// Gᵀ: rows of B of this process.
    rows: RigidRows,
    /// G: rows by the clusters of this process.
    transposed: RigidRows,
    resultants: Vec<f64>,
    pattern: Arc<CoarsePattern>,
    /// Motions that nothing holds.
    grounded: Vec<Vec<f64>>,
    /// G_E G_Eᵀ, and the grounded motions.
    pub condensed: CondensedCoarse,
    equality_count: usize,
    /// Which process works on which clusters.
    pub distribution: Arc<Distribution>,
    /// Nanoseconds spent on it after it was built.
    spent: AtomicU64,
}

/// Rows of Gᵀ that are built before they are packed: enough for all threads, few beside the packed ones.
const ROWS_AT_ONCE: usize = 1 << 14;

impl CoarseSpace {
    /// The coarse space of a factored system. `grounded`: amplitude vectors of motions that nothing holds.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the constant part of the coarse matrix is not positive semidefinite to
    /// rounding.
    pub fn new(model: &TornModel, system: &TornSystem, grounded: Vec<Vec<f64>>) -> Result<Self, ContactError> {
        let (constraints, distribution) = (&model.constraints, &model.clusters);
        let modes = TornModes::new(model, system);
        let mut rows = RigidRows::new();
        let equality_count = constraints.equality_count;
        for first in (0..equality_count).step_by(ROWS_AT_ONCE) {
            let count = ROWS_AT_ONCE.min(equality_count - first);
            rows.extend(parallel::map(count, &|offset| modes.coarse_row(first + offset)));
        }
        rows.extend(modes.contact_rows());
        let resultants: Vec<f64> = system.loads.iter().flat_map(|load| load.resultants.iter().copied()).collect();
        let resultants = distribution.gather(&system.cluster_resultants(resultants), MOTIONS);
        let (transposed, pattern) = (rows.of_clusters(distribution.owned()), Arc::clone(&model.coarse));
        let values = gram(&pattern, [&rows, &transposed], equality_count, distribution);
        let condensed = CondensedCoarse::new(&pattern, values, &grounded)?;
        let distribution = Arc::clone(distribution);
        let spent = AtomicU64::new(0);
        Ok(Self { transposed, rows, resultants, pattern, grounded, condensed, equality_count, distribution, spent })
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

    /// Number of rows of B of this process.
    pub fn row_count(&self) -> usize {
        self.rows.count()
    }

    /// The resultants e of the loads.
    pub fn resultants(&self) -> &[f64] {
        &self.resultants
    }

    /// Σ weight·(row of Gᵀ) of combined contact rows, as entries (place within C, value) that may repeat a place.
    pub fn combine(&self, combination: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let mut combined: Vec<(usize, f64)> = Vec::with_capacity(48);
        for &(row, weight) in combination {
            for (cluster, block) in self.rows.blocks(row) {
                let first = self.pattern.contact_place(MOTIONS * cluster);
                combined.extend(block.iter().enumerate().map(|(mode, value)| (first + mode, weight * value)));
            }
        }
        combined
    }

    /// The factor of G Gᵀ over all rows, with the grounded motions.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the rows leave a rigid motion free.
    pub fn gram_factor(&self) -> Result<NumericFactor, ContactError> {
        let matrices = [&self.rows, &self.transposed];
        let mut values = gram(&self.pattern, matrices, self.row_count(), &self.distribution);
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

    /// Number of rigid amplitudes of clusters with contact rows.
    pub fn contact_amplitude_count(&self) -> usize {
        self.pattern.contact_amplitudes().len()
    }

    /// G λ of multipliers over the rows of this process: the resultants on all clusters.
    pub fn resultant<V: Entry>(&self, multipliers: &[V]) -> Vec<V> {
        self.distribution.gather(&self.transposed.resultants(multipliers), MOTIONS)
    }

    /// G λ − e: what the clusters lack to equilibrium.
    pub fn defect(&self, multipliers: &RowVector) -> Vec<f64> {
        let mut defect = self.resultant(multipliers);
        add_scaled(&mut defect, -1.0, &self.resultants);
        defect
    }

    /// The jumps Gᵀ a of rigid amplitudes.
    pub fn jumps<V: Entry>(&self, amplitudes: &[V]) -> RowVector<V> {
        RowVector::new(self.rows.jumps(amplitudes), self.equality_count)
    }
}

/// Σ (row of Gᵀ)ᵀ(row of Gᵀ) over the first `count` rows of Gᵀ, as lower values over the coarse pattern. A process has
/// all rows that touch its clusters, and forms the columns of these.
fn gram(
    pattern: &CoarsePattern,
    [rows, transposed]: [&RigidRows; 2],
    count: usize,
    distribution: &Distribution,
) -> Vec<f64> {
    let (starts, pattern_rows) = (pattern.lower.starts(), pattern.lower.rows());
    let owned = distribution.owned();
    let columns_of = |own: usize| {
        let first = MOTIONS * own;
        // The pattern holds the six amplitudes of a cluster side by side.
        let coupled: Vec<usize> =
            pattern_rows[starts[first]..starts[first + 1]].iter().step_by(MOTIONS).map(|row| row / MOTIONS).collect();
        let place =
            |cluster: usize| coupled.binary_search(&cluster).expect("invariant: the pattern couples all of a row");
        let mut blocks = vec![[[0.0; MOTIONS]; MOTIONS]; coupled.len()];
        for (row, right) in transposed.blocks(own - owned.start).take_while(|(row, _)| *row < count) {
            for (cluster, left) in rows.blocks(row).filter(|(cluster, _)| *cluster >= own) {
                for (column, right) in blocks[place(cluster)].iter_mut().zip(right) {
                    column.iter_mut().zip(left).for_each(|(value, left)| *value += left * right);
                }
            }
        }
        let value = |column: usize, row: usize| blocks[place(row / MOTIONS)][column][row % MOTIONS];
        (0..MOTIONS)
            .flat_map(|column| {
                let range = starts[first + column]..starts[first + column + 1];
                pattern_rows[range].iter().map(|&row| value(column, row)).collect::<Vec<f64>>()
            })
            .collect::<Vec<f64>>()
    };
    distribution.complete(parallel::map(owned.len(), &|index| columns_of(owned.start + index))).concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::{Configuration, ContactProblem};
    use crate::linear::dense::DenseLu;
    use crate::scene::{Scene, hertz, signorini};
    use crate::tfeti::{PreconditionerKind, TornOptions, TotalFeti};
    use faer::Mat;

    /// The coarse space of a flat scene, with a motion of all subdomains grounded if asked for.
    fn coarse_space(scene: Scene, subdomains: [usize; 3], ground: bool) -> CoarseSpace {
        let problem = Arc::new(ContactProblem::new(scene.with_bricks([6; 3], subdomains)).expect("a preset"));
        let options = TornOptions { preconditioner: PreconditionerKind::None, ..TornOptions::default() };
        let solver = TotalFeti::new(Arc::clone(&problem), options).expect("a torn scene");
        let controls = vec![95.0; problem.scene.control_count()];
        let configuration = Configuration::new(&problem, &controls).expect("held bodies");
        let system = solver.model().factorize(&configuration).expect("factors");
        let amplitudes = MOTIONS * system.parts.len();
        let motion: Vec<f64> = (0..amplitudes).map(|index| 0.3 * (index as f64).sin()).collect();
        CoarseSpace::new(solver.model(), &system, if ground { vec![motion] } else { vec![] }).expect("a coarse space")
    }

    /// The rows of G as columns of a dense matrix, times one number per row of B.
    fn dense(space: &CoarseSpace, count: usize) -> Mat<f64> {
        let mut columns = Mat::<f64>::zeros(space.resultants.len(), count);
        for row in 0..count {
            for (subdomain, block) in space.rows.blocks(row) {
                (0..MOTIONS).for_each(|mode| columns[(MOTIONS * subdomain + mode, row)] = block[mode]);
            }
        }
        columns
    }

    #[test]
    fn condensed_coarse_matrices_solve_as_dense_ones() {
        let cases = [
            (signorini(), [1, 1, 1], false),
            (signorini(), [2, 3, 2], false),
            (signorini(), [3, 3, 3], true),
            (hertz(), [2, 2, 3], false),
        ];
        for (scene, subdomains, ground) in cases {
            let space = coarse_space(scene.expect("a preset"), subdomains, ground);
            let (count, first) = (space.resultants.len(), space.equality_count);
            // Every other contact row, with another row added on one side, as friction does.
            let chosen: Vec<usize> = (first..space.row_count() - 1).step_by(2).collect();
            let glued = dense(&space, first);
            let mut matrix = &glued * glued.transpose();
            let all = dense(&space, space.row_count());
            for &row in &chosen {
                matrix += (all.col(row) + 0.3 * all.col(row + 1)) * all.col(row).transpose();
            }
            let held = space.pattern.contact_amplitudes();
            for motion in &space.grounded {
                held.iter().for_each(|&i| held.iter().for_each(|&j| matrix[(i, j)] += motion[i] * motion[j]));
            }
            let factor = space.condensed.with_contact(|add| {
                for &row in &chosen {
                    let (trial, test) = (space.combine(&[(row, 1.0), (row + 1, 0.3)]), space.combine(&[(row, 1.0)]));
                    for &(column, right) in &test {
                        trial.iter().for_each(|&(row, left)| add(row, column, left * right));
                    }
                }
            });
            let lu = DenseLu::new(&matrix);
            assert!(factor.pivot_ratio() > 1e-6 && lu.pivot_ratio() > 1e-6, "{subdomains:?}");
            let right: Vec<f64> = (0..count).map(|index| (1.7 * index as f64).cos()).collect();
            let close = |found: &[f64], expected: &[f64]| {
                let scale = expected.iter().fold(0.0, |scale: f64, entry| scale.max(entry.abs()));
                found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-11 * scale)
            };
            let (mut found, mut expected) = (right.clone(), right.clone());
            factor.solve_in_place(&mut found);
            lu.solve_in_place(&mut expected);
            assert!(close(&found, &expected), "{subdomains:?}");
            let (mut found, mut expected) = (right.clone(), right);
            factor.solve_transpose_in_place(&mut found);
            lu.solve_transpose_in_place(&mut expected);
            assert!(close(&found, &expected), "{subdomains:?}, transposed");
        }
    }

    #[test]
    fn subdomains_without_contact_are_eliminated_sparsely() {
        let space = coarse_space(signorini().expect("a preset"), [3, 3, 3], false);
        assert_eq!((space.pattern.interior_count(), space.pattern.contact_amplitudes().len()), (6 * 18, 6 * 9));
        let space = coarse_space(hertz().expect("a preset"), [3, 3, 6], false);
        assert_eq!((space.pattern.interior_count(), space.pattern.contact_amplitudes().len()), (6 * 90, 6 * 18));
        // 27 neighbours at most, of which the lower triangle and the dense block of the contact subdomains are stored.
        let (entries, dense) = (space.pattern.lower.entry_count(), 6 * 108 * (6 * 108 + 1) / 2);
        assert!(3 * entries < dense, "{entries} of {dense}");
    }
}
