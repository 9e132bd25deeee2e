//! A journal that is being written: lines are appended and synchronised one by one.

use super::contents::Journal;
use super::entry::{Entry, RecordedAnswer, RecordedLinearization};
use super::error::JournalError;
use super::linearization_file;
use super::restart_files::{self, Kind};
use crate::composite::Linearization;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A line that is not written yet.
#[derive(Debug)]
struct Pending {
    evaluation: usize,
    line: String,
    files: Vec<(Kind, Vec<u8>)>,
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
    /// Files that lie in the folder.
    kept: Vec<(Kind, usize)>,
    /// Evaluations whose restart data a Jacobian was computed from: they are kept to compute it again if its file is
    /// lost.
    origins: Vec<usize>,
}

impl Writer {
    /// Continues the journal of a folder, or begins one; returns it with the entries that it holds. A last line that is
    /// not whole is cut off.
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
        let origins = entries.iter().filter_map(origin).collect();
        Ok((Self { folder: folder.to_owned(), file, ends, pending: vec![], kept, origins }, entries))
    }

    /// Forgets all evaluations after the first `count`.
    pub fn cut(&mut self, count: usize) -> io::Result<()> {
        self.ends.truncate(count + 1);
        self.file.set_len(length(&self.ends))?;
        self.origins.retain(|evaluation| *evaluation <= count);
        self.keep(|_, evaluation| evaluation <= count)
    }

    /// Restart data of an evaluation, as JSON.
    pub fn restart_data(&self, evaluation: usize) -> io::Result<Vec<u8>> {
        restart_files::read(&self.folder, Kind::WarmStart, evaluation)
    }

    /// Outputs and Jacobian of an evaluation.
    pub fn linearization(&self, evaluation: usize) -> io::Result<Linearization> {
        linearization_file::decode(&restart_files::read(&self.folder, Kind::Linearization, evaluation)?)
    }

    /// Writes outputs and Jacobian of an evaluation again.
    pub fn restore(&self, evaluation: usize, linearization: &Linearization) -> io::Result<()> {
        let bytes = linearization_file::encode(linearization);
        restart_files::write(&self.folder, Kind::Linearization, evaluation, &bytes)
    }

    /// Adds an evaluation. Restart data are kept of this evaluation, of the one that it was restarted from, and of
    /// those that Jacobians were computed from; no others, since the next request can carry only one of the first two.
    ///
    /// # Errors
    /// The system's reason; what was not written is tried again with the next evaluation.
    pub fn append(
        &mut self,
        entry: &Entry,
        restart_data: Option<String>,
        linearization: Option<&Linearization>,
    ) -> io::Result<()> {
        let line = serde_json::to_string(entry)? + "\n";
        let restart_data = restart_data.map(|text| (Kind::WarmStart, text.into_bytes()));
        let linearization = linearization.map(|known| (Kind::Linearization, linearization_file::encode(known)));
        let files = restart_data.into_iter().chain(linearization).collect();
        self.origins.extend(origin(entry));
        self.pending.push(Pending { evaluation: entry.evaluation, line, files });
        while let Some(Pending { evaluation, line, files }) = self.pending.first() {
            for (kind, bytes) in files {
                restart_files::write(&self.folder, *kind, *evaluation, bytes)?;
                self.kept.push((*kind, *evaluation));
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
        let origins = std::mem::take(&mut self.origins);
        let needed = |evaluation: usize| {
            evaluation == entry.evaluation || Some(evaluation) == entry.restarted_from || origins.contains(&evaluation)
        };
        let kept = self.keep(|kind, evaluation| kind == Kind::Linearization || needed(evaluation));
        self.origins = origins;
        kept
    }

    /// Removes the files that are not needed.
    fn keep(&mut self, is_needed: impl Fn(Kind, usize) -> bool) -> io::Result<()> {
        for (kind, evaluation) in self.kept.iter().filter(|(kind, evaluation)| !is_needed(*kind, *evaluation)) {
            restart_files::remove(&self.folder, *kind, *evaluation)?;
        }
        self.kept.retain(|(kind, evaluation)| is_needed(*kind, *evaluation));
        Ok(())
    }
}

/// The evaluation whose restart data the Jacobian of an entry was computed from.
fn origin(entry: &Entry) -> Option<usize> {
    let stored = |answer: &RecordedAnswer| {
        matches!(answer, RecordedAnswer::Evaluated { linearization: Some(RecordedLinearization::Stored), .. })
    };
    entry.restarted_from.filter(|_| stored(&entry.answer))
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
