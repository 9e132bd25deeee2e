//! Small convex programs over half-spaces and second-order cones, by an interior-point method.
//!
//! ```text
//! min ½ zᵀPz + pᵀz   s.t.   G z ≤ g,   (M z − e)₁ ≥ |(M z − e)₂…| for every cone
//! ```

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nonsmooth::{Matrix, Vector};

/// Tolerances of the method with its longest step as a share of the way to the boundary, in turn until one is reached.
/// With 0.99, the iterates of one small quadratic program in thousands run in a circle.
const ATTEMPTS: [(f64, f64); 6] = [(1e-12, 0.99), (1e-12, 0.9), (1e-11, 0.9), (1e-10, 0.9), (1e-10, 0.7), (1e-9, 0.9)];
/// Part of a row that is left after projection below which it counts as a combination of the others.
const DEPENDENT: f64 = 1e-7;

/// The data of a program.
#[derive(Debug, Clone)]
pub struct ConeProgram {
    /// P, symmetric and positive semidefinite.
    pub hessian: Matrix,
    /// The linear term p.
    pub linear: Vector,
    /// Half-spaces: G row by row, with its side g.
    pub half_spaces: Vec<(Vector, f64)>,
    /// The cones (M, e).
    pub cones: Vec<(Matrix, Vector)>,
}

/// A primal-dual solution of the cone program.
#[derive(Debug, Clone)]
pub struct Optimum {
    /// The minimiser z.
    pub point: Vector,
    /// The value of the dual program.
    pub dual_value: f64,
}

/// The entries of a dense matrix other than zero, by columns.
fn sparse(matrix: &Matrix) -> CscMatrix<f64> {
    let (mut starts, mut indices, mut values) = (vec![0], vec![], vec![]);
    for column in matrix.column_iter() {
        for (row, value) in column.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            indices.push(row);
            values.push(*value);
        }
        starts.push(indices.len());
    }
    CscMatrix::new(matrix.nrows(), matrix.ncols(), starts, indices, values)
}

impl ConeProgram {
    /// The solution of the interior-point method to the smallest tolerance that it reaches.
    ///
    /// # Errors
    /// A text if it reaches none.
    pub fn solve(&self) -> Result<Optimum, String> {
        let mut last = Err(String::new());
        for (tolerance, longest_step) in ATTEMPTS {
            last = self.solve_to(tolerance, longest_step);
            if last.is_ok() {
                break;
            }
        }
        last
    }

    fn solve_to(&self, tolerance: f64, longest_step: f64) -> Result<Optimum, String> {
        let (n, flat) = (self.linear.len(), self.half_spaces.len());
        let height = flat + self.cones.iter().map(|(matrix, _)| matrix.nrows()).sum::<usize>();
        let (mut matrix, mut sides) = (Matrix::zeros(height, n), vec![0.0; height]);
        for (i, (normal, side)) in self.half_spaces.iter().enumerate() {
            matrix.row_mut(i).copy_from(&normal.transpose());
            sides[i] = *side;
        }
        let (mut kinds, mut first) = (vec![SupportedConeT::NonnegativeConeT(flat)], flat);
        for (cone, right) in &self.cones {
            matrix.rows_mut(first, cone.nrows()).copy_from(&-cone);
            (0..cone.nrows()).for_each(|i| sides[first + i] = -right[i]);
            kinds.push(SupportedConeT::SecondOrderConeT(cone.nrows()));
            first += cone.nrows();
        }
        let settings = DefaultSettings {
            verbose: false,
            max_threads: 1,
            max_step_fraction: longest_step,
            tol_gap_abs: tolerance,
            tol_gap_rel: tolerance,
            tol_feas: tolerance,
            ..DefaultSettings::default()
        };
        let hessian = sparse(&self.hessian.upper_triangle());
        let solver = DefaultSolver::new(&hessian, self.linear.as_slice(), &sparse(&matrix), &sides, &kinds, settings);
        let mut solver = solver.map_err(|error| error.to_string())?;
        solver.solve();
        let solution = &solver.solution;
        if solution.status != SolverStatus::Solved {
            return Err(format!("the cone program ended with {:?}", solution.status));
        }
        Ok(Optimum { point: Vector::from_column_slice(&solution.x), dual_value: solution.obj_val_dual })
    }

    /// The vertex of the half-spaces next to a solution of a linear program: the rows with the least slack, as many
    /// independent ones as there are variables. None for other programs, and where the rows do not determine a point.
    pub fn vertex(&self, near: &Vector) -> Option<Vector> {
        let n = self.linear.len();
        if !self.cones.is_empty() || self.hessian.amax() > 0.0 {
            return None;
        }
        let mut order: Vec<(f64, usize)> = self
            .half_spaces
            .iter()
            .enumerate()
            .map(|(i, (normal, side))| ((side - normal.dot(near)) / normal.norm(), i))
            .collect();
        order.sort_by(|one, next| one.0.total_cmp(&next.0));
        let (mut basis, mut chosen): (Vec<Vector>, Vec<usize>) = (vec![], vec![]);
        for (_, i) in order {
            let normal = self.half_spaces[i].0.normalize();
            let mut rest = normal;
            // Twice: once leaves the rounding errors of nearly dependent rows.
            for direction in basis.iter().chain(&basis) {
                rest -= direction * direction.dot(&rest);
            }
            if rest.norm() > DEPENDENT && chosen.len() < n {
                basis.push(rest.normalize());
                chosen.push(i);
            }
        }
        let matrix = Matrix::from_fn(chosen.len(), n, |i, j| self.half_spaces[chosen[i]].0[j]);
        let sides = Vector::from_fn(chosen.len(), |i, _| self.half_spaces[chosen[i]].1);
        if chosen.len() < n { None } else { matrix.lu().solve(&sides) }
    }
}
