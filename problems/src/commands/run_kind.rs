//! What the run in a folder is.

/// What the run in a folder is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunKind {
    /// One optimization.
    Optimization,
    /// Two optimizations, with and without friction.
    Comparison,
    /// A study of parameters.
    Study,
}

impl RunKind {
    /// What it is, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Optimization => "an optimization",
            Self::Comparison => "a comparison",
            Self::Study => "a study",
        }
    }

    /// The command that continues it, with a blank; none for an optimization, which is the default.
    pub fn command(self) -> &'static str {
        match self {
            Self::Optimization => "",
            Self::Comparison => "compare ",
            Self::Study => "study ",
        }
    }
}
