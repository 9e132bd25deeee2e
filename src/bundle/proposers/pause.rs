//! How long a proposer keeps silent after it has failed.

/// A pause of 1, 2, 4, … evaluations: it doubles with every failure since the last success.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pause {
    left: usize,
    failures: u32,
}

impl Pause {
    /// Whether the pause is over. Counts one evaluation of the pause.
    pub(crate) fn pass(&mut self) -> bool {
        let over = self.left == 0;
        self.left = self.left.saturating_sub(1);
        over
    }

    /// Lengthens the pause by one evaluation.
    pub(crate) fn prolong(&mut self) {
        self.left += 1;
    }

    pub(crate) fn succeed(&mut self) {
        self.failures = 0;
    }

    /// Begins a pause, twice as long as the last one since a success, up to a thousand evaluations.
    pub(crate) fn fail(&mut self) {
        self.left = 1 << self.failures.min(10);
        self.failures += 1;
    }
}
