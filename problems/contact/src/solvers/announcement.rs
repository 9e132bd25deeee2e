//! What the first process announces to the others: the next task that all of them do together.

use crate::communication::Communication;
use crate::equilibrium::ContactWarmStart;
use crate::solvers::SolverPlan;
use crate::solvers::call::Call;
use serde::{Deserialize, Serialize};

/// Name of a solver or of a state, the same in all processes.
pub type Id = u64;

/// What all processes do next. Every task but the last ends at the same time in all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Task {
    /// Use so many threads.
    Threads(usize),
    /// Prepare the solver of a scene, which has this name from now on.
    Prepare(Id, Box<SolverPlan>),
    /// Solve a shape; its state has the second name from now on.
    Solve(Id, Id, Box<Shape>),
    /// Ask a solver about a state of its own.
    Ask(Id, Id, Call),
    /// What a shape similar to that of a state can be solved from.
    WarmStart(Id),
    /// Tell what this process has sent and used.
    Measure,
    /// The run has ended.
    End,
}

/// A shape to be solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// The controls.
    pub controls: Vec<f64>,
    /// What a similar shape has left.
    pub start: Option<ContactWarmStart>,
    pub tolerance: f64,
}

/// A task, with the states and solvers that nobody needs any longer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Announcement {
    /// What to do next.
    pub task: Task,
    /// Names of what may be dropped before.
    pub released: Vec<Id>,
}

/// Bytes of a number.
const NUMBER: usize = size_of::<f64>();

impl Announcement {
    /// Sends an announcement to all other processes. The first process calls this where the others call [`Self::hear`].
    ///
    /// # Errors
    /// The reason in words if the announcement has no form in bytes.
    pub fn tell(&self, communication: &dyn Communication) -> Result<(), String> {
        let bytes = postcard::to_allocvec(self).map_err(|error| error.to_string())?;
        // The length stands first, since the last number may be filled up.
        let packed = bytes.chunks(NUMBER).map(|chunk| {
            let mut word = [0; NUMBER];
            word[..chunk.len()].copy_from_slice(chunk);
            f64::from_le_bytes(word)
        });
        let numbers = std::iter::once(bytes.len() as f64).chain(packed).collect();
        communication.all_of_first(numbers);
        Ok(())
    }

    /// Waits for the next announcement of the first process.
    ///
    /// # Errors
    /// The reason in words if what was heard is no announcement.
    pub fn hear(communication: &dyn Communication) -> Result<Self, String> {
        let numbers = communication.all_of_first(Vec::new());
        let (length, packed) = numbers.split_first().ok_or("an announcement without length")?;
        let bytes: Vec<u8> = packed.iter().flat_map(|number| number.to_le_bytes()).collect();
        let bytes = bytes.get(..*length as usize).ok_or("an announcement without end")?;
        postcard::from_bytes(bytes).map_err(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::communication::Parcel;
    use crate::equilibrium::{FormErrors, TangentsOf};
    use crate::scene::{Scene, hertz, signorini};
    use crate::solvers::{SolverKind, Wanted};
    use crate::tfeti::PreconditionerKind;
    use std::sync::Mutex;

    /// A process that hears what was sent before.
    #[derive(Debug, Default)]
    struct Echo(Mutex<std::collections::VecDeque<Vec<f64>>>);

    impl Communication for Echo {
        fn rank(&self) -> usize {
            0
        }

        fn size(&self) -> usize {
            1
        }

        fn gather(&self, own: &[f64], _counts: &[usize]) -> Vec<f64> {
            let mut sent = self.0.lock().expect("no test thread panics here");
            if own.is_empty() || own == [0.0] {
                return sent.pop_front().expect("something was sent");
            }
            sent.push_back(own.to_vec());
            own.to_vec()
        }

        fn exchange(&self, _parcels: &mut [Parcel]) {}
    }

    #[test]
    fn every_bit_of_a_task_arrives() {
        let echo = Echo::default();
        let start = Some(ContactWarmStart::Multipliers(vec![f64::NEG_INFINITY, -0.0, 5e-324, f64::MAX]));
        let shape = |controls| Shape { controls, start: start.clone(), tolerance: f64::INFINITY };
        let plan = |scene: Scene| {
            let preconditioner = PreconditionerKind::Lumped;
            let wanted = Wanted::Jacobians;
            Box::new(SolverPlan {
                preconditioner,
                clusters: Some(8),
                form_errors: Some(FormErrors { controls: vec![-0.0, 1.5], wavelength: 7.0 }),
                wanted,
                ..SolverPlan::new(scene, SolverKind::Newton)
            })
        };
        let tasks = [
            Task::Threads(3),
            Task::Prepare(7, plan(signorini().expect("a preset"))),
            Task::Prepare(u64::MAX, plan(hertz().expect("a preset"))),
            Task::Solve(7, 8, Box::new(shape((0..1000).map(|i| (f64::from(i)).sqrt()).collect()))),
            Task::Ask(7, 8, Call::Tangents(vec![vec![], vec![0.1; 5]], TangentsOf::Displacements, 1e-9)),
            Task::Ask(7, 8, Call::Contraction(12)),
            Task::End,
        ];
        for task in tasks {
            let told = Announcement { task, released: vec![1, 1 << 60] };
            told.tell(&echo).expect("it has a form");
            assert_eq!(Announcement::hear(&echo), Ok(told));
        }
    }
}
