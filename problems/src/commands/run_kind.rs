//! What the run in a folder is: a file of the folder says it.

use crate::commands::failure::Failure;
use contact::error::SceneError;
use scene_file::read_text;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The file that says what the run in its folder is.
pub const RUN: &str = "run.json";
/// Largest such file, bytes.
const LARGEST_FILE: u64 = 1 << 16;

/// What the run in a folder is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunKind {
    Optimization,
    /// Two optimizations, with and without friction.
    Comparison,
    /// A study of parameters.
    Study,
}

/// The keys of the file.
#[derive(Serialize, Deserialize)]
struct RunJson {
    kind: RunKind,
}

impl RunKind {
    /// What the run in a folder is; none where no file says it.
    ///
    /// # Errors
    /// [`SceneError::File`] for a file that says something else.
    pub fn of(folder: &Path) -> Result<Option<Self>, SceneError> {
        let path = folder.join(RUN);
        if !path.exists() {
            return Ok(None);
        }
        let found: RunJson =
            serde_json::from_str(&read_text(&path, LARGEST_FILE)?).map_err(|error| SceneError::File {
                path: path.display().to_string(),
                reason: format!("{error}; the file says what the run in its folder is"),
            })?;
        Ok(Some(found.kind))
    }

    /// The content of the file.
    ///
    /// # Errors
    /// [`Failure::Computation`] if it cannot be written as JSON.
    pub fn file(self) -> Result<String, Failure> {
        Ok(serde_json::to_string(&RunJson { kind: self }).map_err(Failure::computation)? + "\n")
    }

    pub fn words(self) -> &'static str {
        match self {
            Self::Optimization => "an optimization",
            Self::Comparison => "a comparison",
            Self::Study => "a study",
        }
    }

    /// The command that continues it, with a blank; none for an optimization, which is the default.
    pub fn command(self) -> &'static str {
        match self {
            Self::Optimization => "",
            Self::Comparison => "compare ",
            Self::Study => "study ",
        }
    }
}
