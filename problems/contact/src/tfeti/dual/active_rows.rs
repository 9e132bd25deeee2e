//! The active rows of a Newton step: λ = T y, tested with Qᵀ.
//!
//! ```text
//! unknowns y:   λ_E;  per closed node λ_N;  per stick node λ_T;  per slip node λ_p/w
//! T = Q + 𝓕 e⊗n,    Q: selection with w p on the slip rows,  w = √β
//! Qᵀ F T y + Δ y − Qᵀ Gᵀ a = r,     Δ = (1 − β)/c on the slip rows, 0 elsewhere
//! preconditioner:   Qᵀ (B_D S B_Dᵀ) Q + Z,   Z = (1 − β) c on the slip rows
//! ```
//! With the slip compliance δ = (1 − β)/(cβ) one has w = (1 + δc)^(−1/2) = √β, so Δ = w²δ, and Z is that spring in series.

use crate::equilibrium::ContactBoundary;
use crate::equilibrium::law::Linearization;

/// Row structure of one active set.
#[derive(Debug, Clone)]
pub struct ReducedRows<'a> {
    boundary: &'a ContactBoundary,
    equality_count: usize,
    /// Derivative selected per contact node.
    pub linearizations: Vec<Linearization>,
    starts: Vec<usize>,
    /// Number of unknowns y.
    pub dimension: usize,
    stiffness: f64,
}

impl<'a> ReducedRows<'a> {
    /// The rows of an active set; `stiffness` is c, N/mm.
    pub fn new(
        boundary: &'a ContactBoundary,
        equality_count: usize,
        linearizations: Vec<Linearization>,
        stiffness: f64,
    ) -> Self {
        let mut dimension = equality_count;
        let mut starts = Vec::with_capacity(linearizations.len());
        for (point, linearization) in boundary.points.iter().zip(&linearizations) {
            starts.push(dimension);
            dimension += match linearization {
                Linearization::Open => 0,
                Linearization::Stick => point.row_count(),
                Linearization::Slip { .. } => point.tangents.len(),
            };
        }
        Self { boundary, equality_count, linearizations, starts, dimension, stiffness }
    }

    /// Calls `visit(node's first row, its number of rows, its first unknown, derivative)` for every closed node.
    fn closed_nodes(&self, mut visit: impl FnMut(usize, usize, usize, &Linearization)) {
        for ((point, linearization), &start) in self.boundary.points.iter().zip(&self.linearizations).zip(&self.starts)
        {
            if *linearization != Linearization::Open {
                visit(self.equality_count + point.start, point.row_count(), start, linearization);
            }
        }
    }

    /// T y (with `coulomb`) or Q y (without the column 𝓕 e⊗n).
    pub fn expand(&self, reduced: &[f64], coulomb: bool) -> Vec<f64> {
        let mut rows = vec![0.0; self.equality_count + self.boundary.row_count];
        rows[..self.equality_count].copy_from_slice(&reduced[..self.equality_count]);
        let friction = if coulomb { self.boundary.friction } else { 0.0 };
        self.closed_nodes(|row, count, unknown, linearization| match *linearization {
            Linearization::Slip { direction, ratio } => {
                rows[row] = reduced[unknown];
                for tangent in 1..count {
                    rows[row + tangent] = friction * reduced[unknown] * direction[tangent - 1];
                }
                if count == 3 {
                    let along = ratio.sqrt() * reduced[unknown + 1];
                    rows[row + 1] -= along * direction[1];
                    rows[row + 2] += along * direction[0];
                }
            }
            _ => rows[row..row + count].copy_from_slice(&reduced[unknown..unknown + count]),
        });
        rows
    }

    /// Tᵀ r (with `coulomb`) or Qᵀ r.
    pub fn restrict(&self, rows: &[f64], coulomb: bool) -> Vec<f64> {
        let mut reduced = vec![0.0; self.dimension];
        reduced[..self.equality_count].copy_from_slice(&rows[..self.equality_count]);
        let friction = if coulomb { self.boundary.friction } else { 0.0 };
        self.closed_nodes(|row, count, unknown, linearization| match *linearization {
            Linearization::Slip { direction, ratio } => {
                let along: f64 = (1..count).map(|tangent| direction[tangent - 1] * rows[row + tangent]).sum();
                reduced[unknown] = rows[row] + friction * along;
                if count == 3 {
                    reduced[unknown + 1] = ratio.sqrt() * (direction[0] * rows[row + 2] - direction[1] * rows[row + 1]);
                }
            }
            _ => reduced[unknown..unknown + count].copy_from_slice(&rows[row..row + count]),
        });
        reduced
    }

    /// The y whose T y is nearest to the given multipliers in the obvious sense: dropped rows are left out.
    pub fn initial(&self, multipliers: &[f64]) -> Vec<f64> {
        let mut reduced = vec![0.0; self.dimension];
        reduced[..self.equality_count].copy_from_slice(&multipliers[..self.equality_count]);
        self.closed_nodes(|row, count, unknown, linearization| match *linearization {
            Linearization::Slip { direction, ratio } => {
                reduced[unknown] = multipliers[row];
                if count == 3 && ratio > 0.0 {
                    let along = direction[0] * multipliers[row + 2] - direction[1] * multipliers[row + 1];
                    reduced[unknown + 1] = along / ratio.sqrt();
                }
            }
            _ => reduced[unknown..unknown + count].copy_from_slice(&multipliers[row..row + count]),
        });
        reduced
    }

    /// Adds `factor`·D y for a diagonal D that is `value(β)` on the slip rows and 0 elsewhere.
    fn add_slip_diagonal(&self, reduced: &[f64], result: &mut [f64], factor: f64, value: impl Fn(f64) -> f64) {
        self.closed_nodes(|_, count, unknown, linearization| {
            if let (Linearization::Slip { ratio, .. }, 3) = (linearization, count) {
                result[unknown + 1] += factor * value(*ratio) * reduced[unknown + 1];
            }
        });
    }

    /// result += factor·Δ y.
    pub fn add_compliance(&self, reduced: &[f64], result: &mut [f64], factor: f64) {
        self.add_slip_diagonal(reduced, result, factor, |ratio| (1.0 - ratio) / self.stiffness);
    }

    /// result += Z y.
    pub fn add_spring(&self, reduced: &[f64], result: &mut [f64]) {
        self.add_slip_diagonal(reduced, result, 1.0, |ratio| (1.0 - ratio) * self.stiffness);
    }

    /// Columns (left, right) of every contact unknown as combinations of rows: left for T, right for Q.
    pub fn contact_columns(&self, coulomb: bool, mut visit: impl FnMut(&[(usize, f64)], &[(usize, f64)])) {
        let friction = if coulomb { self.boundary.friction } else { 0.0 };
        self.closed_nodes(|row, count, _, linearization| match *linearization {
            Linearization::Slip { direction, ratio } => {
                let mut left = vec![(row, 1.0)];
                left.extend((1..count).map(|tangent| (row + tangent, friction * direction[tangent - 1])));
                visit(&left, &[(row, 1.0)]);
                if count == 3 {
                    let weight = ratio.sqrt();
                    let column = [(row + 1, -weight * direction[1]), (row + 2, weight * direction[0])];
                    visit(&column, &column);
                }
            }
            _ => {
                for offset in 0..count {
                    visit(&[(row + offset, 1.0)], &[(row + offset, 1.0)]);
                }
            }
        });
    }
}
