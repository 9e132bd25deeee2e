//! The primal–dual active set method.
//!
//! ```text
//! active = { λ + (ψ − u) > 0 };    u = ψ on the active nodes,   A u = b elsewhere;   λ = A u − b        until the set stays
//! ```
//! A is an M-matrix: from the second step on u ≥ ψ, u grows and the active set only shrinks, so that the method ends.

use crate::membrane::grid::MembraneGrid;
use contact::linear::FactorizationError;
use contact::linear::cholesky::{NumericFactor, SymbolicFactor};
use contact::linear::ordering::nested_dissection;
use contact::linear::symmetric::LowerPattern;
use nonsmooth::OracleError;
use std::sync::Arc;

/// A state; its dual is (u*, λ*), the inner nodes of u first.
#[derive(Debug)]
pub struct MembraneState {
    /// u at the inner nodes.
    pub displacement: Vec<f64>,
    /// λ at the inner nodes, load per area.
    pub reaction: Vec<f64>,
    /// Nodes on which the obstacle presses.
    pub active: Vec<bool>,
    /// Number of linear systems solved.
    pub steps: usize,
    pub(super) factor: NumericFactor,
}

/// The matrix with active rows and columns replaced by the identity.
#[derive(Debug)]
pub struct ReducedMembrane {
    pattern: Arc<LowerPattern>,
    symbolic: Arc<SymbolicFactor>,
}

/// Largest number of steps; the method needs about as many as there are grid lines.
const MAX_STEPS: usize = 1000;

impl ReducedMembrane {
    /// One symbolic analysis for all active sets.
    ///
    /// # Errors
    /// [`FactorizationError`] when it fails.
    pub fn new(grid: &MembraneGrid) -> Result<Self, FactorizationError> {
        let neighbours = (0..grid.node_count()).map(|index| grid.neighbours(index).collect());
        let pattern = Arc::new(LowerPattern::from_columns(neighbours.collect()));
        let count = grid.node_count();
        let graph: Vec<Vec<u32>> = (0..count)
            .map(|index| grid.neighbours(index).filter(|other| *other != index).map(|other| other as u32).collect())
            .collect();
        let place = |index: usize| [(index / grid.inner()) as f64, (index % grid.inner()) as f64, 0.0];
        let order = nested_dissection(&(0..count).map(place).collect::<Vec<_>>(), &graph, &[]);
        let symbolic = Arc::new(SymbolicFactor::new(Arc::clone(&pattern), order)?);
        Ok(Self { pattern, symbolic })
    }

    /// Solves A u − b = λ ≥ 0, u ≥ ψ, λ(u − ψ) = 0 from an active set.
    ///
    /// # Errors
    /// [`OracleError::NotConverged`] with the share of nodes that still changed as residual,
    /// [`OracleError::NotFinite`], and [`OracleError::Failed`] when the matrix cannot be factored.
    pub fn solve(
        &self,
        grid: &MembraneGrid,
        load: &[f64],
        obstacle: &[f64],
        start: Option<&[bool]>,
    ) -> Result<MembraneState, OracleError> {
        let mut active = start.map_or_else(|| vec![false; load.len()], <[bool]>::to_vec);
        let size = load.iter().zip(obstacle).fold(0.0_f64, |size, (b, psi)| size.max(b.abs()).max(psi.abs()));
        let rounding = 64.0 * f64::EPSILON * size;
        let mut changed = 0;
        for step in 1..=MAX_STEPS {
            let factor = self.factorize(&active).map_err(|error| OracleError::Failed(Box::new(error)))?;
            let held: Vec<f64> = active.iter().zip(obstacle).map(|(&a, &psi)| if a { psi } else { 0.0 }).collect();
            let from_held = grid.multiply(&held);
            let mut u: Vec<f64> =
                (0..load.len()).map(|i| if active[i] { obstacle[i] } else { load[i] - from_held[i] }).collect();
            factor.solve_in_place(&mut u);
            if u.iter().any(|value| !value.is_finite()) {
                return Err(OracleError::NotFinite { what: "membrane" });
            }
            let image = grid.multiply(&u);
            let reaction: Vec<f64> = (0..u.len()).map(|i| if active[i] { image[i] - load[i] } else { 0.0 }).collect();
            // A held node with no reaction beyond rounding is on the kink: it counts as free.
            let next: Vec<bool> = (0..u.len())
                .map(|i| if active[i] { reaction[i] > rounding } else { obstacle[i] - u[i] > rounding })
                .collect();
            changed = next.iter().zip(&active).filter(|(new, old)| new != old).count();
            if changed == 0 {
                let area = grid.width() * grid.width();
                let reaction = reaction.into_iter().map(|reaction| reaction / area).collect();
                return Ok(MembraneState { displacement: u, reaction, active, steps: step, factor });
            }
            active = next;
        }
        Err(OracleError::NotConverged {
            solver: "primal–dual active sets",
            residual: changed as f64 / load.len() as f64,
            iterations: MAX_STEPS,
        })
    }

    fn factorize(&self, active: &[bool]) -> Result<NumericFactor, FactorizationError> {
        let mut values = Vec::with_capacity(self.pattern.entry_count());
        for column in 0..self.pattern.dimension() {
            for &row in &self.pattern.rows()[self.pattern.starts()[column]..self.pattern.starts()[column + 1]] {
                values.push(match (row == column, active[row] || active[column]) {
                    (true, true) => 1.0,
                    (true, false) => 4.0,
                    (false, true) => 0.0,
                    (false, false) => -1.0,
                });
            }
        }
        self.symbolic.factorize(&values)
    }
}
