//! The HTML report of each command, without the sections on its scene and its files.

use crate::commands::compare::comparison::Comparison;
use crate::commands::facts::{Facts, Group};
use crate::commands::folder::SUMMARY;
use crate::commands::numbers::{number, rounded};
use crate::commands::optimize::summary::Ended;
use crate::commands::report::folder::Parts;
use crate::commands::report::sections::{export_command, limits, pictures};
use crate::commands::scene_words::{friction, mesh};
use crate::commands::shape_facts::{self, is_better};
use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use crate::commands::tolerance::form_error;
use contact::equilibrium::StageSeconds;
use contact::scene::{self, BodyScene};
use contact::shape::LatticeShape;
use figures::page::{Block, File, Page, Section};
use std::path::Path;

/// The report of an optimization.
pub fn optimization(parts: Parts, ended: &Ended<'_>, facts: &Facts, folder: &Path) -> Page {
    let (objective, shapes) = (&ended.last.stage.objective, ended.shapes);
    let what = what(ended);
    let limits = limits(&shapes.each_ref(), Some(&ended.last.report));
    let paper = File { path: SUMMARY.into(), what: "one page to print, for the one who decides".into() };
    let summary = Section::new("Summary", vec![Block::Files(vec![paper])]);
    let mut sections = vec![summary, limits, parts.numbers, parts.space, parts.setup, pictures(parts.pictures)];
    sections.extend(facts.groups.iter().filter(|group| !group.title.is_empty()).map(Group::section));
    let command =
        Block::Listing { title: "The command that writes STL, STEP and CSV".into(), text: export_command(folder) };
    sections.extend(controls(objective, shapes[1].controls.as_slice()));
    sections.extend([Section::new("Export", vec![command]), seconds(&shapes[1])]);
    sections.push(form_error::section(folder, shapes[1].controls.as_slice()));
    page(objective, &what, facts.lead.join(". ") + ".", sections)
}

/// What an optimization has found, in words.
pub fn what(ended: &Ended<'_>) -> String {
    let shapes = ended.shapes;
    let verdict = if ended.last.report.is_confirmed() { "confirmed" } else { "not confirmed" };
    match (shapes[1].keeps_limits(), is_better(shapes[0].value, shapes[1].value)) {
        (false, _) => "a shape outside the limits".to_owned(),
        (true, true) => format!("optimized shape, {verdict}"),
        // A start outside the limits may be better, but does not count.
        (true, false) if !shapes[0].keeps_limits() => format!("a shape within the limits, {verdict}"),
        (true, false) => format!("no better shape was found, {verdict}"),
    }
}

/// The report of an evaluation.
pub fn evaluation(parts: Parts, objective: &ContactObjective, shape: &SolvedShape, facts: &Facts) -> Page {
    let mut sections = vec![limits(&[shape], None), parts.numbers, parts.space, parts.setup, pictures(parts.pictures)];
    sections.extend(facts.groups.iter().filter(|group| !group.title.is_empty()).map(Group::section));
    sections.extend(controls(objective, shape.controls.as_slice()));
    sections.push(seconds(shape));
    page(objective, "one shape", facts.lead.join(". ") + ".", sections)
}

/// The report of a comparison with and without friction.
pub fn comparison(parts: Parts, comparison: &Comparison<'_>, facts: &Facts) -> Page {
    let objective = &comparison.runs[0].stage.objective;
    let confirmed = comparison.runs.iter().all(|run| run.report.is_confirmed());
    let caveat = if confirmed { "" } else { " Not both runs ended confirmed." };
    let lead = facts.lead.first().cloned().unwrap_or_default() + caveat;
    let mut table = facts.groups[0].section();
    table.blocks.push(Block::List(facts.lead.clone()));
    let both =
        [("optimized with friction", &comparison.own[0][1]), ("optimized without friction", &comparison.crossed[0])];
    let shapes = both.map(|(_, shape)| shape);
    let with_friction = Group {
        title: "Both shapes with friction",
        columns: both.map(|(label, _)| label.to_owned()).into(),
        facts: shape_facts::states(objective, &shapes, ["", ""]),
        words: String::new(),
    };
    let sections =
        vec![table, parts.numbers, parts.space, parts.setup, pictures(parts.pictures), with_friction.section()];
    page(objective, "with and without friction", lead, sections)
}

fn page(objective: &ContactObjective, what: &str, lead: String, sections: Vec<Section>) -> Page {
    let scene = &objective.solver().problem().scene;
    let (bodies, mesh, friction) = (scene.bodies.len(), mesh(scene), friction(scene));
    let title = format!("{}: {what} ({bodies} × {mesh}, friction {friction})", scene.name);
    Page { title, lead, sections, ..Page::default() }
}

/// The controls of all bodies with their places, a section each.
fn controls(objective: &ContactObjective, controls: &[f64]) -> Vec<Section> {
    let scene = &objective.solver().problem().scene;
    let shaped = || scene.bodies.iter().filter_map(|body| Some((body, body.shape.as_ref()?)));
    let (several, mut rest) = (shaped().count() > 1, controls);
    let section = |(body, shape): (&BodyScene, &LatticeShape)| {
        let own;
        (own, rest) = rest.split_at(shape.control_count().min(rest.len()));
        let of_body = if several { format!(" of {}", body.name) } else { String::new() };
        match (body.block(), body.heights()) {
            (Some(block), Some(shape)) => heights(shape, block, &of_body, own),
            _ => {
                let rows = shape.control_names(body.start_block().as_ref()).into_iter().zip(own);
                let rows = rows.map(|(name, value)| vec![name, number(*value)]).collect::<Vec<_>>();
                let table = Block::table(["control", "displacement, mm"], rows);
                Section::new(&format!("Displacements of the control points{of_body}"), vec![table])
            }
        }
    };
    shaped().map(section).collect()
}

/// Control heights with their places: a row per control point along x₁.
fn heights(shape: &LatticeShape, block: &scene::Block, of_body: &str, heights: &[f64]) -> Section {
    let Ok(surface) = shape.surface() else { return Section::default() };
    let mut places = surface.control_places(block.size);
    for (places, corner) in places.iter_mut().zip(block.corner) {
        places.iter_mut().for_each(|place| *place += corner);
    }
    let [across, along] = places;
    let head = std::iter::once("x₁, mm \\ x₂, mm".to_owned()).chain(along.iter().map(|x2| number(*x2)));
    let rows = heights
        .chunks(along.len())
        .zip(&across)
        .map(|(line, x1)| std::iter::once(x1).chain(line).map(|length| number(*length)).collect::<Vec<String>>());
    let words = "Heights of the control points, mm, at their places x₁ (rows) and x₂ (columns). The surface follows the control points; it \
                 passes through those at its corners.";
    let table = Block::table(head, rows.collect::<Vec<_>>());
    Section::new(&format!("Control heights{of_body}"), vec![table, Block::Text(words.into())])
}

/// Seconds of the parts of one state; empty for a solver that does not keep them.
fn seconds(shape: &SolvedShape) -> Section {
    let Some(stages) = shape.state().stages else { return Section::default() };
    let StageSeconds { equilibrium, factorization, coarse_space, newton, recovery } = stages;
    let stages = [
        ("equilibrium", equilibrium),
        ("factorization", factorization),
        ("coarse space", coarse_space),
        ("contact", newton),
        ("recovery", recovery),
    ];
    let total: f64 = stages.iter().map(|(_, seconds)| seconds).sum();
    let row = |(name, seconds): (&str, f64)| {
        vec![name.to_owned(), number(seconds), format!("{} %", rounded(100.0 * seconds / total, 2))]
    };
    let rows: Vec<Vec<String>> = stages.into_iter().map(row).collect();
    let words = "Wall-clock seconds of the last state, solved from nothing.";
    Section::new(
        "Time of one state",
        vec![Block::table(["stage", "seconds", "share"], rows), Block::Text(words.into())],
    )
}
