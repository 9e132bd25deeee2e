//! Semismooth Newton on the contact displacements of condensed bodies, with dense matrices.
//!
//! ```text
//! φ_b(u) = f_b − S_b u_b;   λ = φ₁ (or −φ₂ where the lower body is held);   jump = u₁ − u₂
//! rows:  λ − Π(λ + c (jump − g)) = 0;   φ₁ + φ₂ = 0 on shared dofs;   φ_b = 0 on dofs without multiplier
//! ```

use crate::direct::condensation::CondensedBody;
use crate::equilibrium::certificate::projection_residual;
use crate::equilibrium::law::Linearization;
use crate::equilibrium::{ContactBoundary, ContactPoint, Stage};
use crate::error::ContactError;
use crate::linear::dense::{DenseLu, multiply};
use crate::linear::vector::norm;
use faer::Mat;

/// Condensed bodies with the contact data.
#[derive(Debug)]
pub struct CondensedContact<'a> {
    /// One or two bodies.
    pub bodies: Vec<&'a CondensedBody>,
    /// Contact nodes.
    pub boundary: &'a ContactBoundary,
    /// Held contact dofs, per body.
    pub held: &'a [Vec<bool>],
    /// Initial gaps, mm.
    pub gaps: &'a [f64],
    /// c, N/mm.
    pub stiffness: f64,
    /// Force that residuals are relative to, N.
    pub load: f64,
    /// Motions of the contact dofs of all bodies that nothing holds, to be grounded.
    pub grounded: &'a [Vec<f64>],
}

/// A Newton result.
#[derive(Debug, Clone)]
pub struct CondensedSolution {
    /// Contact displacements of all bodies, mm.
    pub displacement: Vec<f64>,
    /// Packed multipliers, N.
    pub forces: Vec<f64>,
    /// Packed jumps less gaps, mm.
    pub jumps: Vec<f64>,
    /// Derivatives selected.
    pub linearizations: Vec<Linearization>,
    /// Relative residual.
    pub residual: f64,
    /// Newton steps.
    pub steps: usize,
}

/// Tightest relative residual aimed at: below it rounding decides.
const TIGHTEST: f64 = 1e-12;
/// Newton steps allowed.
const MAX_STEPS: usize = 60;
/// Step halvings allowed.
const MAX_HALVINGS: usize = 8;
/// Times its rounding floor that a residual is seen to reach.
const FLOOR_REACHED: f64 = 100.0;
/// Residual accepted when rounding stops all progress.
const ACCEPTABLE: f64 = 1e-9;

impl CondensedContact<'_> {
    /// Contact dofs of one body.
    pub fn size(&self) -> usize {
        3 * self.boundary.points.len()
    }

    /// Dof of a packed row: (dof, row) pairs of a point; row 0 is the normal one.
    pub fn rows_of<'p>(index: usize, point: &'p ContactPoint) -> impl Iterator<Item = (usize, usize)> + 'p {
        let components = std::iter::once(2).chain(point.tangents.iter().copied());
        components.enumerate().map(move |(offset, component)| (3 * index + component, point.start + offset))
    }

    /// Solves to a relative residual, from given contact displacements or from the bonded problem.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] with the history, [`ContactError::NotFinite`].
    pub fn solve(&self, start: Option<&[f64]>, tolerance: f64) -> Result<CondensedSolution, ContactError> {
        let tolerance = tolerance.max(TIGHTEST);
        let mut u = match start {
            Some(u) if u.len() == self.size() * self.bodies.len() => u.to_vec(),
            _ => self.newton_candidate(
                &vec![0.0; self.size() * self.bodies.len()],
                &vec![Linearization::Stick; self.boundary.points.len()],
            ),
        };
        let mut residual = norm(&self.residual(&u)) / self.load;
        let mut history = vec![residual];
        while residual > tolerance && history.len() <= MAX_STEPS {
            let candidate = self.newton_candidate(&u, &self.linearize(&u));
            let previous = residual;
            (u, residual) = self.search(&u, &candidate, previous);
            if !residual.is_finite() {
                return Err(ContactError::NotFinite { what: "contact residual" });
            }
            history.push(residual);
            Stage::Contact.reached(history.len() - 1, residual);
            if residual <= ACCEPTABLE && residual > 0.5 * previous {
                break;
            }
        }
        if residual.is_nan() || residual > tolerance.max(ACCEPTABLE) {
            let floor = self.rounding_floor(&u);
            if FLOOR_REACHED * floor > tolerance.max(ACCEPTABLE) {
                let what = "displacements (bodies, gaps or loads of very different size)";
                return Err(ContactError::BeyondPrecision { what, floor, residual, tolerance: ACCEPTABLE });
            }
            return Err(ContactError::NotConverged {
                solver: "semismooth Newton on condensed bodies",
                residual,
                tolerance,
                iterations: history.len() - 1,
                history,
            });
        }
        let (forces, jumps) = self.packed(&u);
        let linearizations = self.linearize(&u);
        Ok(CondensedSolution { displacement: u, forces, jumps, linearizations, residual, steps: history.len() - 1 })
    }

    /// The state of bodies that nothing loads and nothing penetrates: no forces, no displacements.
    pub fn at_rest(&self) -> CondensedSolution {
        let displacement = vec![0.0; self.size() * self.bodies.len()];
        let (forces, jumps) = self.packed(&displacement);
        let linearizations = self.linearize(&displacement);
        CondensedSolution { displacement, forces, jumps, linearizations, residual: 0.0, steps: 0 }
    }

    /// Relative residual that rounding of S u and of c (u₁ − u₂ − g) causes.
    fn rounding_floor(&self, u: &[f64]) -> f64 {
        let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let parts = self.bodies.iter().zip(u.chunks_exact(self.size()));
        let products = parts.map(|(body, u)| {
            let diagonal = (0..self.size()).map(|dof| body.schur[(dof, dof)].abs()).fold(0.0, f64::max);
            diagonal * largest(u)
        });
        f64::EPSILON * products.fold(self.stiffness * largest(self.gaps), f64::max) / self.load
    }

    /// φ of every body.
    fn reactions(&self, u: &[f64]) -> Vec<Vec<f64>> {
        let parts = self.bodies.iter().zip(u.chunks_exact(self.size()));
        parts
            .map(|(body, u)| {
                let product = multiply(&body.schur, u);
                body.load.iter().zip(&product).map(|(load, product)| load - product).collect()
            })
            .collect()
    }

    /// Packed multipliers and jumps less gaps.
    fn packed(&self, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let reactions = self.reactions(u);
        let (mut forces, mut jumps) = (vec![0.0; self.boundary.row_count], vec![0.0; self.boundary.row_count]);
        for (index, point) in self.boundary.points.iter().enumerate() {
            for (dof, row) in Self::rows_of(index, point) {
                forces[row] = if self.held[0][dof] { -reactions[1][dof] } else { reactions[0][dof] };
                jumps[row] = u[dof] - if self.bodies.len() == 2 { u[self.size() + dof] } else { 0.0 };
            }
            jumps[point.start] -= self.gaps[index];
        }
        (forces, jumps)
    }

    fn linearize(&self, u: &[f64]) -> Vec<Linearization> {
        let (forces, jumps) = self.packed(u);
        let x: Vec<f64> = forces.iter().zip(&jumps).map(|(force, jump)| force + self.stiffness * jump).collect();
        let points = self.boundary.points.iter();
        points
            .map(|point| Linearization::at(&x[point.start..point.start + point.row_count()], self.boundary.friction))
            .collect()
    }

    /// Whether a dof has a multiplier row.
    pub fn rows_by_dof(&self) -> Vec<Option<usize>> {
        let mut rows = vec![None; self.size()];
        for (index, point) in self.boundary.points.iter().enumerate() {
            for (dof, row) in Self::rows_of(index, point) {
                rows[dof] = Some(row);
            }
        }
        rows
    }

    /// All equations at u, in N.
    pub fn residual(&self, u: &[f64]) -> Vec<f64> {
        let reactions = self.reactions(u);
        let (forces, jumps) = self.packed(u);
        let law = projection_residual(self.boundary, &forces, &jumps, self.stiffness);
        let mut residual = vec![0.0; u.len()];
        for (dof, row) in self.rows_by_dof().into_iter().enumerate() {
            let second = (self.bodies.len() == 2).then(|| reactions[1][dof]);
            let (first, upper) = match row {
                Some(row) if self.held[0][dof] => (reactions[0][dof], Some(law[row])),
                Some(row) => (law[row], second.map(|second| self.coupling(reactions[0][dof], second, dof))),
                None => (reactions[0][dof], second),
            };
            residual[dof] = first;
            if let Some(upper) = upper {
                residual[self.size() + dof] = upper;
            }
        }
        residual
    }

    /// φ₁ + φ₂ on a shared dof; φ₂ where the upper body is held (its S row is decoupled, φ₂ = −s u₂).
    fn coupling(&self, first: f64, second: f64, dof: usize) -> f64 {
        if self.held[1][dof] { second } else { first + second }
    }

    /// The solution of the equations linearised with the given derivatives at u.
    fn newton_candidate(&self, u: &[f64], linearizations: &[Linearization]) -> Vec<f64> {
        let matrix = self.newton_matrix(linearizations, self.boundary.friction);
        let mut right = self.linear_residual(u, linearizations);
        DenseLu::new(&matrix).solve_refined(&matrix, &mut right);
        u.iter().zip(&right).map(|(u, step)| u - step).collect()
    }

    /// Derivative of the residual with respect to u, grounded motions included. `coupling`: 𝓕 for Coulomb's law, 0 for
    /// slip bounds that do not follow λ_N (Tresca).
    pub fn newton_matrix(&self, linearizations: &[Linearization], coupling: f64) -> Mat<f64> {
        let size = self.size();
        let total = size * self.bodies.len();
        let mut matrix = Mat::<f64>::zeros(total, total);
        let coefficient = |body: usize, dof: usize, other: usize| -self.bodies[body].schur[(dof, other)];
        let law_rows = self.law_coefficients(linearizations, coupling);
        let rows = self.rows_by_dof();
        for column in 0..size {
            for dof in 0..size {
                let Some(row) = rows[dof] else {
                    for body in 0..self.bodies.len() {
                        matrix[(body * size + dof, body * size + column)] += coefficient(body, dof, column);
                    }
                    continue;
                };
                let lower_held = self.held[0][dof];
                let equation = if lower_held { size + dof } else { dof };
                for &(force_dof, force_factor, jump_factor) in &law_rows[row] {
                    let (body, sign) = if self.held[0][force_dof] { (1, -1.0) } else { (0, 1.0) };
                    matrix[(equation, body * size + column)] +=
                        sign * force_factor * coefficient(body, force_dof, column);
                    if force_dof == column {
                        matrix[(equation, column)] -= jump_factor;
                        if self.bodies.len() == 2 {
                            matrix[(equation, size + column)] += jump_factor;
                        }
                    }
                }
                if lower_held {
                    matrix[(dof, column)] += coefficient(0, dof, column);
                } else if self.bodies.len() == 2 {
                    matrix[(size + dof, size + column)] += coefficient(1, dof, column);
                    if !self.held[1][dof] {
                        matrix[(size + dof, column)] += coefficient(0, dof, column);
                    }
                }
            }
        }
        self.ground(&mut matrix);
        matrix
    }

    /// Adds −s m mᵀ for motions that nothing holds: their resultant is zero, so they stay at rest.
    pub fn ground(&self, matrix: &mut Mat<f64>) {
        for motion in self.grounded {
            for (j, right) in motion.iter().enumerate() {
                for (i, left) in motion.iter().enumerate() {
                    matrix[(i, j)] -= self.stiffness * left * right;
                }
            }
        }
    }

    /// Per packed row: (dof, factor of dλ, factor of c·djump) of λ − Π(x), i.e. (I − D) dλ − c D djump.
    fn law_coefficients(&self, linearizations: &[Linearization], coupling: f64) -> Vec<Vec<(usize, f64, f64)>> {
        let mut coefficients = vec![Vec::new(); self.boundary.row_count];
        for ((index, point), linearization) in self.boundary.points.iter().enumerate().zip(linearizations) {
            let rows: Vec<(usize, usize)> = Self::rows_of(index, point).collect();
            let derivative = linearization.derivative(rows.len(), coupling);
            for (i, &(_, row)) in rows.iter().enumerate() {
                for (j, &(dof, _)) in rows.iter().enumerate() {
                    let d = derivative[i][j];
                    let identity = f64::from(u8::from(i == j));
                    if identity != 0.0 || d != 0.0 {
                        coefficients[row].push((dof, identity - d, self.stiffness * d));
                    }
                }
            }
        }
        coefficients
    }

    /// Residual whose law rows use the linearisation's own value of Π: the same at a point the derivatives belong to; for the
    /// bonded start it states u = g on all rows.
    fn linear_residual(&self, u: &[f64], linearizations: &[Linearization]) -> Vec<f64> {
        let bonded = linearizations.iter().all(|l| *l == Linearization::Stick);
        let mut residual = self.residual(u);
        if bonded {
            let (_, jumps) = self.packed(u);
            for (dof, row) in self.rows_by_dof().into_iter().enumerate() {
                if let Some(row) = row {
                    let equation = if self.held[0][dof] { self.size() + dof } else { dof };
                    residual[equation] = -self.stiffness * jumps[row];
                }
            }
        }
        residual
    }

    fn search(&self, from: &[f64], to: &[f64], residual: f64) -> (Vec<f64>, f64) {
        let mut length = 1.0;
        let full = norm(&self.residual(to)) / self.load;
        for _halving in 0..=MAX_HALVINGS {
            let trial: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + length * (b - a)).collect();
            let value = norm(&self.residual(&trial)) / self.load;
            if value <= (1.0 - 1e-4 * length) * residual {
                return (trial, value);
            }
            length *= 0.5;
        }
        (to.to_vec(), full)
    }
}
