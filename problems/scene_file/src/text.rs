//! Files of users as text.

use contact::error::SceneError;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Reads a file of at most so many bytes, without a byte order mark at its beginning.
///
/// # Errors
/// [`SceneError::File`] for a file that cannot be read, is longer, or is no text.
pub fn read_text(file: &Path, largest: u64) -> Result<String, SceneError> {
    let failed = |reason: String| SceneError::File { path: file.display().to_string(), reason };
    let mut bytes = Vec::new();
    let opened = File::open(file).and_then(|file| file.take(largest + 1).read_to_end(&mut bytes));
    opened.map_err(|error| failed(error.to_string()))?;
    if bytes.len() as u64 > largest {
        return Err(failed(format!("the file is too long; allowed: at most {} MiB", largest >> 20)));
    }
    let text = String::from_utf8(bytes).map_err(|error| failed(format!("the file is no text in UTF-8: {error}")))?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}
