//! A run as data: everything that a resumed run needs to continue bit by bit.

use super::state::State;
use crate::{Polyhedron, Vector};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::Write;
use std::path::Path;
use thiserror::Error;

/// Version written into snapshots.
const VERSION: u32 = 3;

/// The state of a run between two steps; versioned.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Snapshot {
    version: u32,
    pub(super) set: Polyhedron,
    pub(super) state: State,
}

/// A snapshot cannot be written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SnapshotError {
    /// The file cannot be read or written.
    #[error("snapshot file: {0}")]
    File(#[from] std::io::Error),
    /// The text is no snapshot.
    #[error("snapshot text: {0}")]
    Format(#[from] serde_json::Error),
    /// The snapshot was written by another version.
    #[error("snapshot has version {found}, expected {VERSION}")]
    Version {
        /// Version found.
        found: u32,
    },
}

impl Snapshot {
    pub(super) fn new(set: Polyhedron, state: State) -> Self {
        Self { version: VERSION, set, state }
    }

    /// The stability center.
    pub fn center(&self) -> &Vector {
        &self.state.center
    }

    /// Θ at the center.
    pub fn value(&self) -> f64 {
        self.state.center_value
    }

    /// Evaluations spent so far.
    pub fn evaluations(&self) -> usize {
        self.state.counts.evaluations
    }

    /// Length of the last step that was evaluated.
    pub fn last_step_length(&self) -> Option<f64> {
        self.state.history.last().map(|record| record.step_length).filter(|length| *length > 0.0)
    }

    /// The snapshot as JSON text; numbers survive bit by bit.
    ///
    /// # Errors
    /// [`SnapshotError::Format`] if it cannot be serialized.
    pub fn to_json(&self) -> Result<String, SnapshotError> {
        Ok(serde_json::to_string(self)?)
    }

    /// Reads JSON text written by [`to_json`](Self::to_json).
    ///
    /// # Errors
    /// [`SnapshotError::Format`] and [`SnapshotError::Version`].
    pub fn from_json(text: &str) -> Result<Self, SnapshotError> {
        #[derive(Deserialize)]
        struct Header {
            version: u32,
        }
        let found = serde_json::from_str::<Header>(text)?.version;
        if found != VERSION {
            return Err(SnapshotError::Version { found });
        }
        Ok(serde_json::from_str(text)?)
    }

    /// Writes the snapshot to a temporary file beside `file` and renames it: `file` always holds a complete snapshot.
    ///
    /// # Errors
    /// [`SnapshotError::File`], [`SnapshotError::Format`].
    pub fn write(&self, file: &Path) -> Result<(), SnapshotError> {
        let text = self.to_json()?;
        let mut name = file.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.tmp", std::process::id()));
        let temporary = file.with_file_name(name);
        let mut handle = fs::File::create(&temporary)?;
        handle.write_all(text.as_bytes())?;
        handle.sync_all()?;
        drop(handle);
        fs::rename(&temporary, file)?;
        Ok(())
    }

    /// Reads a snapshot written by [`write`](Self::write).
    ///
    /// # Errors
    /// [`SnapshotError`].
    pub fn read(file: &Path) -> Result<Self, SnapshotError> {
        Self::from_json(&fs::read_to_string(file)?)
    }
}
