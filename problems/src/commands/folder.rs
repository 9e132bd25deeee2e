//! Output folders, and JSON as text.

use crate::commands::failure::Failure;
use contact::error::SceneError;
use figures::Figure;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Pixels of a PNG per point of the SVG.
#[cfg(feature = "png")]
const PNG_SCALE: f64 = 2.0;
/// Said once by a program without the feature `png`.
#[cfg(not(feature = "png"))]
const HOW_TO_GET_PNG: &str = "pictures are written as SVG; built with --features png, the program writes PNG as well";

/// Endings of the files of a picture, as the report names them.
pub const PICTURE_ENDINGS: &str = if cfg!(feature = "png") { ".svg, .png" } else { ".svg" };

/// An output folder that was found writable before the work began.
#[derive(Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// Creates the folder and proves that files of so many bytes can be written to it.
    ///
    /// # Errors
    /// [`SceneError::File`] with the system's reason.
    pub fn with_room(path: &Path, bytes: u64) -> Result<Self, SceneError> {
        let failed = |error: std::io::Error| file_error(path, format!("cannot write {bytes} bytes there: {error}"));
        std::fs::create_dir_all(path).map_err(failed)?;
        let probe = path.join(format!(".nonsmooth-probe-{}", std::process::id()));
        let written = std::fs::File::create(&probe).and_then(|mut file| {
            let block = vec![0_u8; 1 << 16];
            let mut left = bytes;
            while left > 0 {
                let now = left.min(block.len() as u64);
                file.write_all(&block[..now as usize])?;
                left -= now;
            }
            file.sync_all()
        });
        let removed = std::fs::remove_file(&probe);
        written.and(removed).map_err(failed)?;
        Ok(Self(path.to_owned()))
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// A folder inside this one, made if it does not exist.
    ///
    /// # Errors
    /// [`Failure::Computation`] with the system's reason.
    pub fn within(&self, name: &str) -> Result<Self, Failure> {
        let path = self.0.join(name);
        match std::fs::create_dir_all(&path) {
            Ok(()) => Ok(Self(path)),
            Err(error) => Err(Failure::Computation(format!("{}: {error}", path.display()))),
        }
    }

    /// Writes one file.
    ///
    /// # Errors
    /// [`Failure::Computation`] with the system's reason.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), Failure> {
        let path = self.0.join(name);
        std::fs::write(&path, content).map_err(|error| Failure::Computation(format!("{}: {error}", path.display())))
    }

    /// Writes a figure as SVG and, with the feature `png`, as PNG; without, stderr says once how to get PNG.
    ///
    /// # Errors
    /// As [`write`](Self::write); [`Failure::Computation`] if it cannot be drawn.
    pub fn draw(&self, figure: &Figure) -> Result<(), Failure> {
        self.write(&format!("{}.svg", figure.name), &figure.svg)?;
        #[cfg(feature = "png")]
        self.write(&format!("{}.png", figure.name), figure.png(PNG_SCALE).map_err(Failure::computation)?)?;
        #[cfg(not(feature = "png"))]
        {
            static SAID: std::sync::Once = std::sync::Once::new();
            // A closed stderr is no reason to fail.
            SAID.call_once(|| drop(writeln!(std::io::stderr(), "{HOW_TO_GET_PNG}")));
        }
        Ok(())
    }

    /// Writes one file atomically: at any time it holds the old text or the new one, never a part.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn replace(&self, name: &str, text: &str) -> Result<(), Failure> {
        let (path, temporary) = (self.0.join(name), self.0.join(format!("{name}.tmp")));
        let written = std::fs::File::create(&temporary)
            .and_then(|mut file| file.write_all(text.as_bytes()).and_then(|()| file.sync_all()))
            .and_then(|()| std::fs::rename(&temporary, &path));
        written.map_err(|error| Failure::Computation(format!("{}: {error}", path.display())))
    }
}

/// The error about a file or a folder.
pub fn file_error(path: &Path, reason: impl ToString) -> SceneError {
    SceneError::File { path: path.display().to_string(), reason: reason.to_string() }
}

/// A value as JSON, one field per line.
///
/// # Errors
/// [`Failure::Computation`] if a value cannot be written.
pub fn json(value: &(impl Serialize + ?Sized)) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).map(|text| text + "\n").map_err(|error| Failure::Computation(error.to_string()))
}
