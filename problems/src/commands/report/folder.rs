//! The folder of a report while it is filled: its files with what they hold, and the parts of the page so far.

use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, REPORT, SCENE, START, json};
use crate::commands::loaded_scene::LoadedScene;
use crate::commands::long_run::RunFolder;
use crate::commands::look::setup;
use crate::commands::register::{JOURNAL, REGISTER};
use crate::commands::report::bodies::Relief;
use crate::commands::report::contact_surface::ContactSurface;
use crate::commands::report::gallery::ShownShape;
use crate::commands::report::key_numbers::{self, key_numbers};
use crate::commands::report::space::space;
use crate::commands::report::stamp::stamp;
use crate::commands::report::{bodies, captions, gallery, sections, tables};
use crate::commands::run_kind::RUN;
use crate::commands::solved_shape::{ContactObjective, SolvedShape, objective_note};
use crate::vtk_files::{FieldState, vtk_files};
use contact::plausibility::Warning;
use exchange::vtk::Note;
use figures::page::{Block, File, Page, Section};
use figures::{ColourScales, Figure};
use scene_file::OutputSection;

/// Folder of the figures.
pub const FIGURES: &str = "figures";
/// Folder of the files for ParaView.
pub const VTK: &str = "vtk";
/// Opens the files for ParaView with a good view.
const VIEW: &str = include_str!("view.py");

pub struct ReportFolder<'a> {
    folder: &'a Folder,
    loaded: &'a LoadedScene,
    objective: &'a ContactObjective,
    files: Vec<File>,
    parts: Parts,
}

/// Parts of the page that are made with the files.
#[derive(Debug, Default)]
pub struct Parts {
    /// The key numbers of shapes.
    pub numbers: Section,
    /// The shapes in three dimensions.
    pub space: Section,
    /// What holds and loads the bodies, at the first shape.
    pub setup: Section,
    /// The pictures with their captions.
    pub pictures: Vec<Block>,
}

impl<'a> ReportFolder<'a> {
    /// A folder in which nothing of the report is written yet.
    pub fn new(folder: &'a Folder, loaded: &'a LoadedScene, objective: &'a ContactObjective) -> Self {
        Self { folder, loaded, objective, files: vec![], parts: Parts::default() }
    }

    /// What is to be written.
    pub fn wanted(&self) -> &'a OutputSection {
        &self.loaded.case.output
    }

    /// Says that the folder holds a file at the end, by its path.
    pub fn announce(&mut self, path: &str, what: &str) {
        self.files.push(File { path: path.to_owned(), what: what.to_owned() });
    }

    /// Writes a file.
    pub fn write(&mut self, name: &str, text: &str, what: &'static str) -> Result<(), Failure> {
        self.announce(name, what);
        self.folder.write(name, text)
    }

    /// Writes a figure; the page will show it.
    pub fn draw(&mut self, figure: Figure, what: &str, caption: &str) -> Result<(), Failure> {
        self.keep(&figure, what)?;
        self.parts.pictures.push(Block::Picture { figure, caption: caption.into() });
        Ok(())
    }

    fn keep(&mut self, figure: &Figure, what: &str) -> Result<(), Failure> {
        self.announce(&format!("{FIGURES}/{}.svg", figure.name), what);
        self.folder.within(FIGURES)?.draw(figure)
    }

    /// Solved shapes, each with the beginning of its files' names and what it is called: the contact boundary as
    /// tables, fields for ParaView, figures, and their key numbers.
    pub fn show(&mut self, solved: &[(&'static str, &'static str, &SolvedShape)]) -> Result<(), Failure> {
        let cases = 0..self.objective.cases().count();
        let pairs = solved.iter().flat_map(|shape| cases.clone().map(move |case| (shape, case)));
        let shown = |(&(name, label, shape), case)| {
            ShownShape::new(self.objective, (name, label), (shape, case), self.wanted())
        };
        let shapes = pairs.map(shown).collect::<Result<Vec<_>, _>>()?;
        if self.wanted().report {
            let numbers = key_numbers(self.objective, &shapes);
            self.write("key_numbers.json", &json(&numbers.table())?, "the table of the result")?;
            self.parts.numbers = key_numbers::section(self.objective, &shapes);
            let labels: Vec<&str> = solved.iter().map(|(_, label, _)| *label).collect();
            if let Some(view) = space(self.objective, &labels, &shapes)? {
                let block = Block::Space { view, caption: captions::SPACE.into() };
                self.parts.space = Section::new("In three dimensions", vec![block]);
            }
            let all = self.objective.cases();
            let problems = (0..all.count()).map(|case| (all.name(case), all.case(case).problem())).collect::<Vec<_>>();
            let first = solved.first().map(|(.., shape)| shape.controls.as_slice());
            let blocks = first.map(|controls| setup(&problems, controls)).transpose()?;
            self.parts.setup = Section::new("Supports and loads", blocks.unwrap_or_default());
        }
        for shape in &shapes {
            let what = "pressure, traction, remaining gap and status of every contact node";
            let table = tables::contact_nodes(self.objective, shape.solved.controls.as_slice(), shape.state());
            self.write(&format!("pressure_{}.csv", shape.name), &table, what)?;
        }
        if self.wanted().vtk {
            self.write_fields(&shapes)?;
        }
        if self.wanted().pictures { self.draw_shapes(&shapes) } else { Ok(()) }
    }

    /// The figures of some shapes.
    fn draw_shapes(&mut self, shapes: &[ShownShape<'_>]) -> Result<(), Failure> {
        let objective = self.objective;
        let surfaces = ContactSurface::all(objective.solver().problem());
        surfaces.iter().try_for_each(|surface| self.draw_pressure(surface, shapes))?;
        let friction = objective.solver().problem().boundary.has_friction();
        let (what, status) = match friction {
            true => ("open, stick and slip, with the friction traction", captions::STATUS),
            false => ("open and closed contact nodes", captions::STATUS_WITHOUT_FRICTION),
        };
        let mut figures = Vec::new();
        let cuts = "contact pressure along lines through the peaks";
        figures
            .extend(surfaces.iter().map(|surface| (gallery::cuts(objective, surface, shapes), cuts, captions::CUTS)));
        figures.extend(surfaces.iter().map(|surface| (gallery::status(objective, surface, shapes), what, status)));
        for relief in Relief::all(objective.solver().problem()) {
            let above = "the shape of the contact surface from above";
            figures.push((bodies::surface_map(objective, &relief, shapes), above, captions::SURFACE_MAP));
        }
        figures
            .into_iter()
            .try_for_each(|(figure, what, caption)| self.draw(figure.map_err(Failure::computation)?, what, caption))
    }

    /// The contact pressures of some shapes on a surface.
    fn draw_pressure(&mut self, surface: &ContactSurface, shapes: &[ShownShape<'_>]) -> Result<(), Failure> {
        let figure = |scales| gallery::pressure(self.objective, surface, shapes, scales).map_err(Failure::computation);
        let common = figure(ColourScales::Common)?;
        if shapes.len() == 1 {
            return self.draw(common, "contact pressure", captions::PRESSURE_ALONE);
        }
        let own = figure(ColourScales::Own)?;
        self.keep(&common, "contact pressure on one scale")?;
        self.keep(&own, "contact pressure, each on its own scale")?;
        let figures = [("one scale".to_owned(), common), ("each on its own scale".to_owned(), own)];
        let caption = captions::PRESSURE.into();
        self.parts.pictures.push(Block::Choice { figures: Box::new(figures), caption });
        Ok(())
    }

    /// Fields of shapes for ParaView.
    fn write_fields(&mut self, shapes: &[ShownShape<'_>]) -> Result<(), Failure> {
        let notes: Vec<[Note; 1]> =
            shapes.iter().map(|shape| [objective_note(self.objective, shape.solved.value)]).collect();
        let mut states = Vec::new();
        for (index, (shape, notes)) in shapes.iter().zip(&notes).enumerate() {
            let fields = shape.fields.iter();
            states.extend(fields.map(|fields| FieldState { time: index as f64, name: &shape.name, fields, notes }));
        }
        let folder = self.folder.within(VTK)?;
        for (name, text) in vtk_files(&states).map_err(Failure::computation)? {
            let what = match name.ends_with(".pvd") {
                true => "all fields in time: open it with ParaView",
                false => "displacements, stresses or contact fields of one shape",
            };
            folder.write(&name, &text)?;
            self.announce(&format!("{VTK}/{name}"), what);
        }
        folder.write("view.py", VIEW)?;
        self.announce(&format!("{VTK}/view.py"), "opens them in ParaView with a good view: paraview --script=view.py");
        Ok(())
    }

    /// Writes the page if it is wanted; sections on the scene, the versions and all files are added to it.
    pub fn finish(mut self, page: impl FnOnce(Parts) -> Page, warnings: &[Warning]) -> Result<(), Failure> {
        if !self.wanted().report {
            return Ok(());
        }
        if RunFolder::is_one(self.folder.path()) {
            self.announce("report.txt", "the page of text");
            self.announce(REPORT, "the same as one JSON object");
        }
        for name in self.folder.names() {
            if [SCENE, START, RUN].contains(&name.as_str()) || name.ends_with(JOURNAL) {
                self.announce(&name, "the run itself, for --resume; restart data lie beside it");
            }
        }
        self.announce(REGISTER, "the list of all files that the program wrote here");
        let (scene, left_out) = (self.loaded.file.print()?, self.objective.solver().left_out());
        let mut page = page(self.parts);
        page.origin = stamp();
        page.warnings = warnings.iter().map(Warning::to_string).collect();
        page.sections.push(sections::origin(&scene, &left_out));
        page.sections.push(Section::new("Files", vec![Block::Files(self.files)]));
        page.sections.retain(|section| !section.blocks.is_empty());
        self.folder.write("report.html", page.html())
    }
}
