//! Sections that the report pages of several commands share.

use crate::commands::folder::{SCENE, quoted};
use crate::commands::shape_facts::is_proved;
use figures::page::{Block, Section};
use nonsmooth::Report;
use std::path::Path;

/// The pictures of a page.
pub fn pictures(blocks: Vec<Block>) -> Section {
    Section::new("Pictures", blocks)
}

/// What the shape that an optimization ended at is called.
pub fn found_label(report: &Report) -> &'static str {
    if is_proved(report) { "optimum" } else { "best found" }
}

/// How the shape of a run is exported for other programs, as it is typed in a shell.
pub fn export_command(folder: &Path) -> String {
    let path = |path: &Path| quoted(path.display().to_string());
    let (scene, run) = (path(&folder.join(SCENE)), path(folder));
    format!("contact3d {scene} export --run {run} --out {}", quoted(format!("{}_export", folder.display())))
}

/// The command, the scene and what it did not need.
pub fn origin(scene: &str, left_out: &[&str]) -> Section {
    let words: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    let mut blocks = vec![Block::Listing { title: "The command".into(), text: words.join(" ") }];
    if !left_out.is_empty() {
        blocks.push(Block::Text(format!("Left out, because this scene does not need it: {}.", left_out.join("; "))));
    }
    blocks
        .push(Block::Listing { title: "The scene, complete, with all options put in".into(), text: scene.to_owned() });
    Section::new("Scene", blocks)
}
