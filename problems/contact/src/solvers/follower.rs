//! Every process but the first: it does what the first announces, until the run ends.

use crate::communication::Communication;
use crate::solvers::announcement::{Announcement, Id, Shape, Task};
use crate::solvers::leader::{prepared, use_threads};
use crate::solvers::own_solver::OwnSolver;
use crate::solvers::own_state::OwnState;
use crate::solvers::shared_factors::SharedFactors;
use crate::solvers::traffic::Counted;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a process keeps between tasks.
struct Follower {
    announcing: Arc<Counted>,
    counted: Arc<Counted>,
    solvers: BTreeMap<Id, OwnSolver>,
    states: BTreeMap<Id, OwnState>,
    factors: SharedFactors,
}

/// Does what the first process announces until the run has ended. It prints nothing, and reads and writes no file.
///
/// # Errors
/// The reason in words if an announcement is not understood; then the processes do not run the same program.
pub fn follow(communication: &Arc<dyn Communication>) -> Result<(), String> {
    let [counted, announcing] = Counted::pair(communication);
    let (solvers, states) = (BTreeMap::new(), BTreeMap::new());
    let mut follower = Follower { announcing, counted, solvers, states, factors: SharedFactors::default() };
    loop {
        let Announcement { task, released } = Announcement::hear(&*follower.announcing)?;
        for id in released {
            follower.states.remove(&id);
            follower.solvers.remove(&id);
        }
        if task == Task::End {
            return Ok(());
        }
        follower.does(task)?;
    }
}

impl Follower {
    /// Takes part in one task.
    fn does(&mut self, task: Task) -> Result<(), String> {
        match task {
            Task::Threads(threads) => use_threads(threads),
            Task::Prepare(id, plan) => {
                let solver = prepared(*plan, Arc::<Counted>::clone(&self.counted), &self.factors);
                self.agree(solver.as_ref().err());
                self.solvers.extend(solver.ok().map(|solver| (id, solver)));
            }
            Task::Solve(solver, id, shape) => {
                let Shape { controls, start, tolerance } = *shape;
                let state = self.solver(solver)?.solve(&controls, start.as_ref(), tolerance);
                self.agree(state.as_ref().err());
                self.states.extend(state.ok().map(|state| (id, state.solution)));
            }
            Task::Ask(solver, state, call) => {
                // What comes of it is the matter of the first process.
                let reply = self.solver(solver)?.perform(self.state(state)?, &call);
                self.agree(reply.err().as_ref());
            }
            Task::WarmStart(state) => {
                let _ = self.state(state)?.warm_start();
            }
            Task::Measure => {
                self.counted.figures().gather(&*self.announcing);
            }
            Task::End => {}
        }
        Ok(())
    }

    /// Tells the others whether the own part of a task has failed.
    fn agree(&self, error: Option<&impl ToString>) {
        let announcing: &dyn Communication = &*self.announcing;
        let rank = announcing.rank();
        announcing.agree(error.map(|error| format!("process {rank}: {}", error.to_string())));
    }

    fn solver(&self, id: Id) -> Result<&OwnSolver, String> {
        self.solvers.get(&id).ok_or_else(|| format!("there is no solver {id}"))
    }

    fn state(&self, id: Id) -> Result<&OwnState, String> {
        self.states.get(&id).ok_or_else(|| format!("there is no state {id}"))
    }
}
