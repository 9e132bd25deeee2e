//! The page for the one who decides: part, loads, gain, limits, amounts to remove, form error, what was assumed and
//! what was not checked, on one sheet.

use crate::commands::export::change::{self, ChangedFace};
use crate::commands::facts::{Fact, Facts, Group};
use crate::commands::failure::Failure;
use crate::commands::loaded_scene::LoadedScene;
use crate::commands::look::acting;
use crate::commands::numbers::{raised, rounded};
use crate::commands::optimize::summary::{Ended, all_warnings};
use crate::commands::report::contact_surface::ContactSurface;
use crate::commands::report::pages::what;
use crate::commands::report::sections::{export_command, found_label, limits};
use crate::commands::report::stamp::stamp;
use crate::commands::shape_facts;
use crate::commands::tolerance::form_error;
use contact::equilibrium::ContactProblem;
use contact::scene::ContactScene;
use figures::page::{Block, Section};
use figures::{ColourScales, Map, MapPanel, PaperPage};
use scene_file::optimization::Part;
use std::collections::HashMap;
use std::path::Path;

/// Rows of a table, and of a list: a sheet holds as many.
const MAX_ROWS: usize = 6;
/// Rows of the table of the part.
const MAX_PART_ROWS: usize = 10;
/// Warnings that a sheet has room for.
const MAX_WARNINGS: usize = 3;
/// Pictures of the change that a sheet has room for.
const MAX_PICTURES: usize = 2;
/// Characters of a cell: loads of many cases are long.
const MAX_CELL: usize = 240;

/// The page of an optimization.
///
/// # Errors
/// [`Failure`] of the shape found, and of a picture.
pub fn page(loaded: &LoadedScene, ended: &Ended<'_>, facts: &Facts, folder: &Path) -> Result<String, Failure> {
    let objective = &ended.last.stage.objective;
    let (problem, controls) = (objective.solver().problem(), ended.shapes[1].controls.as_slice());
    let cases = objective.cases();
    let problems = (0..cases.count()).map(|case| (cases.name(case), cases.case(case).problem())).collect::<Vec<_>>();
    let warnings: Vec<String> =
        all_warnings(&ended.last.report, ended.checks).iter().map(ToString::to_string).collect();
    let mut kept_limits = limits(&ended.shapes.each_ref(), None);
    kept_limits.blocks.iter_mut().for_each(|block| shorten(block, MAX_ROWS));
    let mut columns = vec![part(acting(&problems, controls)?), changes(problem, controls, folder)?];
    columns.push(form_error::short_section(folder, controls));
    columns.extend([assumed(loaded, problem), not_checked(loaded, ended)]);
    let mut wide = vec![gain(ended), kept_limits];
    wide.retain(|section| !section.blocks.is_empty());
    let page = PaperPage {
        title: format!("{}: {}", problem.scene.name, what(ended)),
        lead: facts.lead.join(". ") + ".",
        origin: stamp(),
        more: ("report.html".into(), "All numbers and pictures: report.html".into()),
        warnings: cut(warnings, MAX_WARNINGS),
        wide,
        columns,
    };
    Ok(page.html())
}

/// The first of some lines, and how many more there are.
fn cut(mut lines: Vec<String>, most: usize) -> Vec<String> {
    if lines.len() > most {
        let more = lines.len() - most + 1;
        lines.truncate(most - 1);
        lines.push(format!("and {more} more in report.html"));
    }
    lines
}

/// Cuts the rows of a table, and texts in them, to what a sheet holds.
fn shorten(block: &mut Block, most: usize) {
    let Block::Table { rows, .. } = block else { return };
    if rows.len() > most {
        let more = rows.len() - most + 1;
        rows.truncate(most - 1);
        rows.push(vec![format!("and {more} more in report.html")]);
    }
    for cell in rows.iter_mut().flatten().filter(|cell| cell.chars().count() > MAX_CELL) {
        *cell = cell.chars().take(MAX_CELL).collect::<String>() + " … (all in report.html)";
    }
}

/// Peak pressures and objective at the start and for the shape found.
fn gain(ended: &Ended<'_>) -> Section {
    let (objective, shapes) = (&ended.last.stage.objective, ended.shapes.each_ref());
    let cases = objective.cases();
    let mut facts = vec![shape_facts::peak_pressure(&shapes)];
    for case in (0..cases.count()).filter(|_| cases.count() > 1) {
        let name = format!("peak contact pressure in case \"{}\"", cases.name(case));
        facts.push(Fact::row("", &name, shapes.map(|shape| shape.peak_of(objective, case).into()).to_vec(), "MPa"));
    }
    facts.extend(shape_facts::objective(objective, &shapes));
    let reported = |(index, (report, _)): (usize, &(contact::cost::Reported, f64))| {
        let values = shapes.map(|shape| shape.reports[index].1.into()).to_vec();
        Fact::row("", &report.title(), values, &raised(&report.quantity.unit()))
    };
    facts.extend(shapes[1].reports.iter().enumerate().map(reported));
    let columns = vec!["start".to_owned(), found_label(&ended.last.report).to_owned()];
    let mut section = Group { title: "What was gained", columns, facts, words: String::new() }.section();
    section.blocks.truncate(1);
    section.blocks.iter_mut().for_each(|block| shorten(block, MAX_ROWS));
    section
}

/// The part with its materials, supports, contacts and loads.
fn part(rows: Vec<Vec<String>>) -> Section {
    let mut table = Block::table(["body or face", "material, load, contact, support"], rows);
    shorten(&mut table, MAX_PART_ROWS);
    Section::new("Part and loads", vec![table])
}

/// What is to be removed and added, with pictures.
fn changes(problem: &ContactProblem, controls: &[f64], folder: &Path) -> Result<Section, Failure> {
    let changed = change::changed_faces(problem, controls);
    let most = change::largest(&changed).map(|(amount, names)| {
        let face = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
        format!("{} mm{face}", rounded(amount, 3))
    });
    let [removed, added] = most;
    let words = format!(
        "From the start, along its normals: at most {removed} to remove, {added} to add. The table of all points: {}",
        export_command(folder)
    );
    let mut blocks = vec![Block::Text(words)];
    for surface in ContactSurface::shaped(problem).iter().take(MAX_PICTURES) {
        if problem.map.shapes(surface.body) {
            blocks.push(picture(problem, surface, &changed)?);
        }
    }
    Ok(Section::new("Amounts to remove", blocks))
}

/// The amounts over a surface.
fn picture(problem: &ContactProblem, surface: &ContactSurface, changed: &[ChangedFace]) -> Result<Block, Failure> {
    let own = changed.iter().filter(|face| face.body == surface.body && face.names.contains(&surface.face));
    let amounts: HashMap<u32, f64> = own.flat_map(|face| &face.nodes).map(|node| (node.node, node.amount)).collect();
    let amount = |node: &u32| amounts.get(node).copied().unwrap_or(0.0);
    let figure = Map {
        name: format!("amounts{}", surface.suffix),
        title: format!("{}: to remove from {}", problem.scene.name, surface.face),
        quantity: "to remove (negative: to add)".into(),
        unit: "mm".into(),
        axes: surface.axis_names(),
        scales: ColourScales::Own,
        contours: true,
        panels: vec![MapPanel {
            caption: surface.owner.clone(),
            points: surface.plan(),
            faces: surface.faces(),
            values: surface.nodes().iter().map(amount).collect(),
        }],
    };
    let caption = "Seen along the mean normal; negative amounts are added.".into();
    Ok(Block::Picture { figure: figure.figure().map_err(Failure::computation)?, caption })
}

/// What the numbers hold for.
fn assumed(loaded: &LoadedScene, problem: &ContactProblem) -> Section {
    let contacts = &problem.scene.contacts;
    let mut lines = vec![
        "Isotropic linear elasticity with the constants above; small strains and rotations; no temperature, no residual \
         stresses, no wear."
            .to_owned(),
        "Static loads; supports and the places of loads do not yield.".to_owned(),
    ];
    if loaded.case.cases.len() > 1 {
        lines.push("Load cases are independent: each begins with bodies at rest.".into());
    }
    lines.push(match problem.boundary.has_friction() {
        true => "Coulomb friction with constant coefficients; the load is applied in one step.".into(),
        false => "Contact without friction.".into(),
    });
    if contacts.iter().any(|contact| contact.obstacle().is_some()) {
        lines.push("Obstacles are rigid and have the form that the scene gives them.".into());
    }
    if contacts.iter().any(ContactScene::is_tied) {
        lines.push("Glued faces do not part.".into());
    }
    Section::new("What was assumed", vec![Block::List(lines)])
}

/// What the numbers do not say.
fn not_checked(loaded: &LoadedScene, ended: &Ended<'_>) -> Section {
    let meshes = ended.runs.ended.iter().filter(|run| matches!(run.stage.label.part, Part::Mesh(_))).count();
    let mesh = match meshes {
        0 | 1 => "The error of the mesh: the shape was computed on one mesh.".to_owned(),
        count => format!("The error of the last of {count} meshes."),
    };
    let verdict = match ended.last.report.is_confirmed() {
        true => "Whether a shape far from this one is better: only stationarity is confirmed.",
        false => "Whether the shape can still be improved: the run ended unconfirmed.",
    };
    let limited = match loaded.case.limits.is_empty() {
        true => "Strength and fatigue: no quantity is limited.",
        false => "Strength and fatigue beyond the limits above.",
    };
    let mut lines = vec![limited.to_owned(), mesh, verdict.to_owned(), "Other loads than those above.".to_owned()];
    let no_checks = ended.left_out.iter().any(|words| words.contains("--no-checks"));
    let unique = match no_checks {
        true => "Uniqueness of the contact state and the limits of linear elasticity (--no-checks).",
        false => "Uniqueness of the contact state: it is estimated; doubts stand among the warnings.",
    };
    lines.push(unique.to_owned());
    Section::new("What was not checked", vec![Block::List(lines)])
}
