//! `look`: a scene before any solve. Bodies, names, supports, loads, contact, and what is to be looked at.

mod case;
mod faces;
mod hints;
mod space;

use crate::commands::case_facts;
use crate::commands::controls;
use crate::commands::facts::{Fact, Facts, Group};
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, json, printed_with_files};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::look::case::{LookedCase, by_case};
use crate::commands::look::faces::face_facts;
use crate::commands::look::hints::hints;
use crate::commands::numbers::number;
use crate::commands::scene_words::counted;
use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use contact::memory;
use contact::scene::Scene;
use contact::solvers::Wanted;
use figures::page::{Block, File, Page, Section};
use scene_file::Case;
use serde_json::json;

const SPACE: &str = "What acts on the faces, and the gaps of the nodes that may touch. Drag to turn the bodies; after a click, the wheel \
    zooms. The boxes show and hide faces; click a face for its name, and for number and place of the node.";

/// A scene at a shape, in all load cases.
struct Look<'a> {
    case: &'a Case,
    /// What the scene file leaves open.
    open: &'a [String],
    cases: Vec<LookedCase<'a>>,
}

/// The problems of all load cases.
fn problems(case: &Case) -> Result<Vec<ContactProblem>, SceneError> {
    case.cases.iter().map(|own| ContactProblem::new(own.scene.clone())).collect()
}

/// What acts on the faces of the bodies, and the gaps before loading, in three dimensions and as lines of a table.
///
/// # Errors
/// [`Failure`] for controls without a shape.
pub fn setup(cases: &[(&str, &ContactProblem)], controls: &[f64]) -> Result<Vec<Block>, Failure> {
    let cases = cases.iter().map(|(name, problem)| LookedCase::new(name, problem, controls));
    let cases = cases.collect::<Result<Vec<_>, _>>()?;
    let view = Block::Space { view: space::view(&cases)?, caption: SPACE.into() };
    Ok(std::iter::once(view).chain(Group::new("", face_facts(&cases)?).section().blocks).collect())
}

/// Bodies with their materials, loads, contacts and supports, a row each.
///
/// # Errors
/// [`Failure`] for controls without a shape.
pub fn acting(cases: &[(&str, &ContactProblem)], controls: &[f64]) -> Result<Vec<Vec<String>>, Failure> {
    let cases = cases.iter().map(|(name, problem)| LookedCase::new(name, problem, controls));
    Ok(faces::acting(&cases.collect::<Result<Vec<_>, _>>()?))
}

impl<'a> Look<'a> {
    /// The scene of a case at the shape of some controls.
    fn new(
        (case, open): (&'a Case, &'a [String]),
        problems: &'a [ContactProblem],
        controls: &[f64],
    ) -> Result<Self, Failure> {
        let cases = case.cases.iter().zip(problems);
        let cases = cases.map(|(own, problem)| LookedCase::new(&own.name, problem, controls));
        Ok(Self { case, open, cases: cases.collect::<Result<_, _>>()? })
    }

    fn scene(&self) -> &Scene {
        &self.case.scene
    }

    fn facts(&self) -> Result<Facts, Failure> {
        let counts = [
            counted(self.scene().bodies.len(), ["body", "bodies"]),
            counted(self.scene().contacts.len(), ["contact", "contacts"]),
            counted(self.cases.len(), ["load case", "load cases"]),
        ];
        let lead = vec![format!("{}: {}; nothing is solved", self.scene().name, counts.join(", "))];
        let (mut before, mut list) = (Vec::new(), Vec::new());
        for LookedCase { name, preview, .. } in &self.cases {
            let title = if name.is_empty() { "gaps and loads".to_owned() } else { format!("case \"{name}\"") };
            before.push(Fact::new("", &title, case_facts::before(preview), ""));
            list.push(json!({ "name": name, "before": preview }));
        }
        let needed = self.case.plans(Wanted::States).map(|plan| memory::needed(&plan)).fold(0.0, f64::max);
        before.push(Fact::new("", "memory of a state", format!("about {} MB", number((needed / 1e6).ceil())), ""));
        before.push(Fact::json("cases", &list)?);
        before.push(Fact::json("memory", &needed)?);
        let hints = by_case(&self.cases, hints);
        let missing = self.open.iter().map(|open| Fact::new("", "missing", open.clone(), ""));
        let notes = hints.iter().map(|hint| Fact::new("", "note", hint.clone(), ""));
        let lists = [Fact::json("open", &self.open)?, Fact::json("hints", &hints)?];
        let notes = missing.chain(notes).chain(lists).collect();
        let groups = vec![
            Group::new("Bodies and faces", face_facts(&self.cases)?),
            Group::new("Load cases", before),
            Group::new("To be looked at", notes),
        ];
        Ok(Facts { lead, groups })
    }

    /// The page, without the list of files.
    fn page(&self, facts: &Facts, scene: &str) -> Result<Page, Failure> {
        let view = space::view(&self.cases)?;
        let listing =
            Block::Listing { title: "The scene, complete, with all options put in".into(), text: scene.into() };
        let mut sections =
            vec![Section::new("In three dimensions", vec![Block::Space { view, caption: SPACE.into() }])];
        sections.extend(facts.groups.iter().rev().map(Group::section));
        sections.push(Section::new("Scene", vec![listing]));
        sections.retain(|section| !section.blocks.is_empty());
        let title = format!("{}: the scene before any solve", self.scene().name);
        Ok(Page { title, lead: facts.lead.join(". ") + ".", sections, ..Page::default() })
    }
}

pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let (case, arguments) = (&loaded.case, session.arguments);
    let file = ("--controls", arguments.shape.controls.as_deref());
    let problems = problems(case)?;
    let controls = controls::load(&problems[0], case, file)?;
    let look = Look::new((case, &loaded.open), &problems, controls.as_slice())?;
    let facts = look.facts()?;
    let object = json(&facts)?;
    let folder = Folder::of_command(&loaded.case, arguments)?;
    let mut text = facts.text(true);
    if folder.is_none() {
        text += "--out DIR draws it; evaluate solves it, optimize shapes it\n";
    }
    printed_with_files(arguments.printed(text, object.clone()), arguments.json, folder.as_ref(), |folder| {
        folder.write("look.json", &object)?;
        let mut page = look.page(&facts, &loaded.file.print()?)?;
        let what = "everything that look knows, as one JSON object";
        let files = Block::Files(vec![File { path: "look.json".into(), what: what.into() }]);
        page.sections.push(Section::new("Files", vec![files]));
        folder.write("report.html", page.html())
    })
}

/// The page on a scene before any solve, as HTML; `scene`: its text.
///
/// # Errors
/// [`Failure::Input`] for a scene that cannot be computed.
pub fn page(case: &Case, scene: &str) -> Result<String, Failure> {
    let problems = problems(case)?;
    let look = Look::new((case, &[]), &problems, &case.start_controls())?;
    Ok(look.page(&look.facts()?, scene)?.html())
}
