//! Sparse Cholesky factorisation A = L Lᵀ: one symbolic analysis, by faer, for all matrices of a pattern.

use crate::linear::FactorizationError;
use crate::linear::border::Border;
use crate::linear::dense::column;
use crate::linear::entry::{Entry, Row};
use crate::linear::fronts::{Fronts, NoPostorder};
use crate::linear::multifrontal::Elimination;
use crate::linear::parallel;
use crate::linear::real::Real;
use crate::linear::supernodal;
use crate::linear::symmetric::LowerPattern;
use crate::linear::triangle::Triangle;
use crate::linear::vector::{add_scaled, norm};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::Perm;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::{SupernodalLltRef, SymbolicSupernodalCholesky};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::traits::ComplexField;
use faer::{Conj, Mat, MatMut, Par, Side};
use std::sync::{Arc, OnceLock};

/// Right sides that are solved for at once.
const COLUMNS: usize = 16;

/// Elimination order and fill of one pattern.
#[derive(Debug)]
pub struct SymbolicFactor {
    pattern: Arc<LowerPattern>,
    fronts: Fronts,
    order: Vec<usize>,
}

/// The factor of one matrix.
#[derive(Debug)]
pub struct NumericFactor {
    symbolic: Arc<SymbolicFactor>,
    values: Vec<f64>,
    single: OnceLock<Vec<f32>>,
}

impl SymbolicFactor {
    /// Analyses a pattern for the elimination order `order[new] = old`, a permutation of all indices. Where it is no
    /// postorder of its elimination tree, an equivalent one is taken.
    ///
    /// # Errors
    /// [`FactorizationError`] when the analysis fails (out of memory, index overflow).
    pub fn new(pattern: Arc<LowerPattern>, order: Vec<usize>) -> Result<Self, FactorizationError> {
        let (order, fronts) = match Fronts::new(analysis(&pattern, &order)?, &pattern, &order) {
            Ok(fronts) => (order, fronts),
            Err(NoPostorder { order }) => {
                let fronts = Fronts::new(analysis(&pattern, &order)?, &pattern, &order);
                let reason = || failure("symbolic factorisation", "no postorder".into());
                (order, fronts.map_err(|_| reason())?)
            }
        };
        Ok(Self { pattern, fronts, order })
    }

    /// Factors the matrix with these lower values.
    ///
    /// # Errors
    /// [`FactorizationError`] when the matrix is not positive definite.
    pub fn factorize(self: &Arc<Self>, values: &[f64]) -> Result<NumericFactor, FactorizationError> {
        Ok(self.eliminate(values, &Border::none())?.0)
    }

    /// Factors the matrix A with these lower values, and forms B A⁻¹ Bᵀ for the rows of a sparse B, given by entries
    /// (index, value).
    ///
    /// # Errors
    /// [`FactorizationError`] when the matrix is not positive definite.
    pub(crate) fn factorize_bordered(
        self: &Arc<Self>,
        values: &[f64],
        rows: &[Vec<(usize, f64)>],
    ) -> Result<(NumericFactor, Mat<f64>), FactorizationError> {
        let mut place = vec![0; self.order.len()];
        self.order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
        let (factor, lower) = self.eliminate(values, &Border::new(&self.fronts, rows, |index| place[index]))?;
        let size = rows.len();
        let mut product = Mat::<f64>::zeros(size, size);
        for column in 0..size {
            for (row, value) in (column..).zip(lower.column(column)) {
                (product[(row, column)], product[(column, row)]) = (-value, -value);
            }
        }
        Ok((factor, product))
    }

    fn eliminate(
        self: &Arc<Self>,
        matrix: &[f64],
        border: &Border,
    ) -> Result<(NumericFactor, Triangle), FactorizationError> {
        let mut values = vec![0.0; self.fronts.symbolic().len_val()];
        let border = Elimination { fronts: &self.fronts, matrix, border }
            .factorize(&mut values)
            .map_err(|_| failure("Cholesky factorisation", "not positive definite".into()))?;
        Ok((NumericFactor { symbolic: Arc::clone(self), values, single: OnceLock::new() }, border))
    }

    /// Solves L Lᵀ x = b in place for the values of a factor, in either precision; columns of b are right sides, of
    /// which some at once need little memory beside them.
    fn solve<E: ComplexField + Send + Sync>(&self, values: &[E], b: MatMut<'_, E>) {
        let columns = b.ncols();
        if columns > COLUMNS {
            let (first, others) = b.split_at_col_mut(columns.div_ceil(COLUMNS) / 2 * COLUMNS);
            parallel::join(true, || self.solve(values, first), || self.solve(values, others));
            return;
        }
        let symbolic = self.fronts.analysis();
        let mut memory = MemBuffer::new(symbolic.solve_in_place_scratch::<E>(b.ncols(), Par::Seq));
        let stack = MemStack::new(&mut memory);
        LltRef::new(symbolic, values).solve_in_place_with_conj(Conj::No, b, Par::Seq, stack);
    }
}

/// The analysis of a pattern for an elimination order.
fn analysis(pattern: &LowerPattern, order: &[usize]) -> Result<SymbolicCholesky<usize>, FactorizationError> {
    let n = pattern.dimension();
    let mut inverse = vec![0; n];
    for (new, &old) in order.iter().enumerate() {
        inverse[old] = new;
    }
    let permutation = Perm::new_checked(order.into(), inverse.into_boxed_slice(), n);
    let parameters = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        ..Default::default()
    };
    let ordering = SymmetricOrdering::Custom(permutation.as_ref());
    factorize_symbolic_cholesky(pattern_ref(pattern), Side::Lower, ordering, parameters)
        .map_err(|error| failure("symbolic factorisation", format!("{error:?}")))
}

/// Steps of iterative refinement allowed.
const MAX_REFINEMENTS: usize = 4;
/// Largest |A x − b|/|b| of a refined solution.
const LARGEST_RESIDUAL: f64 = 1e-9;

impl SymbolicFactor {
    /// Factors the matrix and solves A x = b in place with iterative refinement; returns |A x − b|/|b|.
    ///
    /// # Errors
    /// [`FactorizationError`] when the matrix is not positive definite or the residual stays above 1e-9.
    pub fn solve_refined(self: &Arc<Self>, values: &[f64], b: &mut [f64]) -> Result<f64, FactorizationError> {
        let factor = self.factorize(values)?;
        let right = b.to_vec();
        let size = norm(&right);
        b.fill(0.0);
        let (mut rest, mut image) = (right.clone(), vec![0.0; right.len()]);
        let mut residual = size;
        for _step in 0..=MAX_REFINEMENTS {
            let mut correction = rest.clone();
            factor.solve_in_place(&mut correction);
            add_scaled(b, 1.0, &correction);
            self.pattern.multiply(values, b, &mut image);
            for (rest, (right, image)) in rest.iter_mut().zip(right.iter().zip(&image)) {
                *rest = right - image;
            }
            let previous = std::mem::replace(&mut residual, norm(&rest));
            if residual.is_nan() || residual > 0.5 * previous {
                break;
            }
        }
        if size > 0.0 && (residual.is_nan() || residual > LARGEST_RESIDUAL * size) {
            let reason =
                format!("relative residual {:.1e} after refinement, allowed: {LARGEST_RESIDUAL:.0e}", residual / size);
            return Err(failure("refined solution", reason));
        }
        Ok(if size > 0.0 { residual / size } else { 0.0 })
    }
}

impl NumericFactor {
    /// Number of values of L.
    pub(crate) fn value_count(&self) -> usize {
        self.values.len()
    }

    /// Solves A x = b in place.
    pub fn solve_in_place(&self, b: &mut [f64]) {
        self.symbolic.solve(&self.values, column(b));
    }

    /// Solves A X = B in place, all columns at once.
    pub(crate) fn solve_columns_in_place(&self, b: &mut Mat<f64>) {
        self.symbolic.solve(&self.values, b.as_mut());
    }

    /// As [`NumericFactor::solve_in_place`], with factor and vector in single precision. The rounded factor is made at
    /// the first call and kept.
    pub(crate) fn solve_in_place_single(&self, b: &mut [f32]) {
        self.symbolic.solve(self.single_values(), column(b));
    }

    /// The values of L rounded to single precision.
    fn single_values(&self) -> &[f32] {
        self.single.get_or_init(|| self.values.iter().map(|&value| value as f32).collect())
    }

    /// Solves A X = B in place for a block of columns by rows, in the precision of the block.
    pub(crate) fn solve_rows_in_place<E: Real, const N: usize>(&self, b: &mut [Row<E, N>]) {
        let mut ordered: Vec<Row<E, N>> = self.symbolic.order.iter().map(|&old| b[old]).collect();
        supernodal::solve(self.supernodes(), E::chosen(&self.values, || self.single_values()), &mut ordered);
        for (&old, row) in self.symbolic.order.iter().zip(ordered) {
            b[old] = row;
        }
    }

    /// L₂₂ of the trailing `size` indices of the elimination order: L₂₂L₂₂ᵀ is their Schur complement. Row and column p
    /// belong to index `order[n − size + p]`.
    pub(crate) fn trailing_block(&self, size: usize) -> Mat<f64> {
        let symbolic = self.supernodes();
        let first = self.symbolic.pattern.dimension() - size;
        let factor = SupernodalLltRef::<usize, f64>::new(symbolic, &self.values);
        let mut block = Mat::<f64>::zeros(size, size);
        for index in 0..symbolic.n_supernodes() {
            let (begin, end) = (symbolic.supernode_begin()[index], symbolic.supernode_end()[index]);
            if end <= first {
                continue;
            }
            let supernode = factor.supernode(index);
            let (values, pattern) = (supernode.val(), supernode.pattern());
            for column in begin.max(first)..end {
                for row in column..end {
                    block[(row - first, column - first)] = values[(row - begin, column - begin)];
                }
                for (offset, &row) in pattern.iter().enumerate() {
                    block[(row - first, column - first)] = values[(end - begin + offset, column - begin)];
                }
            }
        }
        block
    }

    /// The elimination order, `order[new] = old`.
    pub fn order(&self) -> &[usize] {
        &self.symbolic.order
    }

    /// Eliminates the first `count` indices of the elimination order from a right side in this order: x ← L₁₁⁻¹ b₁
    /// there, and b₂ − L₂₁ x₁ in the others. With all indices it solves L x = b.
    pub(crate) fn eliminate<V: Entry>(&self, count: usize, b: &mut [V]) {
        supernodal::eliminate(self.supernodes(), &self.values, count, b);
    }

    /// Solves L₁₁ᵀ x₁ = y₁ − L₂₁ᵀ x₂ for the first `count` indices of the elimination order, in place; x₂ is given.
    /// With all indices it solves Lᵀ x = y.
    pub(crate) fn substitute<V: Entry>(&self, count: usize, y: &mut [V]) {
        supernodal::substitute(self.supernodes(), &self.values, count, y);
    }

    fn supernodes(&self) -> &SymbolicSupernodalCholesky<usize> {
        self.symbolic.fronts.symbolic()
    }
}

fn pattern_ref(pattern: &LowerPattern) -> SymbolicSparseColMatRef<'_, usize> {
    let n = pattern.dimension();
    SymbolicSparseColMatRef::new_checked(n, n, pattern.starts(), None, pattern.rows())
}

fn failure(what: &'static str, reason: String) -> FactorizationError {
    FactorizationError { what, reason }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::ordering::nested_dissection;
    use testset::kit::Random;

    /// Rows by entries (index, value).
    type SparseRows = Vec<Vec<(usize, f64)>>;

    /// The 1D Laplacian with 7 unknowns.
    fn laplacian() -> (Arc<LowerPattern>, Vec<f64>) {
        let columns = (0..7).map(|i| if i < 6 { vec![i + 1] } else { vec![] }).collect();
        let pattern = Arc::new(LowerPattern::from_columns(columns));
        let values = (0..7).flat_map(|i| if i < 6 { vec![2.0, -1.0] } else { vec![2.0] }).collect();
        (pattern, values)
    }

    #[test]
    fn solves_and_yields_the_schur_complement() {
        let (pattern, values) = laplacian();
        let order = vec![0, 1, 2, 4, 5, 6, 3];
        let symbolic = Arc::new(SymbolicFactor::new(Arc::clone(&pattern), order).expect("symbolic"));
        let factor = symbolic.factorize(&values).expect("numeric");
        let mut x = vec![1.0; 7];
        factor.solve_in_place(&mut x);
        for (i, x) in x.iter().enumerate() {
            let node = i as f64 + 1.0;
            assert!((x - node * (8.0 - node) / 2.0).abs() < 1e-13);
        }
        // Schur complement of the middle node: 2 − 2·(3/4) = 1/2.
        let block = factor.trailing_block(1);
        assert!((block[(0, 0)] * block[(0, 0)] - 0.5).abs() < 1e-14);
    }

    #[test]
    fn refinement_reaches_rounding() {
        let (pattern, values) = laplacian();
        let symbolic = Arc::new(SymbolicFactor::new(pattern, (0..7).collect()).expect("symbolic"));
        let mut x = vec![1.0; 7];
        assert!(symbolic.solve_refined(&values, &mut x).expect("solved") < 1e-15);
        assert!((x[3] - 8.0).abs() < 1e-13);
    }

    #[test]
    fn indefinite_matrix_is_refused() {
        let (pattern, mut values) = laplacian();
        values[0] = -1.0;
        let symbolic = Arc::new(SymbolicFactor::new(pattern, (0..7).collect()).expect("symbolic"));
        let error = symbolic.factorize(&values).expect_err("indefinite");
        assert!(error.to_string().contains("not positive definite"), "{error}");
    }

    /// A grid of 6 × 5 × 4 points with random entries, in nested dissection order; B: three entries per row.
    fn grid(seed: u64) -> (Arc<SymbolicFactor>, Vec<f64>, SparseRows) {
        let mut random = Random(seed);
        let counts = [6, 5, 4];
        let index = |[i, j, k]: [usize; 3]| (i * counts[1] + j) * counts[2] + k;
        let all: Vec<[usize; 3]> =
            (0..120).map(|n| [n / (counts[1] * counts[2]), n / counts[2] % counts[1], n % counts[2]]).collect();
        let near = |a: &[usize; 3], b: &[usize; 3]| a != b && (0..3).all(|axis| a[axis].abs_diff(b[axis]) <= 1);
        let graph: Vec<Vec<u32>> =
            all.iter().map(|a| all.iter().filter(|b| near(a, b)).map(|b| index(*b) as u32).collect()).collect();
        let columns = graph.iter().map(|near| near.iter().map(|&other| other as usize).collect()).collect();
        let pattern = Arc::new(LowerPattern::from_columns(columns));
        let points: Vec<[f64; 3]> = all.iter().map(|x| x.map(|x| x as f64)).collect();
        let order = nested_dissection(&points, &graph, &[]);
        let values = (0..pattern.dimension()).flat_map(|column| {
            pattern.rows()[pattern.starts()[column]..pattern.starts()[column + 1]].iter().map(move |&row| (row, column))
        });
        let values = values.map(|(row, column)| if row == column { 30.0 } else { random.signed() }).collect();
        let rows = (0..17).map(|row| (0..3).map(|k| ((7 * row + 13 * k) % 120, random.signed())).collect()).collect();
        (Arc::new(SymbolicFactor::new(pattern, order).expect("symbolic")), values, rows)
    }

    #[test]
    fn a_border_is_condensed() {
        for seed in 0..8 {
            let (symbolic, values, rows) = grid(seed);
            let (factor, product) = symbolic.factorize_bordered(&values, &rows).expect("positive definite");
            for (column, entries) in rows.iter().enumerate() {
                let mut x = vec![0.0; 120];
                entries.iter().for_each(|(index, value)| x[*index] += value);
                factor.solve_in_place(&mut x);
                for (row, entries) in rows.iter().enumerate() {
                    let expected: f64 = entries.iter().map(|(index, value)| value * x[*index]).sum();
                    assert!((product[(row, column)] - expected).abs() < 1e-15, "{expected}");
                }
            }
            assert_eq!(factor.values, symbolic.factorize(&values).expect("positive definite").values);
        }
    }

    /// Fronts that are large enough for several threads.
    #[test]
    fn factors_do_not_depend_on_the_number_of_threads() {
        let size = 700;
        let pattern = Arc::new(LowerPattern::from_columns((0..size).map(|i| (i + 1..size).collect()).collect()));
        let values = (0..size).flat_map(|i| (i..size).map(move |j| if i == j { 2e3 } else { ((i * j) as f64).sin() }));
        let values: Vec<f64> = values.collect();
        let rows: Vec<Vec<(usize, f64)>> = (0..size).map(|row| vec![(row, 1.0), (size - 1, 0.5)]).collect();
        let symbolic = Arc::new(SymbolicFactor::new(pattern, (0..size).collect()).expect("symbolic"));
        let factored = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| symbolic.factorize_bordered(&values, &rows).expect("positive definite"))
        };
        let (factor, product) = factored(1);
        for threads in [2, 3] {
            let (other, found) = factored(threads);
            assert!(factor.values == other.values && product == found);
        }
        let mut x = vec![1.0; size];
        factor.solve_in_place(&mut x);
        let mut image = vec![0.0; size];
        symbolic.pattern.multiply(&values, &x, &mut image);
        assert!(image.iter().all(|value| (value - 1.0).abs() < 1e-13));
    }

    /// Orders that are no postorder are exchanged for an equivalent one.
    #[test]
    fn any_order_factors() {
        let (symbolic, values, _) = grid(3);
        let order: Vec<usize> = (0..120).map(|new| 7 * new % 120).collect();
        let other = Arc::new(SymbolicFactor::new(Arc::clone(&symbolic.pattern), order).expect("symbolic"));
        let [mut x, mut y] = [(); 2].map(|()| (0..120).map(|i| (i as f64).cos()).collect::<Vec<f64>>());
        symbolic.factorize(&values).expect("positive definite").solve_in_place(&mut x);
        other.factorize(&values).expect("positive definite").solve_in_place(&mut y);
        assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-15));
    }
}
