//! The active rows of a Newton step: λ = T y, tested with Qᵀ.
//!
//! ```text
//! unknowns y:   λ_E;  per closed node λ_N;  per stick node λ_T;  per slip node λ_p/w
//! T = Q + 𝓕 e⊗n,    Q: selection with w p on the slip rows,  w = √β;        T = Q where the slip bounds are given (Tresca)
//! Qᵀ F T y + Δ y − Qᵀ Gᵀ a = r,     Δ = (1 − β)/c on the slip rows, 0 elsewhere
//! preconditioner:   Qᵀ (B_D S B_Dᵀ) Q + Z,   Z = (1 − β) c on the slip rows
//! ```
//! With the slip compliance δ = (1 − β)/(cβ) one has w = (1 + δc)^(−1/2) = √β, so Δ = w²δ, and Z is a spring in series.

use crate::equilibrium::law::{Friction, Linearization};
use crate::equilibrium::{ContactBoundary, ContactPoint};
use crate::linear::entry::Entry;
use crate::tfeti::torn::RowVector;

/// Row structure of one choice of derivatives.
#[derive(Debug)]
pub struct ActiveRows<'a> {
    boundary: &'a ContactBoundary,
    equality_count: usize,
    linearizations: Vec<Linearization>,
    starts: Vec<usize>,
    dimension: usize,
    stiffness: f64,
    /// What bounds the traction in T: the friction coefficients 𝓕, or 0.
    friction: Friction,
}

impl<'a> ActiveRows<'a> {
    /// The rows of given derivatives; `stiffness` is c, N/mm.
    pub fn new(
        boundary: &'a ContactBoundary,
        equality_count: usize,
        linearizations: Vec<Linearization>,
        stiffness: f64,
        friction: Friction,
    ) -> Self {
        let mut dimension = equality_count;
        let mut starts = Vec::with_capacity(linearizations.len());
        for (point, linearization) in boundary.points.iter().zip(&linearizations) {
            starts.push(dimension);
            dimension += match linearization {
                Linearization::Open => 0,
                Linearization::Stick => point.row_count(),
                Linearization::Slip { .. } => point.tangents,
            };
        }
        Self { boundary, equality_count, linearizations, starts, dimension, stiffness, friction }
    }

    /// Number of unknowns y.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Calls `visit(node, its first unknown, derivative)` per closed node.
    fn closed_nodes(&self, mut visit: impl FnMut(&ContactPoint, usize, &Linearization)) {
        for ((point, linearization), &start) in self.boundary.points.iter().zip(&self.linearizations).zip(&self.starts)
        {
            if *linearization != Linearization::Open {
                visit(point, start, linearization);
            }
        }
    }

    /// The product T y.
    pub fn trial<V: Entry>(&self, unknowns: &[V]) -> RowVector<V> {
        self.expand(unknowns, self.friction)
    }

    /// The product Q y.
    pub fn test<V: Entry>(&self, unknowns: &[V]) -> RowVector<V> {
        self.expand(unknowns, Friction::Tresca)
    }

    /// The product Tᵀ r.
    pub fn trial_transposed<V: Entry>(&self, rows: &RowVector<V>) -> Vec<V> {
        self.restrict(rows, self.friction)
    }

    /// The product Qᵀ r.
    pub fn test_transposed<V: Entry>(&self, rows: &RowVector<V>) -> Vec<V> {
        self.restrict(rows, Friction::Tresca)
    }

    /// (Q + 𝓕 e⊗n) y for Coulomb's law, else Q y.
    fn expand<V: Entry>(&self, unknowns: &[V], friction: Friction) -> RowVector<V> {
        let mut result = vec![V::ZERO; self.equality_count + self.boundary.row_count];
        let (equality, rows) = result.split_at_mut(self.equality_count);
        equality.copy_from_slice(&unknowns[..self.equality_count]);
        self.closed_nodes(|point, unknown, linearization| match *linearization {
            Linearization::Slip { direction, ratio } => {
                let (row, count) = (point.start, point.row_count());
                rows[row] = unknowns[unknown];
                for tangent in 1..count {
                    rows[row + tangent].add_scaled(friction.of(point) * direction[tangent - 1], &unknowns[unknown]);
                }
                if count == 3 {
                    let across = &unknowns[unknown + 1];
                    rows[row + 1].add_scaled(-ratio.sqrt() * direction[1], across);
                    rows[row + 2].add_scaled(ratio.sqrt() * direction[0], across);
                }
            }
            _ => rows[point.rows()].copy_from_slice(&unknowns[unknown..unknown + point.row_count()]),
        });
        RowVector::new(result, self.equality_count)
    }

    /// (Q + 𝓕 e⊗n)ᵀ r for Coulomb's law, else Qᵀ r.
    fn restrict<V: Entry>(&self, all: &RowVector<V>, friction: Friction) -> Vec<V> {
        self.reduce(all, |point, rows, direction, ratio| {
            let mut normal = rows[0];
            for (row, e) in rows[1..].iter().zip(direction) {
                normal.add_scaled(friction.of(point) * e, row);
            }
            [normal, across(rows, direction, ratio.sqrt())]
        })
    }

    /// The unknowns y that repeat given multipliers: T y has their values on B_E, their normal forces on the closed
    /// nodes, their tangential forces on the stick nodes, and their part across the slip direction on the slip nodes.
    pub fn unknowns_of(&self, multipliers: &RowVector) -> Vec<f64> {
        self.reduce(multipliers, |_, rows, direction, ratio| {
            [rows[0], if ratio > 0.0 { across(rows, direction, 1.0 / ratio.sqrt()) } else { 0.0 }]
        })
    }

    /// Unknowns from all rows: those of B_E and of stick nodes as they are, those of slip nodes by `slip(node, rows, e,
    /// β)`.
    fn reduce<V: Entry>(
        &self,
        all: &RowVector<V>,
        slip: impl Fn(&ContactPoint, &[V], [f64; 2], f64) -> [V; 2],
    ) -> Vec<V> {
        let (equality, rows) = all.split();
        let mut unknowns = vec![V::ZERO; self.dimension];
        unknowns[..self.equality_count].copy_from_slice(equality);
        self.closed_nodes(|point, unknown, linearization| {
            let (rows, count) = (&rows[point.rows()], point.row_count());
            match *linearization {
                Linearization::Slip { direction, ratio } => {
                    let values = slip(point, rows, direction, ratio);
                    unknowns[unknown..unknown + count - 1].copy_from_slice(&values[..count - 1]);
                }
                _ => unknowns[unknown..unknown + count].copy_from_slice(rows),
            }
        });
        unknowns
    }

    /// Adds `factor`·D y for a diagonal D that is `value(β)` on the slip rows and 0 elsewhere.
    fn add_slip_diagonal<V: Entry>(&self, reduced: &[V], result: &mut [V], factor: f64, value: impl Fn(f64) -> f64) {
        self.closed_nodes(|point, unknown, linearization| {
            if let (Linearization::Slip { ratio, .. }, 3) = (linearization, point.row_count()) {
                result[unknown + 1].add_scaled(factor * value(*ratio), &reduced[unknown + 1]);
            }
        });
    }

    /// result += factor·Δ y.
    pub fn add_compliance<V: Entry>(&self, unknowns: &[V], result: &mut [V], factor: f64) {
        self.add_slip_diagonal(unknowns, result, factor, |ratio| (1.0 - ratio) / self.stiffness);
    }

    /// result += Z y.
    pub fn add_spring<V: Entry>(&self, unknowns: &[V], result: &mut [V]) {
        self.add_slip_diagonal(unknowns, result, 1.0, |ratio| (1.0 - ratio) * self.stiffness);
    }

    /// Calls `visit(column of T, column of Q)` for every contact unknown; columns are combinations (row of B, weight).
    pub fn contact_columns(&self, mut visit: impl FnMut(&[(usize, f64)], &[(usize, f64)])) {
        self.closed_nodes(|point, _, linearization| {
            let (row, count) = (self.equality_count + point.start, point.row_count());
            match *linearization {
                Linearization::Slip { direction, ratio } => {
                    let mut trial = vec![(row, 1.0)];
                    let tangents =
                        (1..count).map(|tangent| (row + tangent, self.friction.of(point) * direction[tangent - 1]));
                    trial.extend(tangents);
                    visit(&trial, &[(row, 1.0)]);
                    if count == 3 {
                        let weight = ratio.sqrt();
                        let column = [(row + 1, -weight * direction[1]), (row + 2, weight * direction[0])];
                        visit(&column, &column);
                    }
                }
                _ => (row..row + count).for_each(|row| visit(&[(row, 1.0)], &[(row, 1.0)])),
            }
        });
    }
}

/// The part of the tangential rows of a node across a slip direction, times a factor; 0 if there is one row.
fn across<V: Entry>(rows: &[V], direction: [f64; 2], factor: f64) -> V {
    let mut part = V::ZERO;
    if let [_, first, second] = rows {
        part.add_scaled(factor * direction[0], second);
        part.add_scaled(-factor * direction[1], first);
    }
    part
}
