//! The same scene.
