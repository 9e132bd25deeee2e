//! What evaluations leave beside the journal, a file each: restart data as JSON, Jacobians as bytes.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Data from which the oracle starts again.
    WarmStart,
    /// Outputs of a composite objective with their Jacobian.
    Linearization,
}

impl Kind {
    pub(super) const ALL: [Self; 2] = [Self::WarmStart, Self::Linearization];

    fn affixes(self) -> (&'static str, &'static str) {
        match self {
            Self::WarmStart => ("warm_start_", ".json"),
            Self::Linearization => ("linearization_", ".bin"),
        }
    }

    fn path(self, folder: &Path, evaluation: usize) -> PathBuf {
        let (prefix, suffix) = self.affixes();
        folder.join(format!("{prefix}{evaluation}{suffix}"))
    }
}

/// Makes new and renamed files of a folder durable, as far as the system can: a loss is noticed on resume.
pub(super) fn synchronise(folder: &Path) {
    #[cfg(unix)]
    let _best_effort = File::open(folder).and_then(|folder| folder.sync_all());
    #[cfg(not(unix))]
    let _ = folder;
}

/// Writes the file of an evaluation; it is whole or not there.
pub(super) fn write(folder: &Path, kind: Kind, evaluation: usize, bytes: &[u8]) -> io::Result<()> {
    let temporary = folder.join("warm_start_new.tmp");
    let mut file = File::create(&temporary)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    drop(file);
    fs::rename(temporary, kind.path(folder, evaluation))?;
    synchronise(folder);
    Ok(())
}

/// Reads the file of an evaluation.
pub(super) fn read(folder: &Path, kind: Kind, evaluation: usize) -> io::Result<Vec<u8>> {
    fs::read(kind.path(folder, evaluation))
}

/// Removes the file of an evaluation; one that is not there is no failure.
pub(super) fn remove(folder: &Path, kind: Kind, evaluation: usize) -> io::Result<()> {
    match fs::remove_file(kind.path(folder, evaluation)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// The files in the folder, by kind and evaluation.
pub(super) fn present(folder: &Path) -> io::Result<Vec<(Kind, usize)>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name();
        for kind in Kind::ALL {
            let (prefix, suffix) = kind.affixes();
            let number: Option<usize> =
                name.to_str().and_then(|name| name.strip_prefix(prefix)?.strip_suffix(suffix)?.parse().ok());
            found.extend(number.map(|number| (kind, number)));
        }
    }
    Ok(found)
}

/// Removes the restart files of all evaluations.
pub(super) fn remove_all(folder: &Path) -> io::Result<()> {
    present(folder)?.into_iter().try_for_each(|(kind, evaluation)| remove(folder, kind, evaluation))
}
