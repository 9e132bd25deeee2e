//! One invocation of a binary.

use crate::commands::arguments::Arguments;
use crate::commands::long_run::StatusLine;
use std::time::Instant;

/// What all optimizations of one invocation have in common.
#[derive(Debug, Clone)]
pub struct Session<'a> {
    /// The command line.
    pub arguments: &'a Arguments,
    /// When the time limit began to count.
    pub clock: Instant,
    /// The line on which progress is shown.
    pub status: StatusLine,
}
