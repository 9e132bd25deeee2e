//! What a journal says: its first line and the evaluations after it.

use super::entry::Entry;
use super::error::JournalError;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Version of the format, in the first line.
const VERSION: u32 = 3;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    journal: u32,
    identity: String,
    dimension: usize,
}

/// The contents of a journal.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Journal {
    /// The caller's name for the objective.
    pub identity: String,
    /// Number of variables.
    pub dimension: usize,
    /// The evaluations, in order.
    pub entries: Vec<Entry>,
    /// Lengths of the file after the first line and after every entry, bytes.
    pub(super) ends: Vec<u64>,
}

impl Journal {
    /// The file in the folder of a journal.
    pub(super) fn file(folder: &Path) -> PathBuf {
        folder.join("journal.jsonl")
    }

    /// Whether a folder holds a journal, readable or not.
    pub fn exists(folder: impl AsRef<Path>) -> bool {
        Self::file(folder.as_ref()).exists()
    }

    /// Reads the journal of a folder, which is not changed; `None` if there is none, or if the run ended before its
    /// first line was written.
    ///
    /// # Errors
    /// [`JournalError::File`], and as [`parse`](Self::parse).
    pub fn read(folder: impl AsRef<Path>) -> Result<Option<Self>, JournalError> {
        let path = Self::file(folder.as_ref());
        match std::fs::read(&path) {
            Ok(bytes) => Self::parse(&bytes, &path),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(JournalError::file(&path)(error)),
        }
    }

    /// Reads the bytes of a journal; `path` stands in messages. A last line without its end, which was being written
    /// when the run ended, does not count; `None` if that is the first one.
    ///
    /// # Errors
    /// [`JournalError::Line`] and [`JournalError::Version`].
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Option<Self>, JournalError> {
        #[derive(Deserialize)]
        struct Format {
            journal: u32,
        }
        let mut journal: Option<Self> = None;
        let mut end = 0;
        for (index, line) in bytes.split_inclusive(|byte| *byte == b'\n').enumerate() {
            let Some((b'\n', line)) = line.split_last() else { break };
            end += line.len() as u64 + 1;
            let wrong = |reason: String| JournalError::Line { path: path.to_owned(), line: index + 1, reason };
            let Some(journal) = &mut journal else {
                // Other versions may have other fields.
                let found = serde_json::from_slice::<Format>(line).map_err(|error| wrong(error.to_string()))?.journal;
                if found != VERSION {
                    return Err(JournalError::Version { path: path.to_owned(), found, expected: VERSION });
                }
                let Header { identity, dimension, .. } =
                    serde_json::from_slice(line).map_err(|error| wrong(error.to_string()))?;
                journal = Some(Self { identity, dimension, entries: vec![], ends: vec![end] });
                continue;
            };
            let entry: Entry = serde_json::from_slice(line).map_err(|error| wrong(error.to_string()))?;
            if entry.evaluation != index {
                return Err(wrong(format!("evaluation {}, expected {index}", entry.evaluation)));
            }
            if entry.point.len() != journal.dimension {
                return Err(wrong(format!("a point of {} entries, expected {}", entry.point.len(), journal.dimension)));
            }
            journal.entries.push(entry);
            journal.ends.push(end);
        }
        Ok(journal)
    }

    /// The first line of a journal, with its end.
    pub(super) fn first_line(identity: &str, dimension: usize) -> serde_json::Result<String> {
        let header = Header { journal: VERSION, identity: identity.to_owned(), dimension };
        Ok(serde_json::to_string(&header)? + "\n")
    }

    /// Refuses the journal of another objective.
    pub(super) fn check(&self, path: &Path, identity: &str, dimension: usize) -> Result<(), JournalError> {
        let path = path.to_owned();
        if self.identity != identity {
            let (found, expected) = (self.identity.clone(), identity.to_owned());
            Err(JournalError::Identity { path, found, expected })
        } else if self.dimension != dimension {
            Err(JournalError::Dimension { path, found: self.dimension, expected: dimension })
        } else {
            Ok(())
        }
    }
}
