//! What is exported, and where it comes from.

use crate::commands::scene_words::stem;
use contact::scene::Scene;
use serde::Serialize;

/// Where an exported shape comes from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Origin {
    pub source: String,
    /// Number of the evaluation in its run, if it is known by one.
    pub evaluation: Option<usize>,
    /// Θ in that run, if it is known.
    pub objective: Option<f64>,
}

/// A file that is to be written.
pub struct OutputFile {
    /// Name below the folder.
    pub name: String,
    pub content: Vec<u8>,
    /// What it holds, in words.
    pub what: String,
    pub triangles: Option<usize>,
}

impl OutputFile {
    pub fn text(name: impl Into<String>, content: String, what: impl Into<String>) -> Self {
        Self { name: name.into(), content: content.into_bytes(), what: what.into(), triangles: None }
    }
}

/// The name of a file of a body: `pad_body.stl`, or `body.stl` of a body called so.
pub fn body_file(scene: &Scene, body: usize, ending: &str) -> String {
    if scene.bodies[body].name == "body" {
        format!("body.{ending}")
    } else {
        format!("{}_body.{ending}", stem(scene, body))
    }
}
