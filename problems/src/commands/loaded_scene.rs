//! What a command works on: a scene file with its place and the case that it describes, and one invocation of a binary.

use crate::commands::arguments::Arguments;
use crate::commands::long_run::StatusLine;
use contact::error::SceneError;
use contact::solvers::Processes;
use scene_file::{Case, SceneFile};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A scene file, options of the command line included, and the case that it describes.
#[derive(Debug, Clone)]
pub struct LoadedScene {
    /// The fields of the file.
    pub file: SceneFile,
    /// The path of the file; none for a scene that is part of a binary.
    path: Option<PathBuf>,
    /// The scene and the settings of a run.
    pub case: Case,
    /// What the text of the file leaves open.
    pub open: Vec<String>,
}

impl LoadedScene {
    /// Checks the fields of a scene file from `path` and converts them.
    ///
    /// # Errors
    /// [`SceneError`] naming the file, the field, its value and what is allowed.
    pub fn new(file: SceneFile, path: Option<PathBuf>) -> Result<Self, SceneError> {
        let case = Case::new(&file, folder(path.as_deref())).map_err(|error| match &path {
            Some(path) => SceneError::InFile { file: path.display().to_string(), source: Box::new(error) },
            None => error,
        })?;
        let open = path.as_deref().map(SceneFile::open_questions).transpose()?.unwrap_or_default();
        Ok(Self { file, path, case, open })
    }

    /// A copy of the scene with changed fields.
    pub fn changed(&self, change: impl FnOnce(&mut SceneFile)) -> Result<Self, SceneError> {
        let mut file = self.file.clone();
        change(&mut file);
        Self::new(file, self.path.clone())
    }

    /// The folder in which the files lie that the scene names.
    pub fn folder(&self) -> &Path {
        folder(self.path.as_deref())
    }
}

fn folder(path: Option<&Path>) -> &Path {
    path.and_then(Path::parent).unwrap_or(Path::new(""))
}

/// What all parts of one invocation have in common.
#[derive(Debug, Clone)]
pub struct Session<'a> {
    pub arguments: &'a Arguments,
    /// When the time limit began to count.
    pub clock: Instant,
    /// The line on which progress is shown.
    pub status: StatusLine,
    /// The processes that work on it.
    pub processes: Processes,
}
