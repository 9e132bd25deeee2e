//! Restart data of evaluations as files beside the journal, as JSON.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

const PREFIX: &str = "warm_start_";
const SUFFIX: &str = ".json";

fn path(folder: &Path, evaluation: usize) -> PathBuf {
    folder.join(format!("{PREFIX}{evaluation}{SUFFIX}"))
}

/// Makes new and renamed files of a folder durable, as far as the system can: a loss is noticed on resume.
pub(super) fn synchronise(folder: &Path) {
    #[cfg(unix)]
    let _best_effort = File::open(folder).and_then(|folder| folder.sync_all());
    #[cfg(not(unix))]
    let _ = folder;
}

/// Writes the file of an evaluation; it is whole or not there.
pub(super) fn write(folder: &Path, evaluation: usize, text: &str) -> io::Result<()> {
    let temporary = folder.join(format!("{PREFIX}new.tmp"));
    let mut file = File::create(&temporary)?;
    file.write_all(text.as_bytes())?;
    file.sync_all()?;
    drop(file);
    fs::rename(temporary, path(folder, evaluation))?;
    synchronise(folder);
    Ok(())
}

/// Reads the file of an evaluation.
pub(super) fn read(folder: &Path, evaluation: usize) -> io::Result<String> {
    fs::read_to_string(path(folder, evaluation))
}

/// Removes the file of an evaluation; one that is not there is no failure.
pub(super) fn remove(folder: &Path, evaluation: usize) -> io::Result<()> {
    match fs::remove_file(path(folder, evaluation)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Evaluations with a file in the folder.
pub(super) fn present(folder: &Path) -> io::Result<Vec<usize>> {
    let mut evaluations = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name();
        let number: Option<usize> =
            name.to_str().and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?.parse().ok());
        evaluations.extend(number);
    }
    Ok(evaluations)
}

/// Removes all files.
pub(super) fn remove_all(folder: &Path) -> io::Result<()> {
    present(folder)?.into_iter().try_for_each(|evaluation| remove(folder, evaluation))
}
