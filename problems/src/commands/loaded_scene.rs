//! Where a scene comes from: the binary itself or a file.

use contact::error::SceneError;
use scene_file::{Case, SceneFile};
use std::path::{Path, PathBuf};

/// A scene file with its origin.
#[derive(Debug, Clone)]
pub struct Source {
    /// The scene.
    pub scene: SceneFile,
    /// The file, none for a scene that is part of the binary.
    file: Option<PathBuf>,
}

impl Source {
    /// The scene that is part of a binary.
    ///
    /// # Errors
    /// As [`SceneFile::parse`].
    pub fn embedded(name: &str, text: &str) -> Result<Self, SceneError> {
        Ok(Self { scene: SceneFile::parse(text, name)?, file: None })
    }

    /// The scene of a file.
    ///
    /// # Errors
    /// As [`SceneFile::read`].
    pub fn file(file: &Path) -> Result<Self, SceneError> {
        Ok(Self { scene: SceneFile::read(file)?, file: Some(file.to_owned()) })
    }

    /// The same origin with a changed scene.
    #[must_use]
    pub fn map(self, change: impl FnOnce(SceneFile) -> SceneFile) -> Self {
        Self { scene: change(self.scene), file: self.file }
    }

    /// The folder in which the scene's own files lie.
    pub fn folder(&self) -> &Path {
        self.file.as_deref().and_then(Path::parent).unwrap_or(Path::new(""))
    }

    /// The scene and the settings of a run.
    ///
    /// # Errors
    /// [`SceneError`] naming the file, the field, its value and what is allowed.
    pub fn case(&self) -> Result<Case, SceneError> {
        Case::new(&self.scene, self.folder()).map_err(|error| match &self.file {
            Some(file) => SceneError::InFile { file: file.display().to_string(), source: Box::new(error) },
            None => error,
        })
    }
}
