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
    /// The faces of which it holds surfaces.
    pub faces: Vec<FaceRecord>,
}

/// A face as a B-spline surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaceRecord {
    pub face: String,
    pub nodes: usize,
    pub control_points: [usize; 2],
    /// Largest distance of a node from the surface, and the allowed one, mm.
    pub distance: f64,
    pub allowed: f64,
    /// Largest angle between the normals of a facet and of the surface at its centre, degrees.
    pub angle: f64,
}

impl OutputFile {
    pub fn text(name: impl Into<String>, content: String, what: impl Into<String>) -> Self {
        Self::new(name, content.into_bytes(), what)
    }

    pub fn new(name: impl Into<String>, content: Vec<u8>, what: impl Into<String>) -> Self {
        Self { name: name.into(), content, what: what.into(), triangles: None, faces: Vec::new() }
    }
}

/// The name of a file of a body: `pad_body.stl`, or `body.stl` of a body called so.
pub fn body_file(scene: &Scene, body: usize, ending: &str) -> String {
    named_file(scene, body, "body", ending)
}

/// The name of a file of something of a body: `pad_faces.step`, or `faces.step` of a body called "body".
pub fn named_file(scene: &Scene, body: usize, what: &str, ending: &str) -> String {
    if scene.bodies[body].name == "body" {
        format!("{what}.{ending}")
    } else {
        format!("{}_{what}.{ending}", stem(scene, body))
    }
}
