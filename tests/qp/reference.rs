//! A reference solution of the QP by the interior-point solver alone: variables (d, v), no scaling.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use nonsmooth::qp::{EpigraphQp, Metric};

/// Data in the form the interior-point solver takes.
pub struct Reference {
    quadratic: CscMatrix<f64>,
    linear: Vec<f64>,
    matrix: CscMatrix<f64>,
    bounds: Vec<f64>,
    equalities: usize,
}

impl Reference {
    pub fn new(qp: &EpigraphQp<'_>) -> Self {
        let n = qp.dimension();
        let mut equal: Vec<(Vec<(usize, f64)>, f64)> = Vec::new();
        let mut below: Vec<(Vec<(usize, f64)>, f64)> = Vec::new();
        let mut push = |normal: Vec<(usize, f64)>, lower: f64, upper: f64| {
            if lower == upper {
                equal.push((normal, upper));
                return;
            }
            if lower.is_finite() {
                below.push((normal.iter().map(|&(k, a)| (k, -a)).collect(), -lower));
            }
            if upper.is_finite() {
                below.push((normal, upper));
            }
        };
        for (slope, &offset) in qp.slopes.iter().zip(qp.offsets) {
            let mut normal: Vec<(usize, f64)> = slope.iter().copied().enumerate().collect();
            normal.push((n, -1.0));
            push(normal, f64::NEG_INFINITY, offset);
        }
        for i in 0..qp.rows.nrows() {
            let normal = qp.rows.row(i).iter().copied().enumerate().filter(|(_, a)| *a != 0.0).collect();
            push(normal, qp.row_lower[i], qp.row_upper[i]);
        }
        for k in 0..n {
            push(vec![(k, 1.0)], qp.lower[k], qp.upper[k]);
        }
        let equalities = equal.len();
        equal.append(&mut below);
        let mut columns = vec![Vec::new(); n + 1];
        for (row, (normal, _)) in equal.iter().enumerate() {
            normal.iter().for_each(|&(k, a)| columns[k].push((row, a)));
        }
        let mut linear = vec![0.0; n + 1];
        linear[n] = 1.0;
        Self {
            quadratic: quadratic(qp),
            linear,
            matrix: compressed(equal.len(), &columns),
            bounds: equal.iter().map(|(_, bound)| *bound).collect(),
            equalities,
        }
    }

    /// (d, v), from scratch; none unless the solver says it reached the tolerance.
    pub fn solve(&self, tolerance: f64) -> Option<Vec<f64>> {
        let settings = DefaultSettings {
            verbose: false,
            max_threads: 1,
            tol_gap_abs: tolerance,
            tol_gap_rel: tolerance,
            tol_feas: tolerance,
            ..DefaultSettings::default()
        };
        let cones = [ZeroConeT(self.equalities), NonnegativeConeT(self.bounds.len() - self.equalities)];
        let mut solver =
            DefaultSolver::new(&self.quadratic, &self.linear, &self.matrix, &self.bounds, &cones, settings)
                .expect("valid data");
        solver.solve();
        (solver.solution.status == SolverStatus::Solved).then(|| solver.solution.x.clone())
    }
}

fn quadratic(qp: &EpigraphQp<'_>) -> CscMatrix<f64> {
    let n = qp.dimension();
    let entry = |i: usize, j: usize| match qp.metric {
        Metric::ScaledIdentity(weight) => {
            if i == j {
                weight
            } else {
                0.0
            }
        }
        Metric::Diagonal(diagonal) => {
            if i == j {
                diagonal[i]
            } else {
                0.0
            }
        }
        Metric::Dense(matrix) => matrix[(i, j)],
    };
    let mut columns: Vec<Vec<(usize, f64)>> =
        (0..n).map(|j| (0..=j).map(|i| (i, entry(i, j))).filter(|(_, h)| *h != 0.0).collect()).collect();
    columns.push(Vec::new());
    compressed(n + 1, &columns)
}

fn compressed(height: usize, columns: &[Vec<(usize, f64)>]) -> CscMatrix<f64> {
    let mut starts = vec![0];
    let (mut indices, mut values) = (Vec::new(), Vec::new());
    for column in columns {
        indices.extend(column.iter().map(|(row, _)| *row));
        values.extend(column.iter().map(|(_, value)| *value));
        starts.push(indices.len());
    }
    CscMatrix::new(height, columns.len(), starts, indices, values)
}
