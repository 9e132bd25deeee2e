//! The files of each command. None of them is computed unless a folder is asked for.

use crate::commands::compare::comparison::Comparison;
use crate::commands::contact_objective::{ContactObjective, SolvedShape};
use crate::commands::failure::Failure;
use crate::commands::folder::{COMPARED, Folder, PICTURE_ENDINGS, json};
use crate::commands::loaded_scene::LoadedScene;
use crate::commands::long_run::RunFolder;
use crate::commands::optimize::mesh_run::MeshRun;
use crate::commands::optimize::summary::all_warnings;
use crate::commands::report::gallery::ShownShape;
use crate::commands::report::{gallery, pages, sections, tables};
use contact::fields::{FieldState, vtk_files};
use contact::plausibility::Warning;
use figures::page::Page;
use figures::{Figure, FigureError};
use scene_file::OutputSection;

/// Folder of the figures.
const FIGURES: &str = "figures";
/// Folder of the files for ParaView.
pub const VTK: &str = "vtk";
/// Opens the files for ParaView with a good view.
const VIEW: &str = include_str!("view.py");

/// The folder of a report, with the list of its files and figures so far.
struct ReportFolder<'a> {
    folder: &'a Folder,
    loaded: &'a LoadedScene,
    objective: &'a ContactObjective,
    /// Names of the files, and what they hold.
    files: Vec<(String, &'static str)>,
    figures: Vec<Figure>,
}

impl<'a> ReportFolder<'a> {
    fn new(folder: &'a Folder, loaded: &'a LoadedScene, objective: &'a ContactObjective) -> Self {
        Self { folder, loaded, objective, files: vec![], figures: vec![] }
    }

    fn wanted(&self) -> &'a OutputSection {
        &self.loaded.case.output
    }

    fn write(&mut self, name: &str, text: &str, what: &'static str) -> Result<(), Failure> {
        self.files.push((name.to_owned(), what));
        self.folder.write(name, text)
    }

    /// Writes a figure; the page will show it.
    fn draw(&mut self, figure: Result<Figure, FigureError>, what: &'static str) -> Result<(), Failure> {
        let figure = figure.map_err(Failure::computation)?;
        self.folder.within(FIGURES)?.draw(&figure)?;
        self.files.push((format!("{FIGURES}/{}{PICTURE_ENDINGS}", figure.name), what));
        self.figures.push(figure);
        Ok(())
    }

    /// Solved shapes, each with the beginning of its files' names and of its caption: the contact boundary as tables, fields for
    /// ParaView, and figures of pressure, stress and surface.
    fn show(&mut self, solved: &[(&'static str, &str, &SolvedShape)]) -> Result<(), Failure> {
        let shown = |&(name, words, shape)| ShownShape::new(self.objective, name, words, shape, self.wanted());
        let shapes = solved.iter().map(shown).collect::<Result<Vec<_>, _>>()?;
        for shape in &shapes {
            let what = "pressure, traction, remaining gap and status of every contact node";
            let table = tables::contact_nodes(self.objective, &shape.solved.state);
            self.write(&format!("pressure_{}.csv", shape.name), &table, what)?;
        }
        if self.wanted().vtk {
            self.write_fields(&shapes)?;
        }
        if self.wanted().pictures {
            self.draw(gallery::pressure(self.objective, &shapes), "contact pressure on one scale")?;
            let stress = gallery::von_mises(self.objective, &shapes);
            self.draw(stress, "von Mises stress on the deformed bodies, on one scale")?;
            self.draw(gallery::surfaces(self.objective, &shapes), "heights of the contact surface on one scale")?;
        }
        Ok(())
    }

    /// Fields of shapes for ParaView.
    fn write_fields(&mut self, shapes: &[ShownShape<'_>]) -> Result<(), Failure> {
        let mut states = Vec::new();
        for (index, shape) in shapes.iter().enumerate() {
            let fields = shape.fields.iter();
            states.extend(fields.map(|fields| FieldState { time: index as f64, name: shape.name, fields, notes: &[] }));
        }
        let folder = self.folder.within(VTK)?;
        for (name, text) in vtk_files(&states).map_err(Failure::computation)? {
            folder.write(&name, &text)?;
        }
        folder.write("view.py", VIEW)?;
        self.files
            .push((format!("{VTK}/view.py"), "opens them in ParaView with a good view: paraview --script=view.py"));
        let what = "displacements, stresses and contact fields: open fields.pvd with ParaView";
        self.files.push((format!("{VTK}/fields.pvd, *.vtu"), what));
        Ok(())
    }

    /// Writes the page if it is wanted; sections on the scene, the versions and all files are added to it.
    fn finish(mut self, page: impl FnOnce(&[Figure]) -> Page, warnings: &[Warning]) -> Result<(), Failure> {
        if !self.wanted().report {
            return Ok(());
        }
        if RunFolder::is_one(self.folder.path()) {
            self.files.push(("report.txt, report.json".into(), "the page of text, and the same as one JSON object"));
            self.files.push(("scene.toml, start.json, journal.jsonl, …".into(), "the run itself, for --resume"));
        }
        let (scene, left_out) = (self.loaded.file.print()?, self.objective.solver().left_out());
        let mut page = page(&self.figures);
        page.sections.push(sections::origin(&scene, &left_out, warnings));
        page.sections.push(sections::files(&self.files));
        page.sections.retain(|section| !section.blocks.is_empty());
        self.folder.write("report.html", page.html())
    }
}

/// The files of an optimization; `last` is the run that it is reported by: the last mesh, or the best start.
pub fn write_optimization(
    folder: &Folder,
    loaded: &LoadedScene,
    runs: &[MeshRun],
    last: &MeshRun,
    shapes: &[SolvedShape; 2],
    checks: &[Warning],
) -> Result<(), Failure> {
    let MeshRun { objective, report, .. } = last;
    let mut out = ReportFolder::new(folder, loaded, objective);
    out.write("controls.json", &json(report.solution.as_slice())?, "the control heights found")?;
    let what = "all cuts and multipliers behind the certificate, for recheck";
    out.write("certificate.json", &json(&report.certificate)?, what)?;
    out.write("history.csv", &tables::history(report), "one line per evaluation")?;
    out.show(&[("initial", "start, ", &shapes[0]), ("optimal", "optimum, ", &shapes[1])])?;
    if out.wanted().pictures {
        let figure = gallery::convergence(objective, report, &shapes[1]);
        out.draw(figure, "objective of every evaluation and kinds of steps")?;
    }
    out.finish(|figures| pages::optimization(figures, runs, last, shapes), &all_warnings(report, checks))
}

/// The files of an evaluation.
pub fn write_evaluation(
    folder: &Folder,
    loaded: &LoadedScene,
    objective: &ContactObjective,
    shape: &SolvedShape,
    json: &str,
    checks: &[Warning],
) -> Result<(), Failure> {
    let mut out = ReportFolder::new(folder, loaded, objective);
    out.write("evaluation.json", json, "everything that evaluate knows, as one JSON object")?;
    out.show(&[("shape", "", shape)])?;
    out.finish(|figures| pages::evaluation(figures, objective, shape), checks)
}

/// The files of a comparison.
pub fn write_comparison(folder: &Folder, loaded: &LoadedScene, comparison: &Comparison<'_>) -> Result<(), Failure> {
    let mut out = ReportFolder::new(folder, loaded, &comparison.runs[0].objective);
    for part in COMPARED {
        out.files.push((format!("{part}/report.html"), "the optimization itself, with its files"));
    }
    let (with, without) = (&comparison.own[0][1], &comparison.crossed[0]);
    out.show(&[
        ("optimized_with_friction", "optimized with friction, ", with),
        ("optimized_without_friction", "optimized without friction, ", without),
    ])?;
    out.finish(|figures| pages::comparison(figures, comparison), &[])
}
