//! The processes of a run: what the first needs of them, and what the others do.

use crate::communication::{Communication, InProcess};
use crate::error::{ContactError, SceneError};
use crate::solvers::announcement::Task;
use crate::solvers::leader::{Leader, prepared, use_threads};
use crate::solvers::{AnySolver, SolverKind, SolverPlan, Usage};
use std::sync::Arc;

pub use crate::solvers::follower::follow;

/// The processes of a run, for the one that runs the command.
#[derive(Debug, Clone)]
pub struct Processes(Option<Arc<Leader>>);

impl Processes {
    /// The connection of a single process.
    pub fn alone() -> Self {
        Self(None)
    }

    /// Whether nothing but this process has been started, without MPI.
    pub fn is_alone(&self) -> bool {
        self.0.is_none()
    }

    /// The solver of a plan, prepared in all processes: total FETI shares the subdomains among them, direct
    /// condensation is repeated by each.
    ///
    /// # Errors
    /// [`SceneError`] for a bad field, a scene that needs more memory than there is, clusters that the subdomains do
    /// not make, or a size whose symbolic analysis fails; [`SceneError::OtherProcess`] if the preparation fails in
    /// another process only.
    pub fn solver(&self, plan: SolverPlan) -> Result<AnySolver, SceneError> {
        Ok(match &self.0 {
            None => AnySolver::from(prepared(plan, Arc::new(InProcess))?),
            Some(leader) => {
                let (own, id) = leader.prepare(plan)?;
                AnySolver::led(own, id, Arc::clone(leader))
            }
        })
    }

    /// Sets the number of threads of every process.
    ///
    /// # Errors
    /// [`ContactError::OtherProcess`] if the others cannot be told.
    pub fn use_threads(&self, threads: usize) -> Result<(), ContactError> {
        let own = || use_threads(threads);
        match &self.0 {
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
        self.0.as_ref().map(|leader| leader.measure(solver)).transpose()
    }
}

/// Runs something in the first of several processes; the others [`follow`] it.
pub fn lead<T>(communication: &Arc<dyn Communication>, run: impl FnOnce(&Processes) -> T) -> T {
    let leader = Arc::new(Leader::new(communication));
    let result = run(&Processes(Some(Arc::clone(&leader))));
    leader.end();
    result
}
