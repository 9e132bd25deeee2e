//! The contact solvers behind one face, with tolerances as relative residuals. A new solver is added here.

use crate::scaling::cases::Variant;
use crate::scaling::solve::{Adjoint, Solve, Start};
use contact::direct::{DirectSolver, DirectState};
use contact::equilibrium::{ContactForces, ContactProblem, Work};
use contact::error::ContactError;
use contact::tfeti::{
    AugmentedLagrangianCounts, AugmentedLagrangianSettings, NewtonSettings, Recycling, TornSolver, TornState,
};
use std::time::Instant;

/// A solver of one scene.
pub enum Engine {
    /// TFETI.
    Torn(Box<TornSolver>, Method),
    /// Direct condensation.
    Direct(Box<DirectSolver>),
}

/// What is iterated on the torn problem.
#[derive(Clone, Copy)]
pub enum Method {
    /// Newton with the recycling that pays.
    Newton,
    /// Newton with a GMRES of its own per step.
    Gmres,
    /// Successive approximations.
    AugmentedLagrangian,
}

/// A solved shape.
pub struct Solved {
    state: State,
    forces: ContactForces,
    /// What it cost.
    pub solve: Solve,
}

enum State {
    Torn(Box<TornState>),
    Direct(Box<DirectState>),
}

/// Exponent of the paper's pressure norm.
const EXPONENT: i32 = 4;

impl Engine {
    /// What is done once per run.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails.
    pub fn new(problem: &ContactProblem, variant: Variant) -> Result<Self, ContactError> {
        Ok(match variant.preconditioner() {
            Some(kind) => Self::Torn(Box::new(TornSolver::new(problem, kind)?), Method::of(variant)),
            None => Self::Direct(Box::new(DirectSolver::new(problem)?)),
        })
    }

    /// The TFETI solver, if it is one.
    pub fn torn(&self) -> Option<&TornSolver> {
        match self {
            Self::Torn(solver, _) => Some(solver),
            Self::Direct(_) => None,
        }
    }

    /// Degrees of freedom and multipliers.
    pub fn sizes(&self, problem: &ContactProblem) -> [usize; 2] {
        match self {
            Self::Torn(solver, _) => [solver.model().dof_count, solver.model().constraints.row_count()],
            Self::Direct(_) => {
                let nodes: usize = problem.grid.cells.iter().map(|cells| cells + 1).product();
                [3 * nodes * problem.bodies().count(), problem.boundary.row_count]
            }
        }
    }

    /// One state, timed.
    ///
    /// # Errors
    /// [`ContactError`] from the solver.
    pub fn solve(
        &self,
        problem: &ContactProblem,
        controls: &[f64],
        start: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<Solved, ContactError> {
        let clock = Instant::now();
        let (state, forces, work, stages) = match self {
            Self::Torn(solver, method) => {
                let (state, forces, work) = method.solve(solver, problem, controls, start, tolerance)?;
                let stages = state.seconds();
                (State::Torn(Box::new(state)), forces, work, Some(stages))
            }
            Self::Direct(solver) => {
                let (state, forces, work) = solver.solve(problem, controls, start, tolerance)?;
                (State::Direct(Box::new(state)), forces, work, None)
            }
        };
        let solve = Solve {
            start: if start.is_some() { Start::Warm } else { Start::Cold },
            tolerance,
            residual: forces.residuals.newton,
            work,
            objective: pressures(problem, &forces).map(|(pressure, _)| pressure.powi(EXPONENT)).sum(),
            seconds: clock.elapsed().as_secs_f64(),
            stages,
        };
        Ok(Solved { state, forces, solve })
    }

    /// Sensitivities of the column heights of Σσ⁴, timed.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] from the adjoint; a failure when the state is not of this solver.
    pub fn adjoint(
        &self,
        problem: &ContactProblem,
        solved: &Solved,
        tolerance: f64,
    ) -> Result<(Vec<f64>, Adjoint), ContactError> {
        let mut dual = vec![0.0; problem.boundary.dual_dimension()];
        for (entry, (pressure, area)) in dual.iter_mut().zip(pressures(problem, &solved.forces)) {
            *entry = f64::from(EXPONENT) * pressure.powi(EXPONENT - 1) / area;
        }
        let direction = problem.boundary.pack(&dual);
        let clock = Instant::now();
        match (self, &solved.state) {
            (Self::Torn(solver, _), State::Torn(state)) => {
                let result = solver.sensitivities(problem, state, &direction, tolerance)?;
                let adjoint = Adjoint {
                    tolerance,
                    applications: result.applications,
                    seconds: result.adjoint_seconds,
                    shape_seconds: result.shape_seconds,
                };
                Ok((result.heights, adjoint))
            }
            (Self::Direct(solver), State::Direct(state)) => {
                let (heights, _) = solver.sensitivities(problem, state, &direction)?;
                let seconds = clock.elapsed().as_secs_f64();
                Ok((heights, Adjoint { tolerance, applications: 0, seconds, shape_seconds: 0.0 }))
            }
            _ => Err(ContactError::Factorization {
                what: "adjoint".into(),
                reason: "the state was found by another kind of contact solver".into(),
            }),
        }
    }
}

impl Method {
    fn of(variant: Variant) -> Self {
        match variant {
            Variant::AugmentedLagrangian => Self::AugmentedLagrangian,
            Variant::Gmres => Self::Gmres,
            _ => Self::Newton,
        }
    }

    fn solve(
        self,
        solver: &TornSolver,
        problem: &ContactProblem,
        controls: &[f64],
        start: Option<&[f64]>,
        tolerance: f64,
    ) -> Result<(TornState, ContactForces, Work), ContactError> {
        match self {
            Self::Newton => solver.solve(problem, controls, start, tolerance),
            Self::Gmres => {
                let settings = NewtonSettings { recycling: Recycling::Off, ..NewtonSettings::to(tolerance) };
                solver.solve_by(problem, controls, |contact| contact.solve(start, &settings))
            }
            Self::AugmentedLagrangian => {
                let settings = AugmentedLagrangianSettings::to(tolerance);
                let mut counts = AugmentedLagrangianCounts::default();
                let (state, forces, work) = solver.solve_by(problem, controls, |contact| {
                    let (solution, spent) = contact.solve_by_successive_approximations(start, &settings)?;
                    counts = spent;
                    Ok(solution)
                })?;
                Ok((state, forces, counts.added_to(work)))
            }
        }
    }
}

impl Solved {
    /// What a similar problem starts from.
    pub fn restart(&self) -> Vec<f64> {
        match &self.state {
            State::Torn(state) => state.multipliers().to_vec(),
            State::Direct(state) => state.contact_displacement().to_vec(),
        }
    }
}

/// max(σ, 0) and area per contact node.
fn pressures(problem: &ContactProblem, forces: &ContactForces) -> impl Iterator<Item = (f64, f64)> {
    forces.normal.iter().zip(&problem.boundary.points).map(|(force, point)| ((force / point.area).max(0.0), point.area))
}
