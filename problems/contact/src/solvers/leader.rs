//! The first process of several: it alone runs the command, and announces to the others what all do together.

use crate::communication::Communication;
use crate::equilibrium::ContactProblem;
use crate::error::{ContactError, SceneError};
use crate::memory;
use crate::solvers::announcement::{Announcement, Id, Task};
use crate::solvers::own_solver::OwnSolver;
use crate::solvers::shared_factors::SharedFactors;
use crate::solvers::traffic::{Counted, Usage};
use crate::solvers::{SolverKind, SolverPlan};
use crate::tfeti::TornOptions;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The first process of several.
#[derive(Debug)]
pub struct Leader {
    /// For announcements; what they send is not counted.
    announcing: Arc<Counted>,
    counted: Arc<Counted>,
    /// What is known of the others. Locked while a task is under way: tasks follow each other in all processes.
    state: Mutex<Progress>,
    /// What nobody needs any longer, to be told with the next task.
    released: Mutex<Vec<Id>>,
}

#[derive(Debug, Default)]
struct Progress {
    /// The last name that was given.
    last: Id,
    /// Products with the dual operator so far.
    products: usize,
    /// Whether the others have left.
    ended: bool,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic ends all processes where there are several.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Leader {
    /// The first process; the others follow.
    pub fn new(communication: &Arc<dyn Communication>) -> Self {
        let [counted, announcing] = Counted::pair(communication);
        Self { announcing, counted, state: Mutex::default(), released: Mutex::default() }
    }

    /// What the solvers communicate by.
    fn connection(&self) -> Arc<dyn Communication> {
        Arc::<Counted>::clone(&self.counted)
    }

    /// A name for a solver or a state.
    pub fn name(&self) -> Id {
        let mut state = lock(&self.state);
        state.last += 1;
        state.last
    }

    /// Says that nobody needs a solver or a state any longer.
    pub fn release(&self, id: Id) {
        lock(&self.released).push(id);
    }

    /// Announces a task and does the own part of it. No other task begins before it has ended.
    fn announced<T>(&self, task: Task, own: impl FnOnce(&mut Progress) -> T) -> Result<T, String> {
        let mut state = lock(&self.state);
        let released = std::mem::take(&mut *lock(&self.released));
        Announcement { task, released }.tell(&*self.announcing)?;
        Ok(own(&mut state))
    }

    /// The failure of the first process that has one.
    fn agree(&self, error: Option<String>) -> Option<String> {
        let announcing: &dyn Communication = &*self.announcing;
        announcing.agree(error)
    }

    /// Does a task that cannot fail in all processes.
    pub fn together<T>(&self, task: Task, own: impl FnOnce() -> T) -> Result<T, ContactError> {
        self.announced(task, |_| own()).map_err(|reason| ContactError::OtherProcess { reason })
    }

    /// Does a task in all processes; fails if it fails in any of them, with the own reason if there is one. `products`:
    /// those of a result.
    pub fn agreed<T>(
        &self,
        task: Task,
        own: impl FnOnce() -> Result<T, ContactError>,
        products: impl FnOnce(&T) -> usize,
    ) -> Result<T, ContactError> {
        let (own, other) = self
            .announced(task, |state| {
                let result = own();
                state.products += result.as_ref().map_or(0, products);
                let other = self.agree(result.as_ref().err().map(ToString::to_string));
                (result, other)
            })
            .map_err(|reason| ContactError::OtherProcess { reason })?;
        match (own, other) {
            (Ok(_), Some(reason)) => Err(ContactError::OtherProcess { reason }),
            (own, _) => own,
        }
    }

    /// Prepares a solver in all processes; its name goes with it.
    ///
    /// # Errors
    /// As [`prepared`]; [`SceneError::OtherProcess`] if it fails in another process only.
    pub fn prepare(&self, plan: SolverPlan, factors: &SharedFactors) -> Result<(OwnSolver, Id), SceneError> {
        let id = self.name();
        let (own, other) = self
            .announced(Task::Prepare(id, Box::new(plan.clone())), |_| {
                let own = prepared(plan, self.connection(), factors);
                let other = self.agree(own.as_ref().err().map(ToString::to_string));
                (own, other)
            })
            .map_err(|reason| SceneError::OtherProcess { reason })?;
        let prepared = match (own, other) {
            (Ok(_), Some(reason)) => Err(SceneError::OtherProcess { reason }),
            (own, _) => own.map(|solver| (solver, id)),
        };
        if prepared.is_err() {
            // Others may have prepared theirs.
            self.release(id);
        }
        prepared
    }

    /// What the processes have sent and used so far, in a run by a solver.
    ///
    /// # Errors
    /// [`ContactError::OtherProcess`] if the task has no form in bytes.
    pub fn measure(&self, solver: SolverKind) -> Result<Usage, ContactError> {
        let measured = self.announced(Task::Measure, |state| {
            let figures = self.counted.figures().gather(&*self.announcing);
            Usage::new(&figures, state.products, solver)
        });
        measured.map_err(|reason| ContactError::OtherProcess { reason })
    }

    /// Tells the other processes that the run has ended. They hear nothing after that.
    pub fn end(&self) {
        let ended = std::mem::replace(&mut lock(&self.state).ended, true);
        if !ended && self.announced(Task::End, |_| ()).is_err() {
            tracing::error!("the other processes could not be told that the run has ended");
        }
    }
}

/// The solver of a plan in this process. Where there are several processes, all of them prepare it: total FETI shares
/// the subdomains among them, direct condensation is repeated by each. `factors`: those of the solvers of this process.
///
/// # Errors
/// [`SceneError`] for a bad field, a scene that needs more memory than there is, clusters that the subdomains do not
/// make, or a size whose symbolic analysis fails.
pub fn prepared(
    plan: SolverPlan,
    communication: Arc<dyn Communication>,
    factors: &SharedFactors,
) -> Result<OwnSolver, SceneError> {
    plan.scene.validate()?;
    memory::check(&plan, &*communication)?;
    let problem = Arc::new(ContactProblem::around(plan.scene.clone(), plan.form_errors.as_ref())?);
    plan.check(&problem, communication.size())?;
    let SolverPlan { kind, preconditioner, wanted, clusters, .. } = plan;
    let options = TornOptions { preconditioner, clusters, communication, shelf: Arc::clone(&factors.torn) };
    let condensed = Arc::clone(&factors.condensed);
    OwnSolver::new(problem, kind, (options, condensed), wanted).map_err(|error| match error {
        ContactError::Clusters { reason, .. } => {
            let allowed = format!("clusters that are held together: {reason}");
            SceneError::out_of_range("solver.clusters", clusters.unwrap_or_default(), allowed)
        }
        error => SceneError::out_of_range("bodies", error, "a size that can be factored"),
    })
}

/// Sets the number of threads of this process.
pub fn use_threads(threads: usize) {
    // A second call in one process keeps the first pool; results do not depend on it.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
}
