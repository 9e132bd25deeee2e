//! Interior-point method (Clarabel): slow second path for what the active-set method cannot finish.
//!
//! ```text
//! d = s W d̂,  v = s² v̂,  W = diag(H)^{-1/2}:      min v̂ + ½ d̂ᵀ (W H W) d̂,   every row divided by its norm
//! ```
//! s starts at the length of the free step and is multiplied by |d̂| until d̂ is of order one, three times at most.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, SupportedConeT, ZeroConeT,
};

use crate::interruption::interrupted;
use crate::{Matrix, Vector};

use super::answer::assemble;
use super::kernels::norm;
use super::problem::{EpigraphQp, QpError, QpMethod, QpSolution};
use super::sides::Member;
use super::working_set::{Active, Side};

/// Answer of the interior-point method and the members it found active.
pub(super) struct InteriorAnswer {
    pub(super) solution: QpSolution,
    pub(super) actives: Vec<Active>,
}

/// Solves the QP; the certificate of the answer tells its quality.
pub(super) fn solve(qp: &EpigraphQp<'_>) -> Result<InteriorAnswer, QpError> {
    let weights = Vector::from_fn(qp.dimension(), |i, _| qp.metric.diagonal_entry(i).sqrt().recip());
    let free = qp.slopes.iter().map(|slope| norm(slope.component_mul(&weights).as_slice())).fold(0.0, f64::max);
    let mut length = if free > 0.0 { free } else { 1.0 };
    let mut best: Option<InteriorAnswer> = None;
    for _ in 0..4 {
        let (answer, reached) = solve_scaled(qp, &weights, length)?;
        if best.as_ref().is_none_or(|best| answer.solution.kkt_residual < best.solution.kkt_residual) {
            best = Some(answer);
        }
        if !(reached > 0.0 && reached.is_finite()) || (1e-2..1e2).contains(&reached) || interrupted() {
            break;
        }
        length *= reached;
    }
    best.ok_or(QpError::NotSolved { kkt_residual: f64::INFINITY })
}

/// One side of one member as a scaled inequality  normalᵀ d̂ − c v̂ ≤ bound.
pub(crate) struct ScaledSide {
    member: Member,
    side: Side,
    /// The norm that the original side was divided by.
    divisor: f64,
    pub(crate) normal: Vec<(usize, f64)>,
    pub(crate) bound: f64,
}

impl ScaledSide {
    fn is_equality(&self) -> bool {
        self.side == Side::Both
    }

    /// The multiplier of the member, > 0 at an upper side and < 0 at a lower one, for one of this inequality in units
    /// of `unit`.
    fn multiplier(&self, multiplier: f64, unit: f64) -> f64 {
        let sign = if self.side == Side::Lower { -1.0 } else { 1.0 };
        sign * multiplier * unit / self.divisor
    }

    /// Adds the multiplier of the member to those of the rows and of the bounds; that of a cut is left out.
    pub(crate) fn add_multiplier(&self, multiplier: f64, unit: f64, (rows, bounds): &mut (Vector, Vector)) {
        match self.member {
            Member::Row(i) => rows[i] += self.multiplier(multiplier, unit),
            Member::Bound(k) => bounds[k] += self.multiplier(multiplier, unit),
            Member::Cut(_) => {}
        }
    }
}

fn solve_scaled(qp: &EpigraphQp<'_>, weights: &Vector, length: f64) -> Result<(InteriorAnswer, f64), QpError> {
    let n = qp.dimension();
    let mut sides = scaled_sides(qp, weights, length);
    let equalities = equalities_first(&mut sides);
    let mut linear = vec![0.0; n + 1];
    linear[n] = 1.0;
    let bounds: Vec<f64> = sides.iter().map(|side| side.bound).collect();
    let cones: [SupportedConeT<f64>; 2] = [ZeroConeT(equalities), NonnegativeConeT(sides.len() - equalities)];
    let quadratic = scaled_metric(qp, weights);
    let mut solver = DefaultSolver::new(&quadratic, &linear, &side_matrix(&sides, n + 1), &bounds, &cones, settings())
        .map_err(|_| QpError::NotSolved { kkt_residual: f64::INFINITY })?;
    solver.set_termination_callback(|_| interrupted());
    solver.solve();
    let found = &solver.solution;
    if matches!(found.status, SolverStatus::PrimalInfeasible) {
        let gap: f64 = -bounds.iter().zip(&found.z).map(|(b, z)| b * z).sum::<f64>();
        let terms: f64 = bounds.iter().zip(&found.z).map(|(b, z)| (b * z).abs()).sum();
        return Err(QpError::Infeasible { violation: gap / terms.max(f64::MIN_POSITIVE) });
    }
    let step = Vector::from_fn(n, |i, _| found.x[i] * weights[i] * length);
    let reached = norm(&found.x[..n]);
    let actives = active_sides(&sides, &found.z, &found.s, length);
    let solution = assemble(qp, step, &actives, 0, QpMethod::InteriorPoint);
    Ok((InteriorAnswer { solution, actives }, reached))
}

/// Settings for the most that double precision gives.
pub(crate) fn settings() -> DefaultSettings<f64> {
    DefaultSettings {
        verbose: false,
        max_threads: 1,
        presolve_enable: false,
        tol_gap_abs: 1e-13,
        tol_gap_rel: 1e-13,
        tol_feas: 1e-13,
        ..DefaultSettings::default()
    }
}

/// Sides whose multiplier outweighs their slack, with multipliers in the units of the QP.
fn active_sides(sides: &[ScaledSide], multipliers: &[f64], slacks: &[f64], length: f64) -> Vec<Active> {
    let mut actives: Vec<Active> = Vec::new();
    for ((side, &multiplier), &slack) in sides.iter().zip(multipliers).zip(slacks) {
        if !side.is_equality() && multiplier <= slack {
            continue;
        }
        let multiplier = side.multiplier(multiplier, length * length);
        actives.push(Active { member: side.member, side: side.side, multiplier });
    }
    actives
}

/// Sorts equalities to the front; their number.
pub(crate) fn equalities_first(sides: &mut [ScaledSide]) -> usize {
    sides.sort_by_key(|side| !side.is_equality());
    sides.iter().filter(|side| side.is_equality()).count()
}

fn scaled_sides(qp: &EpigraphQp<'_>, weights: &Vector, length: f64) -> Vec<ScaledSide> {
    let n = qp.dimension();
    let scaled = |entry: f64, k: usize| entry * weights[k] * length;
    let mut sides = Vec::new();
    for (j, (slope, &offset)) in qp.slopes.iter().zip(qp.offsets).enumerate() {
        let mut normal: Vec<(usize, f64)> = (0..n).map(|k| (k, scaled(slope[k], k))).collect();
        normal.push((n, -length * length));
        push_sides(&mut sides, Member::Cut(j), &normal, f64::NEG_INFINITY, offset);
    }
    push_set(&mut sides, qp.rows, (qp.row_lower, qp.row_upper), (qp.lower, qp.upper), scaled);
    sides
}

/// The finite sides of rows and bounds of d; `scaled`: the entry of a normal at d̂_k for one at d_k.
pub(crate) fn push_set(
    sides: &mut Vec<ScaledSide>,
    rows: &Matrix,
    of_rows: (&Vector, &Vector),
    bounds: (&Vector, &Vector),
    scaled: impl Fn(f64, usize) -> f64,
) {
    for (i, row) in rows.row_iter().enumerate() {
        let entries = row.iter().enumerate().filter(|(_, entry)| **entry != 0.0);
        let normal: Vec<(usize, f64)> = entries.map(|(k, entry)| (k, scaled(*entry, k))).collect();
        push_sides(sides, Member::Row(i), &normal, of_rows.0[i], of_rows.1[i]);
    }
    for k in 0..rows.ncols() {
        push_sides(sides, Member::Bound(k), &[(k, scaled(1.0, k))], bounds.0[k], bounds.1[k]);
    }
}

/// The finite sides of an interval, divided by the norm of the normal.
fn push_sides(sides: &mut Vec<ScaledSide>, member: Member, normal: &[(usize, f64)], lower: f64, upper: f64) {
    let size = normal.iter().map(|(_, a)| a * a).sum::<f64>().sqrt();
    let divisor = if size > 0.0 { size } else { 1.0 };
    let mut push = |side: Side, sign: f64, bound: f64| {
        if bound.is_finite() {
            let normal = normal.iter().map(|&(k, a)| (k, sign * a / divisor)).collect();
            sides.push(ScaledSide { member, side, divisor, normal, bound: sign * bound / divisor });
        }
    };
    if lower == upper {
        push(Side::Both, 1.0, upper);
    } else {
        push(Side::Upper, 1.0, upper);
        push(Side::Lower, -1.0, lower);
    }
}

fn side_matrix(sides: &[ScaledSide], width: usize) -> CscMatrix<f64> {
    let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); width];
    for (row, side) in sides.iter().enumerate() {
        for &(column, value) in &side.normal {
            columns[column].push((row, value));
        }
    }
    compressed(sides.len(), &columns)
}

/// Upper triangle of W H W, with an empty last column for v̂.
fn scaled_metric(qp: &EpigraphQp<'_>, weights: &Vector) -> CscMatrix<f64> {
    let n = qp.dimension();
    let entry = |i: usize, j: usize, matrix: &Matrix| matrix[(i, j)] * weights[i] * weights[j];
    let mut columns: Vec<Vec<(usize, f64)>> = match qp.metric {
        super::Metric::Dense(matrix) => {
            (0..n).map(|j| (0..=j).map(|i| (i, entry(i, j, matrix))).filter(|(_, h)| *h != 0.0).collect()).collect()
        }
        _ => (0..n).map(|j| vec![(j, 1.0)]).collect(),
    };
    columns.push(Vec::new());
    compressed(n + 1, &columns)
}

/// A sparse matrix from its columns, each a list of rows and values.
pub(crate) fn compressed(height: usize, columns: &[Vec<(usize, f64)>]) -> CscMatrix<f64> {
    let mut starts = vec![0];
    let (mut indices, mut values) = (Vec::new(), Vec::new());
    for column in columns {
        indices.extend(column.iter().map(|(row, _)| *row));
        values.extend(column.iter().map(|(_, value)| *value));
        starts.push(indices.len());
    }
    CscMatrix::new(height, columns.len(), starts, indices, values)
}

#[cfg(test)]
mod tests {
    use super::super::{EpigraphQpSolver, Metric};
    use super::*;

    /// Twelve variables, nine cuts, an equality, two-sided rows, a box; in units far from one.
    fn with_example(check: impl Fn(&EpigraphQp<'_>)) {
        let (n, unit) = (12, 1e-5);
        let wave = |i: usize, j: usize| ((3 * i + 1) as f64 * (0.7 * j as f64 + 0.3)).sin();
        let slopes: Vec<Vector> = (0..9).map(|j| Vector::from_fn(n, |i, _| 1e4 * wave(i, j))).collect();
        let offsets: Vec<f64> = (0..9).map(|j| 1e4 * unit * 0.1 * j as f64).collect();
        let ids: Vec<u64> = (0..9).collect();
        let rows = Matrix::from_fn(4, n, |i, j| wave(i + 20, j));
        let side = |value: f64| Vector::from_fn(4, |i, _| if i == 0 { 0.2 * unit } else { value * unit });
        let bound = Vector::from_element(n, unit);
        let qp = EpigraphQp {
            metric: Metric::ScaledIdentity(1e8),
            slopes: &slopes,
            offsets: &offsets,
            cut_ids: &ids,
            rows: &rows,
            row_lower: &side(-0.3),
            row_upper: &side(0.3),
            lower: &(-&bound),
            upper: &bound,
        };
        check(&qp);
    }

    #[test]
    fn both_methods_agree() {
        with_example(|qp| {
            let own = EpigraphQpSolver::new().solve(qp).expect("feasible");
            let interior = solve(qp).expect("feasible").solution;
            // Without refinement by the active-set method: tolerance 1e-13 of the objective, about its root in the
            // step.
            assert!(interior.kkt_residual <= 1e-7, "{:e}", interior.kkt_residual);
            assert!((&own.step - &interior.step).norm() <= 1e-6 * own.step.norm());
        });
    }

    #[test]
    fn an_empty_set_is_recognised() {
        with_example(|qp| {
            let (low, high) = (qp.row_lower.add_scalar(1.0), qp.row_upper.add_scalar(1.0));
            let empty = EpigraphQp { row_lower: &low, row_upper: &high, ..*qp };
            assert!(matches!(solve(&empty), Err(QpError::Infeasible { violation }) if violation > 0.1));
        });
    }
}
