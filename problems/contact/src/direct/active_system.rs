//! Newton's matrix over the nodes that are not open, then the motions.
//!
//! ```text
//! M = [I − ρ D + ρ D C   −ρ D R;   Rᵀ  0],    ρ = 1/(1 + δ)
//! sliding node, e: direction of slip:   row e − 𝓕·row N  is  e·δλ − 𝓕 δλ_N = r_e − 𝓕 r_N,  without C
//! S M T = [M′  S_k M e;  0  I]:         T: columns N + 𝓕 e and p ⟂ e, then e;   S: rows N and p, then e − 𝓕 N
//! ```
//! What a node transmits along its direction of slip follows its normal force, so that two of three rows of a sliding
//! node are left to factor.

use crate::direct::compliant_contact::CompliantContact;
use crate::equilibrium::law::{Friction, Linearization};
use crate::linear::dense::{DenseLu, multiply, multiply_columns};
use crate::linear::vector::{add_scaled, dot, norm};
use faer::Mat;
use std::ops::Range;

/// Steps of refinement of solutions for several right sides.
const REFINEMENTS: usize = 2;

/// Which rows of sliding nodes are factored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    /// All.
    All,
    /// Those in which compliances stand.
    Coupled,
}

/// A node that is not open.
#[derive(Debug)]
struct ActiveNode {
    /// Its first packed row, and its number of rows.
    start: usize,
    count: usize,
    /// Its first place among the rows of M, and of M′.
    first: usize,
    kept_first: usize,
    /// Number of rows of M′; the first ones of S and columns of T, with S_k D.
    kept: usize,
    rows: [[f64; 3]; 3],
    columns: [[f64; 3]; 3],
    derivative: [[f64; 3]; 3],
    /// e, where the node slides and this force is eliminated, and 𝓕.
    eliminated: Option<([f64; 3], f64)>,
}

/// M′ over the rows of the nodes that are not open, then the motions.
#[derive(Debug)]
pub(super) struct ActiveSystem {
    nodes: Vec<ActiveNode>,
    /// The packed rows of these nodes.
    rows: Vec<usize>,
    kept: usize,
    rho: f64,
    matrix: Mat<f64>,
}

/// The system with a factor of it.
#[derive(Debug)]
pub(super) struct ActiveFactor {
    system: ActiveSystem,
    factors: DenseLu,
}

#[inline]
fn inner(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(axis: usize) -> [f64; 3] {
    std::array::from_fn(|other| if other == axis { 1.0 } else { 0.0 })
}

impl ActiveNode {
    fn new(
        (start, count): (usize, usize),
        [first, kept_first]: [usize; 2],
        linearization: &Linearization,
        friction: f64,
        kept: Kept,
    ) -> Self {
        let d = linearization.derivative(count, friction);
        let all = [0, 1, 2].map(unit);
        let (mut rows, mut columns, mut number, mut eliminated) = (all, all, count, None);
        if let (Linearization::Slip { direction: [x, y], .. }, Kept::Coupled) = (linearization, kept) {
            let (along, across) = ([0.0, *x, *y], [0.0, -y, *x]);
            (rows[1], columns[0], columns[1]) = (across, [1.0, friction * x, friction * y], across);
            (number, eliminated) = (count - 1, Some((along, friction)));
        }
        let derivative = rows.map(|row| std::array::from_fn(|column| inner(&row, &d.map(|own| own[column]))));
        Self { start, count, first, kept_first, kept: number, rows, columns, derivative, eliminated }
    }

    fn range(&self) -> Range<usize> {
        self.first..self.first + self.count
    }

    /// The entries of the node in a vector over the rows of M.
    fn of(&self, values: &[f64]) -> [f64; 3] {
        std::array::from_fn(|row| if row < self.count { values[self.first + row] } else { 0.0 })
    }

    /// S_k r at the node.
    fn reduced(&self, right: [f64; 3], target: &mut [f64]) {
        (0..self.kept).for_each(|row| target[self.kept_first + row] = inner(&self.rows[row], &right));
    }

    /// Σ_k (column k of vectors of three)·values of the node in a vector over the rows of M′.
    fn combined(&self, vectors: &[[f64; 3]; 3], values: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        (0..self.kept).for_each(|k| add_scaled(&mut sum, values[self.kept_first + k], &vectors[k]));
        sum
    }
}

impl ActiveSystem {
    /// The system at given derivatives for a compliance δ of the contact nodes.
    pub(super) fn new(
        contact: &CompliantContact,
        linearizations: &[Linearization],
        delta: f64,
        friction: Friction,
        kept: Kept,
    ) -> Self {
        let points = contact.problem.boundary.points.iter().zip(linearizations);
        let (mut nodes, mut rows, mut kept_count) = (Vec::<ActiveNode>::new(), Vec::new(), 0);
        for (point, linearization) in points.filter(|(_, linearization)| **linearization != Linearization::Open) {
            let (place, firsts) = ((point.start, point.row_count()), [rows.len(), kept_count]);
            let node = ActiveNode::new(place, firsts, linearization, friction.of(point), kept);
            kept_count += node.kept;
            rows.extend(point.rows());
            nodes.push(node);
        }
        let mut system = Self { nodes, rows, kept: kept_count, rho: 1.0 / (1.0 + delta), matrix: Mat::new() };
        system.assemble(contact);
        system
    }

    fn assemble(&mut self, contact: &CompliantContact) {
        let (kept, motions, rho) = (self.kept, contact.resultant.len(), self.rho);
        let mut matrix = Mat::<f64>::zeros(kept + motions, kept + motions);
        let mut image = vec![0.0; contact.row_count()];
        for node in &self.nodes {
            for (k, direction) in node.columns.iter().enumerate().take(node.kept) {
                image.fill(0.0);
                for (row, &share) in direction.iter().enumerate().take(node.count).filter(|(_, share)| **share != 0.0) {
                    add_scaled(&mut image, share, contact.compliance.col_as_slice(node.start + row));
                }
                let column = matrix.col_as_slice_mut(node.kept_first + k);
                self.add_image(rho, &image, column);
                // (I − ρ D) at the node itself.
                for row in 0..node.kept {
                    column[node.kept_first + row] +=
                        inner(&node.rows[row], direction) - rho * inner(&node.derivative[row], direction);
                }
                for (motion, entry) in column[kept..].iter_mut().enumerate() {
                    let own = contact.motions.col_as_slice(motion)[node.start..].iter();
                    *entry = own.zip(direction).take(node.count).map(|(r, d)| r * d).sum();
                }
            }
        }
        for motion in 0..motions {
            self.add_image(-rho, contact.motions.col_as_slice(motion), matrix.col_as_slice_mut(kept + motion));
        }
        self.matrix = matrix;
    }

    /// Adds a factor times S_k D w for jumps w over all packed rows.
    fn add_image(&self, factor: f64, jumps: &[f64], target: &mut [f64]) {
        for node in &self.nodes {
            let own: [f64; 3] = std::array::from_fn(|row| if row < node.count { jumps[node.start + row] } else { 0.0 });
            for row in 0..node.kept {
                target[node.kept_first + row] += factor * inner(&node.derivative[row], &own);
            }
        }
    }

    /// Puts springs along the motions.
    pub(super) fn with_springs(mut self, spring: f64) -> Self {
        put_springs(&mut self.matrix, self.kept, spring);
        self
    }

    /// M′.
    pub(super) fn matrix(&self) -> &Mat<f64> {
        &self.matrix
    }

    /// The packed rows of the nodes.
    pub(super) fn rows(&self) -> &[usize] {
        &self.rows
    }

    fn motions(&self) -> usize {
        self.matrix.nrows() - self.kept
    }

    /// Forces over all packed rows from those over the rows of M, one column each; what follows these is not read.
    fn spread(&self, contact: &CompliantContact, forces: &Mat<f64>) -> Mat<f64> {
        let mut spread = Mat::zeros(contact.row_count(), forces.ncols());
        for column in 0..forces.ncols() {
            let (own, target) = (forces.col_as_slice(column), spread.col_as_slice_mut(column));
            self.rows.iter().zip(own).for_each(|(&row, force)| target[row] = *force);
        }
        spread
    }
}

impl ActiveFactor {
    /// Factors a system, with springs along the motions that the system itself need not have: refinement takes them
    /// off again wherever the system determines the answer.
    pub(super) fn new(system: ActiveSystem, spring: Option<f64>) -> Self {
        let sprung = spring.filter(|_| system.motions() > 0).map(|spring| {
            let mut sprung = system.matrix.clone();
            put_springs(&mut sprung, system.kept, spring);
            sprung
        });
        let factors = DenseLu::new(sprung.as_ref().unwrap_or(&system.matrix));
        Self { system, factors }
    }

    /// The packed rows of the nodes that are not open: the rows of M.
    pub(super) fn rows(&self) -> &[usize] {
        &self.system.rows
    }

    /// Forces over all packed rows of solutions, one column each.
    pub(super) fn forces(&self, contact: &CompliantContact, solutions: &Mat<f64>) -> Mat<f64> {
        self.system.spread(contact, solutions)
    }

    /// M⁻¹ r over the rows of M, then the motions, refined once.
    pub(super) fn solve(&self, contact: &CompliantContact, right: Vec<f64>) -> Vec<f64> {
        let right = Mat::from_fn(right.len(), 1, |row, _| right[row]);
        let (mut reduced, known) = self.reduce(contact, &right);
        self.factors.solve_refined(&self.system.matrix, reduced.col_as_slice_mut(0));
        self.expand(&reduced, known).col_as_slice(0).to_vec()
    }

    /// M⁻¹ for several right sides, with the largest relative residual of a column.
    pub(super) fn solve_columns(&self, contact: &CompliantContact, right: &Mat<f64>) -> (Mat<f64>, f64) {
        let (reduced, known) = self.reduce(contact, right);
        let (solution, residual) = refined(&self.factors, &self.system.matrix, reduced);
        (self.expand(&solution, known), residual)
    }

    /// The right side of M′, and the forces over the rows of M that are eliminated.
    fn reduce(&self, contact: &CompliantContact, right: &Mat<f64>) -> (Mat<f64>, Mat<f64>) {
        let system = &self.system;
        let (size, kept) = (system.rows.len(), system.kept);
        let mut reduced = Mat::zeros(kept + system.motions(), right.ncols());
        let mut known = Mat::zeros(size, right.ncols());
        for column in 0..right.ncols() {
            let (own, target) = (right.col_as_slice(column), reduced.col_as_slice_mut(column));
            for node in &system.nodes {
                let right = node.of(own);
                node.reduced(right, target);
                if let Some((along, friction)) = node.eliminated {
                    let force = inner(&along, &right) - friction * right[0];
                    let target = known.col_as_slice_mut(column)[node.range()].iter_mut();
                    target.zip(along).for_each(|(target, along)| *target = force * along);
                }
            }
            target[kept..].copy_from_slice(&own[size..]);
        }
        if system.nodes.iter().any(|node| node.eliminated.is_some()) {
            // S_k (I − ρ D) e is 0, so that C alone couples them.
            let forces = system.spread(contact, &known);
            let jumps = multiply_columns(&contact.compliance, &forces);
            for column in 0..right.ncols() {
                let target = reduced.col_as_slice_mut(column);
                system.add_image(-system.rho, jumps.col_as_slice(column), target);
                for (motion, entry) in target[kept..].iter_mut().enumerate() {
                    *entry -= dot(contact.motions.col_as_slice(motion), forces.col_as_slice(column));
                }
            }
        }
        (reduced, known)
    }

    /// The solution over the rows of M, then the motions.
    fn expand(&self, reduced: &Mat<f64>, known: Mat<f64>) -> Mat<f64> {
        let system = &self.system;
        let (size, kept) = (system.rows.len(), system.kept);
        let mut solution = Mat::zeros(size + system.motions(), reduced.ncols());
        for column in 0..reduced.ncols() {
            let (own, target) = (reduced.col_as_slice(column), solution.col_as_slice_mut(column));
            target[..size].copy_from_slice(known.col_as_slice(column));
            for node in &system.nodes {
                let forces = node.combined(&node.columns, own);
                target[node.range()].iter_mut().zip(forces).for_each(|(target, force)| *target += force);
            }
            target[size..].copy_from_slice(&own[kept..]);
        }
        solution
    }

    /// M⁻ᵀ j over the rows of M, then the motions, refined once.
    pub(super) fn solve_transposed(&self, contact: &CompliantContact, right: &[f64]) -> Vec<f64> {
        let system = &self.system;
        let (size, kept) = (system.rows.len(), system.kept);
        let mut reduced = vec![0.0; kept + system.motions()];
        for node in &system.nodes {
            let own = node.of(right);
            (0..node.kept).for_each(|k| reduced[node.kept_first + k] = inner(&node.columns[k], &own));
        }
        reduced[kept..].copy_from_slice(&right[size..]);
        self.factors.solve_transpose_refined(&system.matrix, &mut reduced);
        let mut solution = vec![0.0; size + system.motions()];
        let mut pushed = vec![0.0; contact.row_count()];
        for node in &system.nodes {
            let own = node.combined(&node.rows, &reduced);
            solution[node.range()].iter_mut().zip(own).for_each(|(target, own)| *target = own);
            let own = node.combined(&node.derivative, &reduced);
            pushed[node.start..node.start + node.count].iter_mut().zip(own).for_each(|(target, own)| *target = own);
        }
        solution[size..].copy_from_slice(&reduced[kept..]);
        if system.nodes.iter().any(|node| node.eliminated.is_some()) {
            // e·(j − Mᵀ ψ), where e·(I − ρ Dᵀ) ψ is 0.
            let mut image = multiply(&contact.compliance, &pushed);
            image.iter_mut().for_each(|entry| *entry *= system.rho);
            for (motion, amplitude) in reduced[kept..].iter().enumerate() {
                add_scaled(&mut image, *amplitude, contact.motions.col_as_slice(motion));
            }
            for node in &system.nodes {
                let Some((along, friction)) = node.eliminated else { continue };
                let image: f64 = image[node.start..].iter().zip(along).take(node.count).map(|(x, e)| x * e).sum();
                let share = inner(&along, &node.of(right)) - image;
                let own = solution[node.range()].iter_mut().zip([-friction, along[1], along[2]]);
                own.for_each(|(target, factor)| *target += share * factor);
            }
        }
        solution
    }
}

/// Springs along the motions, which follow the rows of the nodes.
fn put_springs(matrix: &mut Mat<f64>, rows: usize, spring: f64) {
    (rows..matrix.nrows()).for_each(|motion| matrix[(motion, motion)] = spring);
}

/// M⁻¹ B by a factor of a matrix near M, refined against M; also the largest relative residual of a column.
fn refined(factor: &DenseLu, matrix: &Mat<f64>, right: Mat<f64>) -> (Mat<f64>, f64) {
    let mut solution = right.clone();
    factor.solve_columns_in_place(&mut solution);
    let mut rest = &right - multiply_columns(matrix, &solution);
    for _refinement in 0..REFINEMENTS {
        let mut correction = rest.clone();
        factor.solve_columns_in_place(&mut correction);
        let better = &solution + correction;
        let remaining = &right - multiply_columns(matrix, &better);
        for column in 0..right.ncols() {
            if norm(remaining.col_as_slice(column)) < norm(rest.col_as_slice(column)) {
                solution.col_as_slice_mut(column).copy_from_slice(better.col_as_slice(column));
                rest.col_as_slice_mut(column).copy_from_slice(remaining.col_as_slice(column));
            }
        }
    }
    let relative = (0..right.ncols()).map(|column| {
        let size = norm(right.col_as_slice(column));
        if size > 0.0 { norm(rest.col_as_slice(column)) / size } else { 0.0 }
    });
    let residual = relative.fold(0.0, f64::max);
    (solution, residual)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::DirectSolver;
    use crate::equilibrium::{ContactPoint, ContactProblem};
    use crate::scene::hertz;
    use std::sync::Arc;

    /// Nodes that are open, stick and slide in turn, and a right side without structure.
    fn case(contact: &CompliantContact) -> (Vec<Linearization>, Vec<f64>) {
        let points = contact.problem.boundary.points.iter();
        let of_node = |(number, point): (usize, &ContactPoint)| {
            let angle = 0.7 * number as f64;
            let direction = if point.row_count() == 3 { [angle.cos(), angle.sin()] } else { [-1.0, 0.0] };
            let can_slide = if point.row_count() > 1 { number % 3 } else { number % 2 };
            [Linearization::Open, Linearization::Stick, Linearization::Slip { direction, ratio: 0.3 }][can_slide]
        };
        let linearizations: Vec<Linearization> = points.clone().enumerate().map(of_node).collect();
        let points = points.zip(&linearizations);
        let closed = points.filter(|(_, linearization)| **linearization != Linearization::Open);
        let count = closed.map(|(point, _)| point.row_count()).sum::<usize>() + contact.resultant.len();
        (linearizations, (0..count).map(|row| (1.3 * row as f64).sin()).collect())
    }

    #[test]
    fn what_is_eliminated_is_what_all_rows_give() {
        let scene = hertz().expect("the example").with_bricks([5; 3], [1; 3]);
        let controls = scene.start();
        let solver = DirectSolver::new(Arc::new(ContactProblem::new(scene).expect("a scene"))).expect("a pattern");
        let contact = solver.contact(&controls).expect("bodies");
        let (linearizations, right) = case(&contact);
        for delta in [0.0, 0.5] {
            let system =
                |kept| ActiveSystem::new(&contact, &linearizations, delta, Friction::Coulomb, kept).with_springs(1e-3);
            let [all, coupled] = [Kept::All, Kept::Coupled].map(|kept| ActiveFactor::new(system(kept), None));
            assert!(coupled.system.kept < all.system.kept);
            let columns = Mat::from_fn(right.len(), 2, |row, column| right[row] * (column + 1) as f64);
            let several = [&all, &coupled].map(|factor| factor.solve_columns(&contact, &columns).0);
            let pairs = [
                [&all, &coupled].map(|factor| factor.solve(&contact, right.clone())),
                [&all, &coupled].map(|factor| factor.solve_transposed(&contact, &right)),
                several.map(|solution| solution.col_as_slice(1).to_vec()),
            ];
            for [all, coupled] in pairs {
                let difference: Vec<f64> = all.iter().zip(&coupled).map(|(a, b)| a - b).collect();
                assert!(norm(&difference) < 1e-11 * norm(&all), "{:.1e}", norm(&difference) / norm(&all));
            }
        }
    }
}
