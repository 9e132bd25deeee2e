//! A journal that is being written: lines are appended and synchronised one by one.

use super::contents::Journal;
use super::entry::Entry;
use super::error::JournalError;
use super::restart_files;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A line that is not written yet.
#[derive(Debug)]
struct Pending {
    evaluation: usize,
    line: String,
    restart_data: Option<String>,
}

/// The files of a journal, open for appending.
#[derive(Debug)]
pub(super) struct Writer {
    folder: PathBuf,
    file: File,
    /// Lengths of the file after the first line and after every entry.
    ends: Vec<u64>,
    /// Lines that could not be written yet.
    pending: Vec<Pending>,
    /// Evaluations whose restart data lie in the folder.
    kept: Vec<usize>,
}

impl Writer {
    /// Continues the journal of a folder, a last line that is not whole being cut off, or begins one. With the entries that
    /// the journal holds.
    pub fn open(folder: &Path, identity: &str, dimension: usize) -> Result<(Self, Vec<Entry>), JournalError> {
        fs::create_dir_all(folder).map_err(JournalError::file(folder))?;
        let path = Journal::file(folder);
        let (file, ends, entries) = match Journal::read(folder)? {
            Some(journal) => {
                journal.check(&path, identity, dimension)?;
                let file = OpenOptions::new().append(true).open(&path).map_err(JournalError::file(&path))?;
                file.set_len(length(&journal.ends)).map_err(JournalError::file(&path))?;
                (file, journal.ends, journal.entries)
            }
            None => {
                let (file, end) = begin(folder, &path, identity, dimension).map_err(JournalError::file(&path))?;
                (file, vec![end], vec![])
            }
        };
        let kept = restart_files::present(folder).map_err(JournalError::file(folder))?;
        Ok((Self { folder: folder.to_owned(), file, ends, pending: vec![], kept }, entries))
    }

    /// Forgets all evaluations after the first `count`.
    pub fn cut(&mut self, count: usize) -> io::Result<()> {
        self.ends.truncate(count + 1);
        self.file.set_len(length(&self.ends))?;
        self.keep(|evaluation| evaluation <= count)
    }

    /// Restart data of an evaluation, as JSON.
    pub fn restart_data(&self, evaluation: usize) -> io::Result<String> {
        restart_files::read(&self.folder, evaluation)
    }

    /// Adds an evaluation. Its restart data are kept, and those that it was itself restarted from; no others, since the
    /// next request can carry only one of the two.
    ///
    /// # Errors
    /// The system's reason; what was not written is tried again with the next evaluation.
    pub fn append(&mut self, entry: &Entry, restart_data: Option<String>) -> io::Result<()> {
        let line = serde_json::to_string(entry)? + "\n";
        self.pending.push(Pending { evaluation: entry.evaluation, line, restart_data });
        while let Some(Pending { evaluation, line, restart_data }) = self.pending.first() {
            if let Some(text) = restart_data {
                restart_files::write(&self.folder, *evaluation, text)?;
                self.kept.push(*evaluation);
            }
            let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
            if let Err(error) = written {
                // Half a line must not stand before the next one.
                self.file.set_len(length(&self.ends))?;
                return Err(error);
            }
            self.ends.push(length(&self.ends) + line.len() as u64);
            self.pending.remove(0);
        }
        self.keep(|evaluation| evaluation == entry.evaluation || Some(evaluation) == entry.restarted_from)
    }

    /// Removes the restart data of all other evaluations.
    fn keep(&mut self, is_needed: impl Fn(usize) -> bool) -> io::Result<()> {
        for evaluation in self.kept.iter().copied().filter(|evaluation| !is_needed(*evaluation)) {
            restart_files::remove(&self.folder, evaluation)?;
        }
        self.kept.retain(|evaluation| is_needed(*evaluation));
        Ok(())
    }
}

/// Where the next line begins.
fn length(ends: &[u64]) -> u64 {
    ends.last().copied().unwrap_or(0)
}

/// Writes the first line, in place of what there was.
fn begin(folder: &Path, path: &Path, identity: &str, dimension: usize) -> io::Result<(File, u64)> {
    restart_files::remove_all(folder)?;
    let line = Journal::first_line(identity, dimension)?;
    let mut file = OpenOptions::new().append(true).create(true).open(path)?;
    file.set_len(0)?;
    file.write_all(line.as_bytes())?;
    file.sync_all()?;
    restart_files::synchronise(folder);
    Ok((file, line.len() as u64))
}
