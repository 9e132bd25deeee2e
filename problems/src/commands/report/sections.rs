//! Sections that the report pages of several commands share.

use crate::commands::folder::{SCENE, quoted};
use crate::commands::limited_value::LimitedValue;
use crate::commands::numbers::number;
use crate::commands::solved_shape::SolvedShape;
use figures::page::{Block, Section};
use nonsmooth::Report;
use std::path::Path;

/// The pictures of a page.
pub fn pictures(blocks: Vec<Block>) -> Section {
    Section::new("Pictures", blocks)
}

/// What the shape that an optimization ended at is called.
pub fn found_label(report: &Report) -> &'static str {
    match (report.is_feasible(), report.is_confirmed()) {
        (false, _) => "outside limits",
        (true, true) => "optimum",
        (true, false) => "best found",
    }
}

/// The limits of a scene at a start and an end: values, bounds, whether they are kept and, for the end of a run, what
/// they cost. Empty without limits.
pub fn limits(shapes: &[&SolvedShape], report: Option<&Report>) -> Section {
    let Some(end) = shapes.last().filter(|shape| !shape.limits.is_empty()) else { return Section::default() };
    let found = |index: usize| report.and_then(|report| report.constraints.get(index));
    let row = |(index, own): (usize, &LimitedValue)| {
        let values = shapes.iter().map(|shape| number(shape.limits[index].value));
        let kept = match own.excess() {
            0.0 => "kept".to_owned(),
            excess => format!("VIOLATED by {}", number(excess)),
        };
        let active = found(index).map(|found| if found.multiplier == 0.0 { "no" } else { "yes" }.to_owned());
        let multiplier = found(index).map(|found| number(found.multiplier));
        std::iter::once(own.words()).chain(values).chain([kept]).chain(active).chain(multiplier).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<String>> = end.limits.iter().enumerate().map(row).collect();
    let values = if shapes.len() > 1 { vec!["start", "found"] } else { vec!["value"] };
    let costs = if report.is_some() { vec!["active", "multiplier"] } else { vec![] };
    let head = ["limit"].into_iter().chain(values).chain(["kept?"]).chain(costs);
    let words = "The multiplier of an active limit says by how much Θ would fall per unit more room.";
    let words = report.map(|_| Block::Text(words.into()));
    Section::new("Limits", std::iter::once(Block::table(head, rows)).chain(words).collect())
}

/// How the shape of a run is exported for other programs, as it is typed in a shell.
pub fn export_command(folder: &Path) -> String {
    let path = |path: &Path| quoted(path.display().to_string());
    let (scene, run) = (path(&folder.join(SCENE)), path(folder));
    format!("contact3d {scene} export --run {run} --out {}", quoted(format!("{}_export", folder.display())))
}

/// The command, the scene and what it did not need.
pub fn origin(scene: &str, left_out: &[&str]) -> Section {
    let words: Vec<String> = std::env::args_os().map(|word| quoted(word.to_string_lossy().into_owned())).collect();
    let mut blocks = vec![Block::Listing { title: "The command".into(), text: words.join(" ") }];
    if !left_out.is_empty() {
        blocks.push(Block::Text(format!("Left out, because this scene does not need it: {}.", left_out.join("; "))));
    }
    blocks
        .push(Block::Listing { title: "The scene, complete, with all options put in".into(), text: scene.to_owned() });
    Section::new("Scene", blocks)
}
