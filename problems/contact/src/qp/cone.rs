//! Convex quadratic programs over friction cones, by an interior-point method.
//!
//! ```text
//! min ½ xᵀHx + qᵀx   s.t.   Rᵀ x = e,   |x_T| ≤ slope·x_N in every cone;          H x + q − R y ∈ the dual of the cones
//! ```

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use faer::Mat;
use nonsmooth::interruption::interrupted;

/// Iterations of the interior-point method that are worth while: a program takes some twenty.
pub const MAX_ITERATIONS: usize = 100;

/// A cone over some entries of x in a row: |the others| ≤ slope · the first; the half-line of the first where it is
/// alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// Index of the normal entry, the first one of the cone.
    pub first: usize,
    /// Number of entries, the normal one included.
    pub size: usize,
    /// Slope of the cone, > 0.
    pub slope: f64,
}

/// The data of a program.
#[derive(Debug, Clone)]
pub struct ConeProgram<'a> {
    /// H, symmetric and positive semidefinite.
    pub hessian: &'a Mat<f64>,
    /// The linear term q.
    pub linear: Vec<f64>,
    /// R, one column per equality.
    pub equalities: &'a Mat<f64>,
    /// The right side e of the equalities.
    pub right_side: Vec<f64>,
    /// The cones, which cover all entries.
    pub cones: Vec<Cone>,
}

/// Where the method ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimiser {
    /// The minimiser x.
    pub entries: Vec<f64>,
    /// The multipliers y of the equalities.
    pub multipliers: Vec<f64>,
    /// Whether the method calls it a solution.
    pub solved: bool,
    /// Iterations, each of which factors a matrix of the size of H.
    pub iterations: usize,
}

/// Columns of a sparse matrix in the order of the entries.
fn sparse(rows: usize, columns: Vec<Vec<(usize, f64)>>) -> CscMatrix<f64> {
    let mut starts = vec![0];
    let (mut indices, mut values) = (Vec::new(), Vec::new());
    for column in &columns {
        for &(row, value) in column.iter().filter(|(_, value)| *value != 0.0) {
            indices.push(row);
            values.push(value);
        }
        starts.push(indices.len());
    }
    CscMatrix::new(rows, columns.len(), starts, indices, values)
}

impl ConeProgram<'_> {
    /// The minimiser x and the multipliers y as found in so many iterations; none where the method fails.
    pub fn minimise(&self, max_iterations: usize) -> Option<Minimiser> {
        let (count, motions) = (self.linear.len(), self.right_side.len());
        let upper = (0..count).map(|j| (0..=j).map(|i| (i, self.hessian[(i, j)])).collect()).collect();
        let mut columns: Vec<Vec<(usize, f64)>> =
            (0..count).map(|row| (0..motions).map(|k| (k, self.equalities[(row, k)])).collect()).collect();
        let mut right = self.right_side.clone();
        let mut cones = vec![SupportedConeT::ZeroConeT(motions)];
        for cone in &self.cones {
            let factor = if cone.size == 1 { 1.0 } else { cone.slope };
            columns[cone.first].push((right.len(), -factor));
            for offset in 1..cone.size {
                columns[cone.first + offset].push((right.len() + offset, -1.0));
            }
            right.resize(right.len() + cone.size, 0.0);
            cones.push(match cone.size {
                1 => SupportedConeT::NonnegativeConeT(1),
                size => SupportedConeT::SecondOrderConeT(size),
            });
        }
        let (quadratic, constraints) = (sparse(count, upper), sparse(right.len(), columns));
        let iterations = u32::try_from(max_iterations).unwrap_or(u32::MAX);
        let settings = DefaultSettingsBuilder::default().verbose(false).max_iter(iterations).build().ok()?;
        let mut solver = DefaultSolver::new(&quadratic, &self.linear, &constraints, &right, &cones, settings).ok()?;
        solver.set_termination_callback(|_| interrupted());
        solver.solve();
        let solution = &solver.solution;
        let entries = solution.x.clone();
        let multipliers: Vec<f64> = solution.z[..motions].iter().map(|z| -z).collect();
        let finite = entries.iter().chain(&multipliers).all(|entry| entry.is_finite());
        finite.then_some(Minimiser {
            entries,
            multipliers,
            solved: matches!(solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved),
            iterations: solution.iterations as usize,
        })
    }
}
