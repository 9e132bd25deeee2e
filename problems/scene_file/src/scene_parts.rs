//! A scene with what a file says beside it.

use contact::error::SceneError;
use contact::scene::Scene;

/// A scene with what goes beside it.
pub(crate) struct Parts {
    pub scene: Scene,
    pub start: Option<Vec<f64>>,
    pub notes: Vec<String>,
}

/// A field that a scene of blocks, or of a mesh, must have.
pub(crate) fn required<'f, T>(field: &str, value: Option<&'f T>, allowed: &str) -> Result<&'f T, SceneError> {
    value.ok_or_else(|| SceneError::out_of_range(field, "missing", allowed))
}
