//! The adjoint of the condensed problem, assembled on its own (not by transposing the Newton matrix).
//!
//! ```text
//! K p + Bᵀ η = 0:   η = −S₁ p₁ on the lower body, S₂ p₂ = η on the upper
//! open: η = 0;   stick: B p = j;   slip: (B p − j)_N + 𝓕 e·(B p − j)_T = 0,  e·η_T = 0,  p·(B p − j)_T = (1 − β)/(cβ) p·η_T
//! ```

use crate::direct::newton::CondensedContact;
use crate::equilibrium::law::Linearization;
use crate::linear::dense::{DenseLu, multiply};
use faer::Mat;

/// One equation at a node: Σ jump factors·(B p − j) + Σ force factors·η = 0, entries (packed offset, jump, force).
type Equation = Vec<(usize, f64, f64)>;

impl CondensedContact<'_> {
    /// Adjoint contact displacements of all bodies and packed η, for packed j.
    pub fn adjoint(&self, linearizations: &[Linearization], direction: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let size = self.size();
        let total = size * self.bodies.len();
        let mut matrix = Mat::<f64>::zeros(total, total);
        let mut right = vec![0.0; total];
        let mut has_row = vec![false; size];
        for (index, point) in self.boundary.points.iter().enumerate() {
            let rows: Vec<(usize, usize)> = Self::rows_of(index, point).collect();
            let equations = node_equations(&linearizations[index], rows.len(), self.boundary.friction, self.stiffness);
            for (&(dof, _), equation) in rows.iter().zip(equations) {
                has_row[dof] = true;
                let target = if self.held[0][dof] { size + dof } else { dof };
                for (offset, jump, force) in equation {
                    let (other, packed) = rows[offset];
                    self.add_jump(&mut matrix, target, other, jump);
                    self.add_reaction(&mut matrix, target, other, force);
                    right[target] += jump * direction[packed];
                }
                self.add_balance(&mut matrix, dof);
            }
        }
        for (dof, has_row) in has_row.into_iter().enumerate() {
            if !has_row {
                (0..self.bodies.len()).for_each(|body| self.add_schur(&mut matrix, body * size + dof, body, dof, 1.0));
            }
        }
        self.ground(&mut matrix);
        DenseLu::new(&matrix).solve_refined(&matrix, &mut right);
        let eta = self.packed_reactions(&right);
        (right, eta)
    }

    /// matrix[target] += factor·(p₁ − p₂)[dof].
    fn add_jump(&self, matrix: &mut Mat<f64>, target: usize, dof: usize, factor: f64) {
        matrix[(target, dof)] += factor;
        if self.bodies.len() == 2 {
            matrix[(target, self.size() + dof)] -= factor;
        }
    }

    /// matrix[target] += factor·η[dof].
    fn add_reaction(&self, matrix: &mut Mat<f64>, target: usize, dof: usize, factor: f64) {
        let (body, sign) = if self.held[0][dof] { (1, 1.0) } else { (0, -1.0) };
        self.add_schur(matrix, target, body, dof, sign * factor);
    }

    /// matrix[target] += factor·(S_b p_b)[dof].
    fn add_schur(&self, matrix: &mut Mat<f64>, target: usize, body: usize, dof: usize, factor: f64) {
        if factor == 0.0 {
            return;
        }
        for column in 0..self.size() {
            matrix[(target, body * self.size() + column)] += factor * self.bodies[body].schur[(dof, column)];
        }
    }

    /// The second equation of a dof with a row: p₁ = 0 where the lower body is held, S₁p₁ + S₂p₂ = 0 where both are free.
    fn add_balance(&self, matrix: &mut Mat<f64>, dof: usize) {
        if self.held[0][dof] {
            self.add_schur(matrix, dof, 0, dof, 1.0);
        } else if self.bodies.len() == 2 {
            let target = self.size() + dof;
            self.add_schur(matrix, target, 1, dof, 1.0);
            if !self.held[1][dof] {
                self.add_schur(matrix, target, 0, dof, 1.0);
            }
        }
    }

    /// η per packed row.
    fn packed_reactions(&self, p: &[f64]) -> Vec<f64> {
        let products: Vec<Vec<f64>> =
            self.bodies.iter().zip(p.chunks_exact(self.size())).map(|(body, p)| multiply(&body.schur, p)).collect();
        let mut packed = vec![0.0; self.boundary.row_count];
        for (index, point) in self.boundary.points.iter().enumerate() {
            for (dof, row) in Self::rows_of(index, point) {
                packed[row] = if self.held[0][dof] { products[1][dof] } else { -products[0][dof] };
            }
        }
        packed
    }
}

/// The equations of one node, as many as it has rows.
fn node_equations(linearization: &Linearization, count: usize, friction: f64, stiffness: f64) -> Vec<Equation> {
    match *linearization {
        // Forces and jumps are of different size: scale η by 1/c.
        Linearization::Open => (0..count).map(|row| vec![(row, 0.0, 1.0 / stiffness)]).collect(),
        Linearization::Stick => (0..count).map(|row| vec![(row, 1.0, 0.0)]).collect(),
        Linearization::Slip { direction, ratio } => {
            let mut normal = vec![(0, 1.0, 0.0)];
            normal.extend((1..count).map(|row| (row, friction * direction[row - 1], 0.0)));
            let along = (1..count).map(|row| (row, 0.0, direction[row - 1] / stiffness)).collect();
            let mut equations = vec![normal, along];
            if count == 3 {
                let across = [-direction[1], direction[0]];
                // β (B p − j) − (1 − β)/c η = 0, free of division by a small β.
                let equation =
                    (1..3).map(|row| (row, ratio * across[row - 1], -(1.0 - ratio) / stiffness * across[row - 1]));
                equations.push(equation.collect());
            }
            equations
        }
    }
}
