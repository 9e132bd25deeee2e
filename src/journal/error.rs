//! Why a journal cannot be continued.

use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A journal that cannot be read, written or continued.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum JournalError {
    /// A file or folder cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A complete line is neither a first line nor the entry that is expected there.
    #[error("{}: line {line}: {reason}", path.display())]
    Line {
        /// Path of the file of the journal.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// The reason for the refusal.
        reason: String,
    },
    /// The journal has another version of the format.
    #[error("{}: the journal has version {found} of the format, expected {expected}", path.display())]
    Version {
        /// Path of the file of the journal.
        path: PathBuf,
        /// Version of the format that the file states.
        found: u32,
        /// Version that this library reads and writes.
        expected: u32,
    },
    /// The journal belongs to an objective with another number of variables.
    #[error("{}: the journal is that of {found} variables, the objective has {expected}", path.display())]
    Dimension {
        /// Path of the file of the journal.
        path: PathBuf,
        /// Variables of the journal.
        found: usize,
        /// Variables of the objective.
        expected: usize,
    },
    /// The journal belongs to another objective.
    #[error("{}: the journal is that of another objective: {}", path.display(), difference(found, expected))]
    Identity {
        /// Path of the file of the journal.
        path: PathBuf,
        /// Identity in the journal.
        found: String,
        /// Identity of the objective.
        expected: String,
    },
}

impl JournalError {
    /// An error of the system at a place.
    pub(super) fn file(path: &Path) -> impl Fn(io::Error) -> Self {
        move |source| Self::File { path: path.to_owned(), source }
    }
}

/// The places at which two identities, which may be long, begin to differ.
fn difference(found: &str, expected: &str) -> String {
    /// Characters shown before and after that place.
    const CONTEXT: usize = 30;
    let common = found.chars().zip(expected.chars()).take_while(|(a, b)| a == b).count();
    let excerpt =
        |text: &str| -> String { text.chars().skip(common.saturating_sub(CONTEXT)).take(2 * CONTEXT).collect() };
    format!("{:?} where {:?} is expected", excerpt(found), excerpt(expected))
}
