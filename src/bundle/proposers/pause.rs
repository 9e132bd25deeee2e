//! How long a proposer keeps silent after it has failed.

/// A pause of 1, 2, 4, … evaluations: it doubles with every failure since the last success.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pause {
    left: usize,
    failures: u32,
}

impl Pause {
    /// Whether the pause is over; lets one more evaluation of it pass.
    pub(crate) fn pass(&mut self) -> bool {
        let over = self.left == 0;
        self.left = self.left.saturating_sub(1);
        over
    }

    /// Does not count the evaluation that has passed.
    pub(crate) fn prolong(&mut self) {
        self.left += 1;
    }

    pub(crate) fn succeed(&mut self) {
        self.failures = 0;
    }

    /// Begins a pause of at most `longest` evaluations.
    pub(crate) fn fail(&mut self, longest: usize) {
        self.left = (1 << self.failures.min(16)).min(longest);
        self.failures += 1;
    }
}
