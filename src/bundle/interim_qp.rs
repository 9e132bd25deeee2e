//! Interim subproblem solver with the interface of `crate::qp`, by the interior-point package alone.

use crate::{Matrix, Polyhedron, Vector};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

pub(crate) enum Metric<'a> {
    Diagonal(&'a Vector),
    Dense(&'a Matrix),
}

pub(crate) struct EpigraphQp<'a> {
    pub metric: Metric<'a>,
    pub slopes: &'a [Vector],
    pub offsets: &'a [f64],
    #[allow(dead_code)]
    pub cut_ids: &'a [u64],
    pub rows: &'a Matrix,
    pub row_lower: &'a Vector,
    pub row_upper: &'a Vector,
    pub lower: &'a Vector,
    pub upper: &'a Vector,
}

pub(crate) struct QpSolution {
    pub step: Vector,
    pub epigraph: f64,
    pub cut_multipliers: Vec<f64>,
    pub row_multipliers: Vector,
    pub bound_multipliers: Vector,
    pub kkt_residual: f64,
}

#[derive(Debug, Clone, thiserror::Error)]
pub(crate) enum QpError {
    #[error("interior point stopped with {0}")]
    Stopped(String),
    #[error("infeasible")]
    Infeasible,
}

#[derive(Debug, Default)]
pub(crate) struct EpigraphQpSolver {
    solves: usize,
}

struct Rows {
    entries: Vec<(usize, usize, f64)>,
    sides: Vec<f64>,
}

impl Rows {
    fn push(&mut self, row: impl Iterator<Item = (usize, f64)>, side: f64) {
        let i = self.sides.len();
        self.entries.extend(row.filter(|e| e.1 != 0.0).map(|(j, a)| (i, j, a)));
        self.sides.push(side);
    }
}

impl EpigraphQpSolver {
    pub(crate) fn solves(&self) -> usize {
        self.solves
    }

    pub(crate) fn solve(&mut self, qp: &EpigraphQp<'_>) -> Result<QpSolution, QpError> {
        self.solves += 1;
        let n = qp.lower.len();
        let mut rows = Rows { entries: vec![], sides: vec![] };
        // value scale b, length scale s: d = s e, v = b w
        let s = 1.0_f64;
        let b = 1.0_f64;
        let equal = |l: f64, u: f64| l == u;
        for i in 0..qp.rows.nrows() {
            if equal(qp.row_lower[i], qp.row_upper[i]) {
                rows.push(qp.rows.row(i).iter().copied().enumerate(), qp.row_upper[i] / s);
            }
        }
        for i in 0..n {
            if equal(qp.lower[i], qp.upper[i]) {
                rows.push(std::iter::once((i, 1.0)), qp.upper[i] / s);
            }
        }
        let equalities = rows.sides.len();
        for (g, e) in qp.slopes.iter().zip(qp.offsets) {
            rows.push(g.iter().map(|g| g * s / b).enumerate().chain(std::iter::once((n, -1.0))), e / b);
        }
        for i in 0..qp.rows.nrows() {
            if !equal(qp.row_lower[i], qp.row_upper[i]) {
                if qp.row_upper[i].is_finite() {
                    rows.push(qp.rows.row(i).iter().copied().enumerate(), qp.row_upper[i] / s);
                }
                if qp.row_lower[i].is_finite() {
                    rows.push(qp.rows.row(i).iter().map(|a| -a).enumerate(), -qp.row_lower[i] / s);
                }
            }
        }
        for i in 0..n {
            if !equal(qp.lower[i], qp.upper[i]) {
                if qp.upper[i].is_finite() {
                    rows.push(std::iter::once((i, 1.0)), qp.upper[i] / s);
                }
                if qp.lower[i].is_finite() {
                    rows.push(std::iter::once((i, -1.0)), -qp.lower[i] / s);
                }
            }
        }
        let m = rows.sides.len();
        let mut p: Vec<(usize, usize, f64)> = vec![];
        let factor = s * s / b;
        match &qp.metric {
            Metric::Diagonal(w) => p.extend((0..n).map(|i| (i, i, w[i] * factor))),
            Metric::Dense(h) => {
                for j in 0..n {
                    for i in 0..=j {
                        p.push((i, j, h[(i, j)] * factor));
                    }
                }
            }
        }
        let csc = |rows: usize, cols: usize, t: &[(usize, usize, f64)]| {
            CscMatrix::new_from_triplets(
                rows,
                cols,
                t.iter().map(|e| e.0).collect(),
                t.iter().map(|e| e.1).collect(),
                t.iter().map(|e| e.2).collect(),
            )
        };
        let mut q = vec![0.0; n + 1];
        q[n] = 1.0;
        let cones = [SupportedConeT::ZeroConeT(equalities), SupportedConeT::NonnegativeConeT(m - equalities)];
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-13,
            tol_gap_rel: 1e-13,
            tol_feas: 1e-13,
            max_iter: 100,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(
            &csc(n + 1, n + 1, &p),
            &q,
            &csc(m, n + 1, &rows.entries),
            &rows.sides,
            &cones,
            settings,
        )
        .map_err(|e| QpError::Stopped(format!("{e:?}")))?;
        solver.solve();
        let status = solver.solution.status;
        match status {
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => return Err(QpError::Infeasible),
            _ => {}
        }
        let x = &solver.solution.x;
        let z = &solver.solution.z;
        if x.iter().any(|v| !v.is_finite()) {
            return Err(QpError::Stopped(format!("{status:?}")));
        }
        let step = Vector::from_fn(n, |i, _| x[i] * s);
        let mut row_multipliers = Vector::zeros(qp.rows.nrows());
        let mut bound_multipliers = Vector::zeros(n);
        let mut k = 0;
        for i in 0..qp.rows.nrows() {
            if equal(qp.row_lower[i], qp.row_upper[i]) {
                row_multipliers[i] = z[k] * b / s;
                k += 1;
            }
        }
        for i in 0..n {
            if equal(qp.lower[i], qp.upper[i]) {
                bound_multipliers[i] = z[k] * b / s;
                k += 1;
            }
        }
        let cut_multipliers: Vec<f64> = z[k..k + qp.slopes.len()].iter().map(|m| m.max(0.0)).collect();
        let total: f64 = cut_multipliers.iter().sum();
        let cut_multipliers =
            cut_multipliers.iter().map(|m| m / total).map(|m| if m < 1e-11 { 0.0 } else { m }).collect();
        k += qp.slopes.len();
        for i in 0..qp.rows.nrows() {
            if !equal(qp.row_lower[i], qp.row_upper[i]) {
                if qp.row_upper[i].is_finite() {
                    row_multipliers[i] += z[k] * b / s;
                    k += 1;
                }
                if qp.row_lower[i].is_finite() {
                    row_multipliers[i] -= z[k] * b / s;
                    k += 1;
                }
            }
        }
        for i in 0..n {
            if !equal(qp.lower[i], qp.upper[i]) {
                if qp.upper[i].is_finite() {
                    bound_multipliers[i] += z[k] * b / s;
                    k += 1;
                }
                if qp.lower[i].is_finite() {
                    bound_multipliers[i] -= z[k] * b / s;
                    k += 1;
                }
            }
        }
        let epigraph =
            qp.slopes.iter().zip(qp.offsets).map(|(g, e)| g.dot(&step) - e).fold(f64::NEG_INFINITY, f64::max);
        Ok(QpSolution { step, epigraph, cut_multipliers, row_multipliers, bound_multipliers, kkt_residual: 0.0 })
    }
}

pub(crate) fn project(set: &Polyhedron, x: &Vector) -> Result<Vector, QpError> {
    let n = x.len();
    let ax = set.rows() * x;
    let (rl, ru) = (set.row_lower() - &ax, set.row_upper() - &ax);
    let (l, u) = (set.lower() - x, set.upper() - x);
    let ones = Vector::from_element(n, 1.0);
    let qp = EpigraphQp {
        metric: Metric::Diagonal(&ones),
        slopes: &[Vector::zeros(n)],
        offsets: &[0.0],
        cut_ids: &[0],
        rows: set.rows(),
        row_lower: &rl,
        row_upper: &ru,
        lower: &l,
        upper: &u,
    };
    Ok(set.clamp_to_box(&(x + EpigraphQpSolver::default().solve(&qp)?.step)))
}
