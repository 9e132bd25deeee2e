//! Which files of a folder the program wrote, and which process works there.
//!
//! A folder of results holds a list of the files in it. A name is on the list before its file exists, so that a file
//! that is not on it was not written by the program, whenever the program ended. The process that works there locks it.

use crate::commands::failure::Failure;
use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

pub const REGISTER: &str = "nonsmooth-files.txt";
const HEADER: &str = "# The files that the program wrote here. It locks this list while it works.\n";
/// The journal of a run; its restart data and Jacobians lie beside it.
pub const JOURNAL: &str = "journal.jsonl";
/// Ending of a file that is being written.
pub const UNFINISHED: &str = ".tmp";

/// The list of a folder, locked.
#[derive(Debug)]
pub struct Register {
    root: PathBuf,
    kept: Mutex<Kept>,
}

#[derive(Debug)]
struct Kept {
    file: File,
    /// Length of the whole lines.
    end: u64,
    names: BTreeSet<String>,
}

impl Register {
    /// Locks the list of a folder. With `begun`, a list that does not exist is made; without, there is none then. A
    /// file that is no list is none either.
    ///
    /// # Errors
    /// [`Failure::Input`] if another process holds it; [`Failure::Computation`] with the system's reason.
    pub fn lock(root: &Path, begun: bool) -> Result<Option<Self>, Failure> {
        let path = root.join(REGISTER);
        let failed = |error: io::Error| Failure::Computation(format!("{}: {error}", path.display()));
        let mut file = match OpenOptions::new().read(true).append(true).create(begun).open(&path) {
            Err(error) if !begun && [io::ErrorKind::NotFound, io::ErrorKind::NotADirectory].contains(&error.kind()) => {
                return Ok(None);
            }
            opened => opened.map_err(failed)?,
        };
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                return Err(Failure::Input(format!("{}: another process works in this folder", root.display())));
            }
            Err(TryLockError::Error(error)) => return Err(failed(error)),
            Ok(()) => {}
        }
        let mut text = String::new();
        file.read_to_string(&mut text).map_err(failed)?;
        let Some((names, end)) = parse(&text) else { return Ok(None) };
        Ok(Some(Self { root: root.to_owned(), kept: Mutex::new(Kept { file, end, names }) }))
    }

    /// Puts a file on the list, by its path below the folder, before it is written.
    ///
    /// # Errors
    /// The system's reason; [`io::ErrorKind::AlreadyExists`] for a file that the program did not write.
    pub fn claim(&self, name: &str) -> io::Result<()> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.names.contains(name) {
            return Ok(());
        }
        if exists(&self.root.join(name)) {
            let words = "the file is there already and was not written by this program";
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, words));
        }
        let line = if kept.end == 0 { format!("{HEADER}{name}\n") } else { format!("{name}\n") };
        // A part of a line that an earlier process left must not stand before this one.
        let end = kept.end;
        kept.file.set_len(end)?;
        kept.file.write_all(line.as_bytes())?;
        kept.file.sync_data()?;
        kept.end += line.len() as u64;
        kept.names.insert(name.to_owned());
        Ok(())
    }

    /// The files on the list.
    pub fn names(&self) -> BTreeSet<String> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).names.clone()
    }

    /// Removes all files on the list, and empties it.
    ///
    /// # Errors
    /// The system's reason.
    pub fn clear(&self) -> io::Result<()> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let listed = kept.names.iter().filter(|name| *name != REGISTER);
        for path in listed.flat_map(|name| [name.clone(), format!("{name}{UNFINISHED}")]) {
            let path = self.root.join(path);
            if exists(&path) {
                fs::remove_file(path)?;
            }
        }
        kept.file.set_len(0)?;
        (kept.end, kept.names) = (0, BTreeSet::from([REGISTER.to_owned()]));
        Ok(())
    }
}

/// The names on the list of a folder, its own included.
pub fn names(root: &Path) -> BTreeSet<String> {
    let text = fs::read_to_string(root.join(REGISTER)).unwrap_or_default();
    parse(&text).map(|(names, _)| names).unwrap_or_default()
}

/// Names and length of the whole lines of a list; none for a text that is no list.
fn parse(text: &str) -> Option<(BTreeSet<String>, u64)> {
    let Some(lines) = text.strip_prefix(HEADER) else {
        // The program ended while it wrote the first line.
        return HEADER.starts_with(text).then(|| (BTreeSet::from([REGISTER.to_owned()]), 0));
    };
    let whole = lines.rfind('\n').map_or("", |last| &lines[..=last]);
    let names = whole.lines().chain([REGISTER]).map(str::to_owned).collect();
    Some((names, (HEADER.len() + whole.len()) as u64))
}

/// A file in a folder that is not on the list `names`; none if all are, or if there is no folder.
///
/// # Errors
/// The system's reason.
pub fn foreign(folder: &Path, names: &BTreeSet<String>) -> io::Result<Option<PathBuf>> {
    foreign_below(folder, "", names)
}

fn foreign_below(folder: &Path, prefix: &str, names: &BTreeSet<String>) -> io::Result<Option<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound && !folder.is_symlink() => return Ok(None),
        entries => entries?,
    };
    for entry in entries {
        let entry = entry?;
        let path = entry.path();
        let Some(name) = entry.file_name().to_str().map(|name| format!("{prefix}{name}")) else {
            return Ok(Some(path));
        };
        let found = if !entry.file_type()?.is_dir() {
            (!is_listed(&name, names)).then_some(path)
        } else if names.contains(&format!("{name}/{REGISTER}")) {
            foreign_below(&path, "", &self::names(&path))?
        } else {
            foreign_below(&path, &format!("{name}/"), names)?
        };
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

/// Whether a file is on a list, or one that comes with a file on the list.
fn is_listed(name: &str, names: &BTreeSet<String>) -> bool {
    let (folder, file) = name.rsplit_once('/').map_or(("", name), |(folder, file)| (&name[..=folder.len()], file));
    let of_journal = ["warm_start_", "linearization_"].iter().any(|prefix| file.starts_with(prefix))
        && names.contains(&format!("{folder}{JOURNAL}"));
    let being_written = name.strip_suffix(UNFINISHED).is_some_and(|name| names.contains(name));
    names.contains(name) || of_journal || being_written
}

/// Whether there is anything at a path, a link that leads nowhere included.
pub fn exists(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}
