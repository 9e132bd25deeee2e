//! What is exported, and where it comes from.

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
    pub name: &'static str,
    pub content: Vec<u8>,
    /// What it holds, in words.
    pub what: String,
    pub triangles: Option<usize>,
}

impl OutputFile {
    pub fn text(name: &'static str, content: String, what: impl Into<String>) -> Self {
        Self { name, content: content.into_bytes(), what: what.into(), triangles: None }
    }
}
