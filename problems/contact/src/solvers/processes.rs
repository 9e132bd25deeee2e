//! The processes of a run: what the first needs of them, and what the others do.

use crate::communication::{Communication, InProcess};
use crate::error::{ContactError, SceneError};
use crate::solvers::announcement::Task;
use crate::solvers::leader::{Leader, prepared, use_threads};
use crate::solvers::shared_factors::SharedFactors;
use crate::solvers::{Solver, SolverKind, SolverPlan, Usage};
use std::sync::Arc;

pub use crate::solvers::follower::follow;

/// The processes of a run, for the one that runs the command. Solvers that come from one such value, or from copies of
/// it, share factors: bodies of equal stiffness at equal positions are factored once, as long as a state or a solver
/// holds their factors. Results are those of solvers of their own.
#[derive(Debug, Clone)]
pub struct Processes {
    /// None for a single process.
    leader: Option<Arc<Leader>>,
    /// The factors of this process; the others have their own.
    factors: SharedFactors,
}

impl Processes {
    /// The connection of a single process.
    pub fn alone() -> Self {
        Self { leader: None, factors: SharedFactors::default() }
    }

    /// Whether nothing but this process has been started, without MPI.
    pub fn is_alone(&self) -> bool {
        self.leader.is_none()
    }

    /// The solver of a plan, prepared in all processes: total FETI shares the subdomains among them, direct
    /// condensation is repeated by each.
    ///
    /// # Errors
    /// [`SceneError`] for a bad field, a scene that needs more memory than there is, clusters that the subdomains do
    /// not make, or a size whose symbolic analysis fails; [`SceneError::OtherProcess`] if the preparation fails in
    /// another process only.
    pub fn solver(&self, plan: SolverPlan) -> Result<Solver, SceneError> {
        Ok(match &self.leader {
            None => Solver::from(prepared(plan, Arc::new(InProcess), &self.factors)?),
            Some(leader) => {
                let (own, id) = leader.prepare(plan, &self.factors)?;
                Solver::led(own, id, Arc::clone(leader))
            }
        })
    }

    /// Sets the number of threads of every process.
    ///
    /// # Errors
    /// [`ContactError::OtherProcess`] if the others cannot be told.
    pub fn use_threads(&self, threads: usize) -> Result<(), ContactError> {
        let own = || use_threads(threads);
        match &self.leader {
            None => own(),
            Some(leader) => leader.together(Task::Threads(threads), own)?,
        }
        Ok(())
    }

    /// What the processes have sent and used so far, in a run by a solver; none for a single process.
    ///
    /// # Errors
    /// [`ContactError::OtherProcess`] if the others cannot be asked.
    pub fn usage(&self, solver: SolverKind) -> Result<Option<Usage>, ContactError> {
        self.leader.as_ref().map(|leader| leader.measure(solver)).transpose()
    }
}

/// Runs something in the first of several processes; the others [`follow`] it.
pub fn lead<T>(communication: &Arc<dyn Communication>, run: impl FnOnce(&Processes) -> T) -> T {
    let leader = Arc::new(Leader::new(communication));
    let result = run(&Processes { leader: Some(Arc::clone(&leader)), factors: SharedFactors::default() });
    leader.end();
    result
}
