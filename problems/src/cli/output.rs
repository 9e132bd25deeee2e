//! JSON, files, and numbers that several commands report.

use crate::cli::{ContactObjective, Failure};
use crate::contact_shape::ContactState;
use crate::error::SceneError;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// An output folder that was found writable before the work began.
pub struct Folder(PathBuf);

impl Folder {
    /// Creates the folder and proves that it can be written to.
    ///
    /// # Errors
    /// [`SceneError::File`] with the system's reason.
    pub fn prepare(path: Option<&str>) -> Result<Option<Self>, SceneError> {
        let Some(path) = path.map(Path::new) else { return Ok(None) };
        let failed = |error: std::io::Error| SceneError::File {
            path: path.display().to_string(),
            reason: format!("cannot write there: {error}"),
        };
        std::fs::create_dir_all(path).map_err(failed)?;
        let probe = path.join(".nonsmooth-probe");
        std::fs::write(&probe, "").map_err(failed)?;
        std::fs::remove_file(&probe).map_err(failed)?;
        Ok(Some(Self(path.to_owned())))
    }

    /// Writes one file.
    ///
    /// # Errors
    /// [`Failure::Computation`] with the system's reason.
    pub fn write(&self, name: &str, text: &str) -> Result<(), Failure> {
        let path = self.0.join(name);
        std::fs::write(&path, text).map_err(|error| Failure::Computation(format!("{}: {error}", path.display())))
    }
}

/// One line-wrapped JSON object.
///
/// # Errors
/// [`Failure::Computation`] if a value cannot be written.
pub fn json(value: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).map(|text| text + "\n").map_err(|error| Failure::Computation(error.to_string()))
}

/// max σ, MPa.
pub fn peak_pressure(objective: &ContactObjective, state: &ContactState) -> f64 {
    objective.cost().pressures(state).into_iter().fold(f64::NEG_INFINITY, f64::max)
}
