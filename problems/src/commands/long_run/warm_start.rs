//! Restart data of evaluations as files: kind, count, values; little-endian.

use contact::contact_shape::ContactWarmStart;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

const PREFIX: &str = "warm_start_";
const SUFFIX: &str = ".bin";
/// First bytes of a file with multipliers, and of one with displacements.
const KINDS: [&[u8; 8]; 2] = [b"nsmult1\n", b"nsdisp1\n"];

fn path(folder: &Path, evaluation: usize) -> PathBuf {
    folder.join(format!("{PREFIX}{evaluation}{SUFFIX}"))
}

/// Writes the file atomically.
pub(super) fn write(folder: &Path, evaluation: usize, data: &ContactWarmStart) -> io::Result<()> {
    let (kind, values) = match data {
        ContactWarmStart::Multipliers(values) => (KINDS[0], values),
        ContactWarmStart::Displacements(values) => (KINDS[1], values),
    };
    let mut bytes = kind.to_vec();
    bytes.extend((values.len() as u64).to_le_bytes());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    let temporary = folder.join(format!("{PREFIX}new.tmp"));
    let mut file = File::create(&temporary)?;
    file.write_all(&bytes)?;
    file.sync_all()?;
    drop(file);
    fs::rename(temporary, path(folder, evaluation))
}

/// Reads the file; none if it is not there or not whole.
pub(super) fn read(folder: &Path, evaluation: usize) -> Option<ContactWarmStart> {
    let bytes = fs::read(path(folder, evaluation)).ok()?;
    let (kind, rest) = bytes.split_first_chunk::<8>()?;
    let (count, rest) = rest.split_first_chunk::<8>()?;
    let (values, remainder) = rest.as_chunks::<8>();
    if u64::from_le_bytes(*count) != values.len() as u64 || !remainder.is_empty() {
        return None;
    }
    let values = values.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    match KINDS.iter().position(|known| *known == kind)? {
        0 => Some(ContactWarmStart::Multipliers(values)),
        _ => Some(ContactWarmStart::Displacements(values)),
    }
}

/// Removes the file; one that is not there is no failure.
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
    evaluations.sort_unstable();
    Ok(evaluations)
}

/// Removes all files.
pub(super) fn remove_all(folder: &Path) -> io::Result<()> {
    present(folder)?.into_iter().try_for_each(|evaluation| remove(folder, evaluation))
}
