//! Equilibria by cone programs: the path that owes nothing to Newton's method.
//!
//! ```text
//! min ½ λᵀCλ − (d − 𝓕 s)ᵀλ,   λ in the friction cones,   Rᵀλ = e;      s := |w_T| per node, to be repeated until it stays
//! ```
//! Without friction one convex program gives the state. With friction its fixed points are the equilibria.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use contact::direct::CompliantContact;

/// Most programs that are solved with friction.
const MAX_PROGRAMS: usize = 12;
/// Relative change of s that ends the fixed point.
const SETTLED: f64 = 1e-9;

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

/// Forces and amplitudes of an equilibrium, as nearly as cone programs give them; none where one of them is not solved.
pub fn equilibrium(contact: &CompliantContact) -> Option<Vec<f64>> {
    let boundary = &contact.problem.boundary;
    let mut slips = vec![0.0; boundary.points.len()];
    let programs = if boundary.has_friction() { MAX_PROGRAMS } else { 1 };
    let mut found = None;
    for _program in 0..programs {
        let unknowns = program(contact, &slips)?;
        let jumps = contact.jumps(&unknowns, 0.0);
        let slip =
            |start: usize, count: usize| jumps[start + 1..start + count].iter().map(|j| j * j).sum::<f64>().sqrt();
        let next: Vec<f64> = boundary.points.iter().map(|point| slip(point.start, point.row_count())).collect();
        let change = next.iter().zip(&slips).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let size = next.iter().copied().fold(1.0, f64::max);
        found = Some(unknowns);
        slips = next;
        if change <= SETTLED * size {
            break;
        }
    }
    found
}

/// One cone program for given norms of the slip.
fn program(contact: &CompliantContact, slips: &[f64]) -> Option<Vec<f64>> {
    let boundary = &contact.problem.boundary;
    let (count, motions) = (contact.row_count(), contact.resultant.len());
    let quadratic =
        sparse(count, (0..count).map(|j| (0..=j).map(|i| (i, contact.compliance[(i, j)])).collect()).collect());
    let mut linear: Vec<f64> = contact.constant().iter().map(|d| -d).collect();
    let mut columns: Vec<Vec<(usize, f64)>> =
        (0..count).map(|row| (0..motions).map(|k| (k, contact.motions[(row, k)])).collect()).collect();
    let mut right = contact.resultant.clone();
    let mut cones = vec![SupportedConeT::ZeroConeT(motions)];
    for (point, slip) in boundary.points.iter().zip(slips) {
        linear[point.start] += boundary.friction * slip;
        let rows = point.row_count();
        let factor = if rows == 1 { 1.0 } else { boundary.friction };
        columns[point.start].push((right.len(), -factor));
        for offset in 1..rows {
            columns[point.start + offset].push((right.len() + offset, -1.0));
        }
        right.resize(right.len() + rows, 0.0);
        cones.push(if rows == 1 {
            SupportedConeT::NonnegativeConeT(1)
        } else {
            SupportedConeT::SecondOrderConeT(rows)
        });
    }
    let constraints = sparse(right.len(), columns);
    let settings = DefaultSettingsBuilder::default().verbose(false).max_iter(100).build().ok()?;
    let mut solver = DefaultSolver::new(&quadratic, &linear, &constraints, &right, &cones, settings).ok()?;
    solver.solve();
    let solution = &solver.solution;
    let solved = matches!(solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    solved.then(|| solution.x.iter().copied().chain(solution.z[..motions].iter().map(|z| -z)).collect())
}
