//! The journal: one line of JSON per evaluation, appended and synchronised before the next one begins.

use crate::commands::long_run::warm_start;
use contact::contact_shape::ContactWarmStart;
use contact::error::SceneError;
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Name of the file in the folder of a run.
const NAME: &str = "journal.jsonl";
/// Version of the format, in the first line.
const VERSION: u32 = 1;

#[derive(Serialize, Deserialize)]
struct Header {
    journal: u32,
}

/// One evaluation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Number of the evaluation, from 1.
    pub evaluation: usize,
    /// Where: control heights, mm.
    pub point: Vec<f64>,
    /// Relative accuracy that was asked for.
    pub accuracy: f64,
    /// Seconds of computation since the start of the run, earlier parts of it included.
    pub seconds: f64,
    /// What came of it.
    pub outcome: Outcome,
}

/// What came of an evaluation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Outcome {
    /// Value and subgradient.
    Answer {
        /// Θ.
        value: f64,
        /// One subgradient.
        subgradient: Vec<f64>,
        /// Promised error of the value.
        error_bound: f64,
        /// Whether the value is only a lower bound above the descent target.
        no_descent: bool,
    },
    /// The reason why there is none.
    Failure(String),
}

/// A journal that is being written.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    file: File,
    /// Where the lines end: the first line, then every evaluation.
    ends: Vec<u64>,
    /// Lines that could not be written yet, with restart data.
    pending: Vec<(usize, String, Option<ContactWarmStart>)>,
    /// Evaluations whose restart data lie in the folder.
    kept: Vec<usize>,
}

impl Journal {
    /// Whether a folder holds a journal.
    pub fn exists(folder: &Path) -> bool {
        folder.join(NAME).exists()
    }

    /// Removes the journal of a folder with its restart data.
    ///
    /// # Errors
    /// The system's reason.
    pub fn remove(folder: &Path) -> io::Result<()> {
        warm_start::remove_all(folder)?;
        std::fs::remove_file(folder.join(NAME))
    }

    /// Begins a journal, in place of an older one.
    ///
    /// # Errors
    /// The system's reason.
    pub fn create(folder: &Path) -> io::Result<Self> {
        warm_start::remove_all(folder)?;
        let mut file = File::create(folder.join(NAME))?;
        let header = serde_json::to_string(&Header { journal: VERSION })? + "\n";
        file.write_all(header.as_bytes())?;
        file.sync_all()?;
        let ends = vec![header.len() as u64];
        Ok(Self { folder: folder.to_owned(), file, ends, pending: vec![], kept: vec![] })
    }

    /// Number of evaluations in the journal of a folder; it is not changed.
    ///
    /// # Errors
    /// As [`Journal::open`].
    pub fn count(folder: &Path) -> Result<usize, SceneError> {
        let path = folder.join(NAME);
        let failed = |reason: String| SceneError::File { path: path.display().to_string(), reason };
        let bytes = std::fs::read(&path).map_err(|error| failed(error.to_string()))?;
        // A run may have ended before its first line was whole.
        if !bytes.contains(&b'\n') { Ok(0) } else { parse(&bytes).map(|(entries, _)| entries.len()).map_err(failed) }
    }

    /// Opens a journal to continue it; a last line that is not whole is cut off.
    ///
    /// # Errors
    /// [`SceneError::File`] for a file that cannot be read or that is no journal of this version.
    pub fn open(folder: &Path) -> Result<(Self, Vec<Entry>), SceneError> {
        let path = folder.join(NAME);
        let failed = |reason: String| SceneError::File { path: path.display().to_string(), reason };
        let bytes = std::fs::read(&path).map_err(|error| failed(error.to_string()))?;
        if !bytes.contains(&b'\n') {
            // The run ended before its first line was whole.
            return Ok((Self::create(folder).map_err(|error| failed(error.to_string()))?, vec![]));
        }
        let (entries, ends) = parse(&bytes).map_err(failed)?;
        let file = OpenOptions::new().append(true).open(&path).map_err(|error| failed(error.to_string()))?;
        file.set_len(ends[entries.len()]).map_err(|error| failed(error.to_string()))?;
        let kept = warm_start::present(folder).map_err(|error| failed(error.to_string()))?;
        Ok((Self { folder: folder.to_owned(), file, ends, pending: vec![], kept }, entries))
    }

    fn length(&self) -> u64 {
        self.ends.last().copied().unwrap_or(0)
    }

    /// Forgets all evaluations after the first `count`.
    ///
    /// # Errors
    /// The system's reason.
    pub fn cut(&mut self, count: usize) -> io::Result<()> {
        self.ends.truncate(count + 1);
        self.file.set_len(self.length())
    }

    /// Restart data of an evaluation, if they were kept.
    pub fn warm_start(&self, evaluation: usize) -> Option<ContactWarmStart> {
        warm_start::read(&self.folder, evaluation)
    }

    /// Adds an evaluation with its restart data, which are kept for it and for the evaluation of the `center`.
    ///
    /// # Errors
    /// The system's reason; what was not written is tried again with the next evaluation.
    pub fn append(
        &mut self,
        entry: &Entry,
        warm_start: Option<&ContactWarmStart>,
        center: Option<usize>,
    ) -> io::Result<()> {
        let line = serde_json::to_string(entry)? + "\n";
        self.pending.push((entry.evaluation, line, warm_start.cloned()));
        while let Some((evaluation, line, warm_start)) = self.pending.first() {
            let evaluation = *evaluation;
            if let Some(data) = warm_start {
                warm_start::write(&self.folder, evaluation, data)?;
                self.kept.push(evaluation);
            }
            let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
            if let Err(error) = written {
                // Half a line must not stand before the next one.
                self.file.set_len(self.length())?;
                return Err(error);
            }
            self.ends.push(self.length() + line.len() as u64);
            self.pending.remove(0);
        }
        let needed = |evaluation: usize| evaluation == entry.evaluation || Some(evaluation) == center;
        for evaluation in self.kept.iter().copied().filter(|evaluation| !needed(*evaluation)) {
            warm_start::remove(&self.folder, evaluation)?;
        }
        self.kept.retain(|evaluation| needed(*evaluation));
        Ok(())
    }
}

/// The evaluations of a journal, and where its lines end; what follows the last whole line does not count.
///
/// # Errors
/// The number of the line that is no evaluation, and why.
pub fn parse(bytes: &[u8]) -> Result<(Vec<Entry>, Vec<u64>), String> {
    let (mut entries, mut ends): (Vec<Entry>, Vec<u64>) = (vec![], vec![]);
    let mut end = 0;
    for (number, line) in bytes.split_inclusive(|byte| *byte == b'\n').enumerate() {
        let Some((b'\n', line)) = line.split_last() else { break };
        end += line.len() as u64 + 1;
        let failed = |error: String| format!("line {}: {error}", number + 1);
        if number == 0 {
            let Header { journal } = serde_json::from_slice(line).map_err(|error| failed(error.to_string()))?;
            if journal != VERSION {
                return Err(format!("version {journal} of the journal; expected {VERSION}"));
            }
        } else {
            let entry: Entry = serde_json::from_slice(line).map_err(|error| failed(error.to_string()))?;
            if entry.evaluation != number {
                return Err(failed(format!("evaluation {}, expected {number}", entry.evaluation)));
            }
            entries.push(entry);
        }
        ends.push(end);
    }
    if ends.is_empty() { Err("no journal".into()) } else { Ok((entries, ends)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(evaluation: usize) -> Entry {
        let outcome = match evaluation {
            2 => Outcome::Failure("an element is inverted".into()),
            _ => Outcome::Answer {
                value: 0.1 + 0.2,
                subgradient: vec![1e-300, -2.5],
                error_bound: 0.0,
                no_descent: false,
            },
        };
        Entry { evaluation, point: vec![1.0 / 3.0, 2.0], accuracy: 1e-12, seconds: 0.5, outcome }
    }

    #[test]
    fn lines_survive_bit_by_bit_and_a_torn_one_is_cut_off() {
        let folder = std::env::temp_dir().join(format!("nonsmooth-journal-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        let mut journal = Journal::create(&folder).expect("writable");
        let data = ContactWarmStart::Multipliers(vec![0.1, -0.0, 1e300]);
        for evaluation in 1..=3 {
            journal.append(&entry(evaluation), Some(&data), Some(1)).expect("writable");
        }
        drop(journal);
        let path = folder.join(NAME);
        let whole = std::fs::read(&path).expect("readable");
        std::fs::write(&path, [whole.as_slice(), &whole[20..60]].concat()).expect("writable");
        let (mut journal, entries) = Journal::open(&folder).expect("a journal");
        assert_eq!(entries, [entry(1), entry(2), entry(3)]);
        assert_eq!(std::fs::read(&path).expect("readable"), whole);
        let kept = [1, 2, 3].map(|evaluation| journal.warm_start(evaluation));
        let Some(ContactWarmStart::Multipliers(values)) = &kept[0] else { panic!("{kept:?}") };
        assert_eq!(values.iter().map(|x| x.to_bits()).collect::<Vec<_>>(), [0.1, -0.0, 1e300].map(f64::to_bits));
        assert!(kept[1].is_none() && kept[2].is_some());
        journal.append(&entry(4), None, Some(3)).expect("writable");
        assert_eq!(Journal::open(&folder).expect("a journal").1.len(), 4);
        std::fs::write(&path, "{\"journal\":1}\n{}\n").expect("writable");
        assert!(Journal::open(&folder).expect_err("line 2 is no evaluation").to_string().contains("line 2"));
        std::fs::write(&path, "{\"journal\":9}\n").expect("writable");
        assert!(Journal::open(&folder).expect_err("another version").to_string().contains("version 9"));
        std::fs::remove_dir_all(&folder).expect("removable");
    }
}
