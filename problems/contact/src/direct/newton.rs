//! Semismooth Newton on contact forces and rigid motions, with continuation in the contact compliance.
//!
//! ```text
//! λ = Π(λ + ρ w),  w = d − (C + δ) λ + R a,  Rᵀ λ = e,   ρ = 1/(1 + δ)            δ = 0, else 1, 10², … brought down to 0
//! ```
//! From the bonded state, δ = 0 is enough in most scenes. With a large compliance δ of its own every contact node
//! yields, and Newton's method converges from the bonded guess also where few nodes hold the bodies; the state of every
//! δ is the start of the next. A proximal spring in the rigid block of the derivative keeps it regular where the closed
//! nodes leave a motion free; the residual does not contain it, so that the state does not depend on it. Open nodes are
//! eliminated from every step. Once the residual comes near the rounding of d + R a, the bodies are moved by these
//! motions: d := d + R a, a := 0.

use crate::direct::compliant_contact::CompliantContact;
use crate::direct::cone_programs::Programs;
use crate::equilibrium::law::{Friction, Linearization};
use crate::equilibrium::{Stage, Work};
use crate::linear::dense::{DenseLu, multiply};
use crate::linear::vector::norm;
use faer::Mat;
use nonsmooth::interruption::interrupted;

/// Compliances that the first problem is tried with, one after the other until Newton's method converges.
const FIRST_COMPLIANCES: [f64; 6] = [0.0, 1.0, 1e2, 1e4, 1e6, 1e8];
/// Compliance below which it is set to 0: rounding. Where bodies bend, their compliances are far above those of single
/// nodes, and states change down to 1e-8.
const LAST_COMPLIANCE: f64 = 1e-12;
/// Factor of the compliance in the first step that lowers it.
const SHRINKAGE: f64 = 0.25;
/// Smallest factor of the compliance in one step.
const SMALLEST_FACTOR: f64 = 1e-4;
/// Factor of the compliance above which a step is no progress any more.
const LARGEST_FACTOR: f64 = 0.999;
/// Proximal springs, relative to the mean contact stiffness, tried one after the other.
pub(super) const SPRINGS: [f64; 2] = [1e-8, 1e-6];
/// Newton steps for one compliance.
const MAX_STEPS: usize = 30;
/// Newton steps that lowering the compliance may take with one spring.
const MAX_TOTAL_STEPS: usize = 1000;
/// Halvings of one step.
const MAX_HALVINGS: usize = 6;
/// Relative decrease of the residual asked of a step of length one.
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Multiple of its rounding floor up to which a residual counts as having reached it.
pub(super) const FLOOR_REACHED: f64 = 100.0;
/// Tightest relative residual aimed at: below it rounding decides.
const TIGHTEST: f64 = 1e-13;
/// Relative residual accepted when rounding stops all progress.
const ACCEPTABLE: f64 = 1e-9;

/// What the iteration reached.
#[derive(Debug, Clone)]
pub(super) struct Reached {
    /// Forces and amplitudes, dimensionless.
    pub(super) unknowns: Vec<f64>,
    pub(super) linearizations: Vec<Linearization>,
    /// Whether they solve the problem without a compliance of the contact nodes (δ = 0).
    pub(super) solved: bool,
    /// Relative residual after every Newton step, at the compliance of the step; without those from cone programs.
    pub(super) history: Vec<f64>,
    /// The last resort, where it was needed.
    pub(super) programs: Option<Programs>,
}

/// How one Newton iteration is run.
#[derive(Debug, Clone, Copy)]
struct Problem {
    delta: f64,
    spring: f64,
    tolerance: f64,
    /// Newton steps allowed in all, those before it included.
    max_steps: usize,
}

/// Newton's matrix over the rows of the nodes that are not open, then the motions.
#[derive(Debug)]
pub(super) struct ActiveSystem {
    pub(super) rows: Vec<usize>,
    pub(super) matrix: Mat<f64>,
}

impl Reached {
    pub(super) fn work(&self) -> Work {
        let programs = self.programs.as_ref().map_or([0; 2], |programs| [programs.iterations, programs.newton_steps]);
        let newton_steps = self.history.len() + programs[1];
        Work { newton_steps, dense_factorizations: newton_steps + programs[0], ..Work::default() }
    }
}

impl CompliantContact {
    /// The equilibrium from given unknowns, from the bonded problem, or from cone programs, to a relative residual; or,
    /// after at most so many factorisations, the last state on the way.
    pub(super) fn equilibrium(&mut self, start: Option<&[f64]>, tolerance: f64, max_steps: usize) -> Reached {
        let mut history = Vec::new();
        let tolerance = tolerance.max(TIGHTEST);
        let all_steps = max_steps;
        let max_steps = max_steps - self.steps_for_programs(max_steps);
        let zero = vec![0.0; self.row_count() + self.resultant.len()];
        let problem = |delta, spring| Problem { delta, spring, tolerance, max_steps };
        let started = start.and_then(|start| self.newton(start.to_vec(), problem(0.0, SPRINGS[0]), &mut history));
        let mut reached = (zero.clone(), false);
        for spring in SPRINGS.into_iter().take_while(|_| started.is_none() && !interrupted()) {
            let first = FIRST_COMPLIANCES.into_iter().take_while(|_| !interrupted()).find_map(|delta| {
                let bonded = self.bonded(&zero, problem(delta, spring));
                self.newton(bonded, problem(delta, spring), &mut history).map(|found| (delta, found))
            });
            if let Some((delta, found)) = first {
                reached = self.lower(found, problem(delta, spring), &mut history);
                if reached.1 {
                    break;
                }
            }
        }
        let (mut unknowns, mut solved) = started.map_or(reached, |found| (found, true));
        let programs = (!solved && !interrupted())
            .then(|| self.by_cone_programs(tolerance, all_steps.saturating_sub(history.len())));
        if let Some(found) = programs.as_ref().and_then(|programs| programs.unknowns.clone()) {
            (unknowns, solved) = (found, true);
        }
        let linearizations = self.linearize(&self.residual(&unknowns, 0.0).1);
        Reached { unknowns, linearizations, solved, history, programs }
    }

    /// Newton's method from unknowns near an equilibrium, in so many steps, with their number; none where it diverges.
    pub(super) fn newton_near(
        &mut self,
        unknowns: &[f64],
        tolerance: f64,
        max_steps: usize,
    ) -> (Option<Vec<f64>>, usize) {
        let mut history = Vec::new();
        let problem = Problem { delta: 0.0, spring: SPRINGS[0], tolerance: tolerance.max(TIGHTEST), max_steps };
        (self.newton(unknowns.to_vec(), problem, &mut history), history.len())
    }

    /// Lowers the compliance from a solved problem; the last solved one, and whether its compliance is 0.
    fn lower(&mut self, mut unknowns: Vec<f64>, mut problem: Problem, history: &mut Vec<f64>) -> (Vec<f64>, bool) {
        let mut factor = SHRINKAGE;
        let last = (history.len() + MAX_TOTAL_STEPS).min(problem.max_steps);
        while problem.delta > 0.0 && factor <= LARGEST_FACTOR && history.len() < last {
            let delta = if factor * problem.delta < LAST_COMPLIANCE { 0.0 } else { factor * problem.delta };
            match self.newton(unknowns.clone(), Problem { delta, ..problem }, history) {
                Some(found) => {
                    (problem.delta, unknowns) = (delta, found);
                    factor = (factor * factor).max(SMALLEST_FACTOR);
                }
                None => factor = factor.sqrt(),
            }
        }
        (unknowns, problem.delta == 0.0)
    }

    /// Newton's method for one compliance; none where it does not converge.
    fn newton(&mut self, mut unknowns: Vec<f64>, problem: Problem, history: &mut Vec<f64>) -> Option<Vec<f64>> {
        let (mut residual, mut arguments) = self.residual(&unknowns, problem.delta);
        let mut size = norm(&residual);
        let mut before = None;
        for _step in 0..MAX_STEPS {
            if size <= problem.tolerance || !size.is_finite() || history.len() >= problem.max_steps {
                break;
            }
            if before.is_none() && size <= FLOOR_REACHED * self.rounding(&unknowns) {
                before = Some(self.recentre(&mut unknowns));
                (residual, arguments) = self.residual(&unknowns, problem.delta);
                size = norm(&residual);
            }
            let previous = size;
            let step = self.step(&self.linearize(&arguments), &residual, problem);
            unknowns = self.search(&unknowns, &step, size, problem.delta);
            (residual, arguments) = self.residual(&unknowns, problem.delta);
            size = norm(&residual);
            history.push(size);
            Stage::Contact.reached(history.len(), size).ok()?;
            if size <= ACCEPTABLE && size > 0.5 * previous {
                break;
            }
        }
        let solved = size <= problem.tolerance.max(ACCEPTABLE);
        // The unknowns that the caller keeps refer to where the bodies were.
        if let Some(before) = before.filter(|_| !solved) {
            self.placement = before;
        }
        solved.then_some(unknowns)
    }

    /// The solution with all nodes glued.
    fn bonded(&self, start: &[f64], problem: Problem) -> Vec<f64> {
        let rho = 1.0 / (1.0 + problem.delta);
        let (mut residual, _) = self.residual(start, problem.delta);
        for (entry, jump) in residual.iter_mut().zip(self.jumps(start, problem.delta)) {
            *entry = -rho * jump;
        }
        let glued = vec![Linearization::Stick; self.problem.boundary.points.len()];
        let step = self.step(&glued, &residual, problem);
        start.iter().zip(&step).map(|(x, step)| x - step).collect()
    }

    /// Halves the step until the residual falls; takes the full step where no length helps.
    fn search(&self, from: &[f64], step: &[f64], size: f64, delta: f64) -> Vec<f64> {
        let at = |length: f64| -> Vec<f64> { from.iter().zip(step).map(|(x, step)| x - length * step).collect() };
        let mut length = 1.0;
        for _halving in 0..=MAX_HALVINGS {
            let trial = at(length);
            if norm(&self.residual(&trial, delta).0) <= (1.0 - SUFFICIENT_DECREASE * length) * size {
                return trial;
            }
            length *= 0.5;
        }
        at(1.0)
    }

    /// M⁻¹ r without contact compliance, with the smallest spring.
    pub(super) fn exact_step(&self, linearizations: &[Linearization], residual: &[f64]) -> Vec<f64> {
        let problem = Problem { delta: 0.0, spring: SPRINGS[0], tolerance: TIGHTEST, max_steps: 1 };
        self.step(linearizations, residual, problem)
    }

    /// M⁻¹ r for the derivative M with a spring: open nodes first, whose rows are those of the identity.
    fn step(&self, linearizations: &[Linearization], residual: &[f64], problem: Problem) -> Vec<f64> {
        let (count, rho) = (self.row_count(), 1.0 / (1.0 + problem.delta));
        let boundary = &self.problem.boundary;
        let mut step = vec![0.0; residual.len()];
        for (node, linearization) in boundary.points.iter().zip(linearizations) {
            if *linearization == Linearization::Open {
                let range = node.rows();
                step[range.clone()].copy_from_slice(&residual[range]);
            }
        }
        let product = multiply(&self.compliance, &step[..count]);
        let mut active = self.active_system(linearizations, problem.delta, Friction::Coulomb);
        let mut right: Vec<f64> = Vec::with_capacity(active.matrix.nrows());
        for (node, linearization) in boundary.points.iter().zip(linearizations) {
            if *linearization == Linearization::Open {
                continue;
            }
            let block = linearization.derivative(node.row_count(), node.friction);
            right.extend((0..node.row_count()).map(|i| {
                let open: f64 = (0..node.row_count()).map(|j| block[i][j] * product[node.start + j]).sum();
                residual[node.start + i] - rho * open
            }));
        }
        for (column, resultant) in residual[count..].iter().enumerate() {
            let index = right.len();
            let open: f64 = (0..count).map(|row| self.motions[(row, column)] * step[row]).sum();
            active.matrix[(index, index)] = problem.spring * rho;
            right.push(resultant - open);
        }
        DenseLu::new(&active.matrix).solve_refined(&active.matrix, &mut right);
        for (row, value) in active.rows.iter().copied().chain(count..residual.len()).zip(&right) {
            step[row] = *value;
        }
        step
    }

    /// The derivative over the rows of the nodes that are not open, then the motions.
    pub(super) fn active_system(
        &self,
        linearizations: &[Linearization],
        delta: f64,
        friction: Friction,
    ) -> ActiveSystem {
        let points = || self.problem.boundary.points.iter().zip(linearizations);
        let closed = || points().filter(|(_, linearization)| **linearization != Linearization::Open);
        let rows: Vec<usize> = closed().flat_map(|(node, _)| node.rows()).collect();
        let (count, motions) = (rows.len(), self.resultant.len());
        let rho = 1.0 / (1.0 + delta);
        let mut matrix = Mat::<f64>::zeros(count + motions, count + motions);
        let mut first = 0;
        for (node, linearization) in closed() {
            let size = node.row_count();
            let block = linearization.derivative(size, friction.of(node));
            for (i, coefficients) in block.iter().enumerate().take(size) {
                matrix[(first + i, first + i)] += 1.0;
                for (j, &d) in coefficients.iter().enumerate().take(size).filter(|(_, d)| **d != 0.0) {
                    matrix[(first + i, first + j)] -= d * rho;
                    let compliance = self.compliance.col_as_slice(node.start + j);
                    for (column, &other) in rows.iter().enumerate() {
                        matrix[(first + i, column)] += d * rho * compliance[other];
                    }
                    for column in 0..motions {
                        matrix[(first + i, count + column)] -= d * rho * self.motions[(node.start + j, column)];
                    }
                }
            }
            first += size;
        }
        for column in 0..motions {
            for (index, &row) in rows.iter().enumerate() {
                matrix[(count + column, index)] = self.motions[(row, column)];
            }
        }
        ActiveSystem { rows, matrix }
    }
}
