//! `look`: a scene before any solve. Bodies, names, supports, loads, contact, and what is to be looked at.

mod faces;
mod hints;
mod space;

use crate::commands::case_facts;
use crate::commands::controls;
use crate::commands::facts::{Fact, Facts, Group};
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, json, printed_with_files};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::look::faces::face_facts;
use crate::commands::look::hints::hints;
use crate::commands::numbers::number;
use crate::commands::report::{FIGURES, sketch};
use contact::equilibrium::{ContactProblem, Positions};
use contact::memory;
use contact::solvers::Wanted;
use figures::page::{Block, File, Page, Section};
use scene_file::Case;
use serde_json::json;
use std::path::Path;

const SKETCH: &str = "Triangles stand on faces whose displacements are held, arrows on faces that carry a load; the letters lead to the \
    list, which names face, direction and size.";
const SPACE: &str = "What acts on the faces, and the gaps of the nodes that may touch. Drag to turn the bodies; after a click, the wheel \
    zooms. The boxes show and hide faces; click a face for its name, and for number and place of the node.";

/// A scene at a shape, in all load cases.
struct Look<'a> {
    case: &'a Case,
    /// Names of the load cases with their problems; the name is empty where there is only one.
    cases: Vec<(String, ContactProblem)>,
    controls: Vec<f64>,
    positions: Positions,
}

impl<'a> Look<'a> {
    fn new(case: &'a Case, controls: Option<&Path>) -> Result<Self, Failure> {
        let problem = |own: &scene_file::CaseScene| Ok((own.name.clone(), ContactProblem::new(own.scene.clone())?));
        let cases = case.cases.iter().map(problem).collect::<Result<Vec<_>, Failure>>()?;
        let problem = &cases[0].1;
        let controls = controls::load(problem, case, ("--controls", controls))?;
        let positions = problem.positions(controls.as_slice()).map_err(Failure::computation)?;
        Ok(Self { case, controls: controls.as_slice().to_vec(), positions, cases })
    }

    fn problem(&self) -> &ContactProblem {
        &self.cases[0].1
    }

    fn facts(&self) -> Result<Facts, Failure> {
        let scene = &self.problem().scene;
        let bodies = if scene.bodies.len() == 1 { "1 body".into() } else { format!("{} bodies", scene.bodies.len()) };
        let cases =
            if self.cases.len() == 1 { "1 load case".into() } else { format!("{} load cases", self.cases.len()) };
        let lead =
            vec![format!("{}: {bodies}, {}, {cases}; nothing is solved", scene.name, contacts(scene.contacts.len()))];
        let mut before = Vec::new();
        let mut list = Vec::new();
        for (name, problem) in &self.cases {
            let preview = problem.preview();
            let title = if name.is_empty() { "start".to_owned() } else { format!("case \"{name}\"") };
            before.push(Fact::new("", &title, case_facts::before(&preview), ""));
            list.push(json!({ "name": name, "before": preview }));
        }
        let needed = self.case.plans(Wanted::States).map(|plan| memory::needed(&plan)).fold(0.0, f64::max);
        before.push(Fact::new("", "memory of a state", format!("about {} MB", number((needed / 1e6).ceil())), ""));
        before.push(Fact::json("cases", &list)?);
        before.push(Fact::json("memory", &needed)?);
        let hints = hints(&self.cases);
        let notes =
            hints.iter().map(|hint| Fact::new("", "note", hint.clone(), "")).chain([Fact::json("hints", &hints)?]);
        let groups = vec![
            Group::new("Bodies and faces", face_facts(&self.cases, &self.positions)?),
            Group::new("Load cases", before),
            Group::new("To be looked at", notes.collect()),
        ];
        Ok(Facts { lead, groups })
    }

    /// The page, without the list of files.
    fn page(&self, facts: &Facts, scene: &str) -> Result<Page, Failure> {
        let view = space::view(&self.cases, &self.positions)?;
        let figure = sketch(self.problem(), &self.controls)?;
        let listing =
            Block::Listing { title: "The scene, complete, with all options put in".into(), text: scene.into() };
        let mut sections = vec![
            Section::new("In three dimensions", vec![Block::Space { view, caption: SPACE.into() }]),
            Section::new("Supports and loads", vec![Block::Picture { figure, caption: SKETCH.into() }]),
        ];
        sections.extend(facts.groups.iter().rev().map(Group::section));
        sections.push(Section::new("Scene", vec![listing]));
        sections.retain(|section| !section.blocks.is_empty());
        let title = format!("{}: the scene before any solve", self.problem().scene.name);
        Ok(Page { title, lead: facts.lead.join(". ") + ".", sections, ..Page::default() })
    }
}

fn contacts(count: usize) -> String {
    if count == 1 { "1 contact".into() } else { format!("{count} contacts") }
}

pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let arguments = session.arguments;
    let look = Look::new(&loaded.case, arguments.shape.controls.as_deref())?;
    let facts = look.facts()?;
    let object = json(&facts)?;
    let folder = Folder::of_command(&loaded.case, arguments)?;
    let mut text = facts.text(true);
    if folder.is_none() {
        text += "--out DIR draws it; evaluate solves it, optimize shapes it\n";
    }
    printed_with_files(arguments.printed(text, object.clone()), arguments.json, folder.as_ref(), |folder| {
        folder.write("look.json", &object)?;
        folder.within(FIGURES)?.draw(&sketch(look.problem(), &look.controls)?)?;
        let mut page = look.page(&facts, &loaded.file.print()?)?;
        let file = |path: &str, what: &str| File { path: path.into(), what: what.into() };
        let files = vec![
            file("look.json", "everything that look knows, as one JSON object"),
            file(&format!("{FIGURES}/sketch.svg"), "bodies, supports and loads"),
        ];
        page.sections.push(Section::new("Files", vec![Block::Files(files)]));
        folder.write("report.html", page.html())
    })
}

/// The page on a scene before any solve, as HTML; `scene`: its text.
///
/// # Errors
/// [`Failure::Input`] for a scene that cannot be computed.
pub fn page(case: &Case, scene: &str) -> Result<String, Failure> {
    let look = Look::new(case, None)?;
    Ok(look.page(&look.facts()?, scene)?.html())
}
