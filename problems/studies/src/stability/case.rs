//! A case: its place in the matrix and how it is run.

use crate::stability::record::Record;
use std::time::Instant;

/// One line of the matrix.
pub struct Case {
    /// The group of cases to which the case belongs.
    pub group: &'static str,
    /// Name within the group.
    pub name: String,
    /// Whether the fast subset contains it.
    pub quick: bool,
    run: Box<dyn Fn() -> Record + Send + Sync>,
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Case").field("group", &self.group).field("name", &self.name).finish_non_exhaustive()
    }
}

impl Case {
    /// A case of the fast subset; the record that `run` makes gets group and name from here.
    pub fn new(group: &'static str, name: impl Into<String>, run: impl Fn() -> Record + Send + Sync + 'static) -> Self {
        Self { group, name: name.into(), quick: true, run: Box::new(run) }
    }

    /// Takes the case out of the fast subset.
    #[must_use]
    pub fn slow(self) -> Self {
        Self { quick: false, ..self }
    }

    /// Runs the case and records its outcome.
    pub fn run(&self) -> Record {
        let clock = Instant::now();
        let record = (self.run)();
        Record { group: self.group, name: self.name.clone(), seconds: clock.elapsed().as_secs_f64(), ..record }
    }
}
