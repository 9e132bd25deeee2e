//! Several processes that work on one command.
//!
//! ```text
//! process 0   arguments, files, clock, signals, optimizer, journal, output ── announces ──┐      leader.rs, shared_solver.rs
//! process k   waits, does the same solver call, waits, …                   ◀──────────────┘      follower.rs
//! ```
//! Process 0 runs the command as a single process would. Only the calls of the contact solver are made by all processes: process 0
//! announces each of them with its arguments, the others make the same call, and inside it all exchange what the solver shares
//! among them. Nothing that depends on time, files, signals, memory or the user can thus be decided differently by two processes.
//! At the end of a call all agree on whether one of them failed.

mod announcement;
mod follower;
mod leader;
mod shared_solver;
mod traffic;

pub use shared_solver::{SharedSolver, SharedState};
pub use traffic::Usage;

use crate::commands::failure::Failure;
use announcement::{Plan, Task};
use contact::communication::Communication;
use contact::communication::InProcess;
use contact::contact_shape::{ContactShape, SolverKind, Wanted};
use contact::error::SceneError;
use leader::{Leader, use_threads};
use scene_file::Case;
use std::sync::Arc;

/// The processes of a run, as the one sees them that runs the command.
#[derive(Debug, Clone)]
pub struct Processes(Option<Arc<Leader>>);

impl Processes {
    /// A single process.
    pub fn alone() -> Self {
        Self(None)
    }

    /// Whether nothing but this process has been started, without MPI.
    pub fn is_alone(&self) -> bool {
        self.0.is_none()
    }

    /// The map of a case, prepared in all processes.
    ///
    /// # Errors
    /// As [`ContactShape::for_use`].
    pub fn shape(&self, case: &Case, wanted: Wanted) -> Result<ContactShape<SharedSolver>, SceneError> {
        let (scene, kind, preconditioner) = (case.scene.clone(), case.solver, case.preconditioner);
        let solver = match &self.0 {
            None => {
                let shape = ContactShape::for_use(scene, kind, preconditioner, wanted, Arc::new(InProcess))?;
                SharedSolver::from(shape.into_solver())
            }
            Some(leader) => {
                let (own, id) = leader.prepare(Plan { scene, kind, preconditioner, wanted })?;
                SharedSolver::led(own, id, Arc::clone(leader))
            }
        };
        Ok(ContactShape::by(solver))
    }

    /// Sets the number of threads of every process.
    ///
    /// # Errors
    /// [`Failure::Computation`] if the others cannot be told.
    pub fn use_threads(&self, threads: usize) -> Result<(), Failure> {
        let own = || use_threads(threads);
        match &self.0 {
            None => own(),
            Some(leader) => leader.together(Task::Threads(threads), own).map_err(Failure::computation)?,
        }
        Ok(())
    }

    /// What the processes have sent and used so far, in a run by a solver; none for a single process.
    ///
    /// # Errors
    /// [`Failure::Computation`] if the others cannot be asked.
    pub fn usage(&self, solver: SolverKind) -> Result<Option<Usage>, Failure> {
        self.0.as_ref().map(|leader| leader.measure(solver)).transpose()
    }
}

/// Runs a command in one of several processes: the first does what `lead` says, with the others at its hands, and the others follow
/// it. `build` names the program; all processes must have the same name for it. The first process gets the result of `lead`, the
/// others get none.
///
/// # Errors
/// [`Failure::Input`] in the first process if the others run another program; [`Failure::Computation`] in another one that does
/// not understand the first.
pub fn run_together<T>(
    communication: &Arc<dyn Communication>,
    build: &str,
    lead: impl FnOnce(&Processes) -> T,
) -> Result<Option<T>, Failure> {
    let builds = communication.gather_any(&build.bytes().map(f64::from).collect::<Vec<f64>>());
    let other = builds.iter().position(|other| *other != builds[0]);
    match (other, communication.rank()) {
        (Some(other), 0) => {
            let name = |build: &[f64]| {
                String::from_utf8_lossy(&build.iter().map(|b| *b as u8).collect::<Vec<u8>>()).into_owned()
            };
            let [first, other_build] = [&builds[0], &builds[other]].map(|build| name(build));
            Err(Failure::Input(format!(
                "process {other} runs {other_build}, process 0 runs {first}: all processes must run the same build of the program on processors of the same kind"
            )))
        }
        (Some(_), _) => Ok(None),
        (None, 0) => {
            let leader = Arc::new(Leader::new(communication));
            let result = lead(&Processes(Some(Arc::clone(&leader))));
            leader.end();
            Ok(Some(result))
        }
        (None, rank) => {
            let failed =
                |reason| Failure::Computation(format!("process {rank} does not understand process 0: {reason}"));
            follower::follow(communication).map(|()| None).map_err(failed)
        }
    }
}
