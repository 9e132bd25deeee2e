//! The files of a run: tables, pictures, meshes for ParaView, report page. Nothing of this is computed unless a folder is asked
//! for.

use crate::commands::compare::comparison::Comparison;
use crate::commands::folder::{Folder, json};
use crate::commands::long_run::{COMPARED, RunFolder};
use crate::commands::optimize::summary::{Finished, history_table};
use crate::commands::report::contact_table;
use crate::commands::report::gallery::{self, Seen};
use crate::commands::report::pages::{self, Context};
use crate::commands::solved_shape::SolvedShape;
use crate::commands::{ContactObjective, Failure, Source};
use contact::fields::{FieldState, vtk_files};
use figures::Figure;
use scene_file::Case;

/// Folders of pictures and of files for ParaView.
const FIGURES: &str = "figures";
const VTK: &str = "vtk";

/// What a folder receives: a list of the files for the report, and the figures for it.
struct Delivery<'a> {
    folder: &'a Folder,
    case: &'a Case,
    files: Vec<(String, &'static str)>,
    figures: Vec<Figure>,
}

impl<'a> Delivery<'a> {
    fn new(folder: &'a Folder, case: &'a Case) -> Self {
        Self { folder, case, files: vec![], figures: vec![] }
    }

    fn write(&mut self, name: &str, text: &str, what: &'static str) -> Result<(), Failure> {
        self.files.push((name.to_owned(), what));
        self.folder.write(name, text)
    }

    /// A picture as SVG and PNG, and in the report.
    fn draw(&mut self, figure: Figure, what: &'static str) -> Result<(), Failure> {
        self.folder.within(FIGURES)?.draw(&figure)?;
        self.files.push((format!("{FIGURES}/{}.svg, .png", figure.name), what));
        self.figures.push(figure);
        Ok(())
    }

    /// Contact boundary as tables, fields for ParaView.
    fn tabulate(&mut self, objective: &ContactObjective, shapes: &[Seen<'_>]) -> Result<(), Failure> {
        for shape in shapes {
            let what = "pressure, traction, remaining gap and status of every contact node";
            self.write(
                &format!("pressure_{}.csv", shape.name),
                &contact_table::contact(objective, &shape.solved.state),
                what,
            )?;
        }
        if self.case.output.vtk {
            let states = shapes.iter().enumerate();
            let states: Vec<FieldState<'_>> = states
                .filter_map(|(index, shape)| {
                    shape.fields.as_ref().map(|fields| FieldState { time: index as f64, name: shape.name, fields })
                })
                .collect();
            let folder = self.folder.within(VTK)?;
            for (name, text) in vtk_files(&states).map_err(Failure::computation)? {
                folder.write(&name, &text)?;
            }
            let what = "displacements, stresses and contact fields: open fields.pvd with ParaView";
            self.files.push((format!("{VTK}/fields.pvd, *.vtu"), what));
        }
        Ok(())
    }

    /// Pressure, stress and surface of some shapes.
    fn draw_shapes(&mut self, objective: &ContactObjective, shapes: &[Seen<'_>]) -> Result<(), Failure> {
        if !self.case.output.pictures {
            return Ok(());
        }
        let pressure = gallery::pressure(objective, shapes).map_err(Failure::computation)?;
        self.draw(pressure, "contact pressure on one scale")?;
        let stress = gallery::von_mises(objective, shapes).map_err(Failure::computation)?;
        self.draw(stress, "von Mises stress on the deformed bodies, on one scale")?;
        let surface = gallery::surfaces(objective, shapes).map_err(Failure::computation)?;
        self.draw(surface, "heights of the contact surface on one scale")
    }

    /// The page, with a table of all files.
    fn report(
        &mut self,
        source: &Source,
        page: impl FnOnce(&Context<'_>) -> figures::page::Page,
    ) -> Result<(), Failure> {
        if !self.case.output.report {
            return Ok(());
        }
        if RunFolder::is_one(self.folder.path()) {
            self.files.push(("report.txt, report.json".into(), "the page of text, and the same as one JSON object"));
            self.files.push(("scene.toml, start.json, journal.jsonl, …".into(), "the run itself, for --resume"));
        }
        let scene = source.scene.print()?;
        let context = Context { scene: &scene, figures: &self.figures, files: &self.files };
        self.folder.write("report.html", &page(&context).html())
    }
}

/// The files of an optimization.
pub fn write_optimization(
    folder: &Folder,
    source: &Source,
    case: &Case,
    finished: &[Finished],
    shapes: &[SolvedShape; 2],
) -> Result<(), Failure> {
    let Some(last) = finished.last() else { return Ok(()) };
    let Finished { objective, report, .. } = last;
    let mut delivery = Delivery::new(folder, case);
    delivery.write("controls.json", &json(report.solution.as_slice())?, "the control heights found")?;
    let what = "all cuts and multipliers behind the certificate";
    delivery.write("certificate.json", &json(&report.certificate)?, what)?;
    delivery.write("history.csv", &history_table(report), "one line per evaluation")?;
    let wanted = &case.output;
    let seen = [
        Seen::new(objective, "initial", format!("start, Θ = {:.4e}", shapes[0].value), &shapes[0], wanted)?,
        Seen::new(objective, "optimal", format!("optimum, Θ = {:.4e}", shapes[1].value), &shapes[1], wanted)?,
    ];
    delivery.tabulate(objective, &seen)?;
    delivery.draw_shapes(objective, &seen)?;
    if case.output.pictures {
        let figure = gallery::convergence(objective, case.measure, report, &shapes[1]);
        delivery.draw(figure.map_err(Failure::computation)?, "objective of every evaluation and kinds of steps")?;
    }
    delivery.report(source, |context| report_pages::optimization(context, finished, last, shapes))
}

/// The files of an evaluation.
pub fn write_evaluation(
    folder: &Folder,
    source: &Source,
    case: &Case,
    objective: &ContactObjective,
    shape: &SolvedShape,
    json: &str,
) -> Result<(), Failure> {
    let mut delivery = Delivery::new(folder, case);
    delivery.write("evaluation.json", json, "everything that evaluate knows, as one JSON object")?;
    let wanted = &case.output;
    let seen = [Seen::new(objective, "shape", format!("Θ = {:.4e}", shape.value), shape, wanted)?];
    delivery.tabulate(objective, &seen)?;
    delivery.draw_shapes(objective, &seen)?;
    delivery.report(source, |context| report_pages::evaluation(context, objective, shape))
}

/// The files of a comparison.
pub fn write_comparison(
    folder: &Folder,
    source: &Source,
    case: &Case,
    compared: &Comparison<'_>,
) -> Result<(), Failure> {
    let objective = &compared.runs[0].objective;
    let mut delivery = Delivery::new(folder, case);
    for part in COMPARED {
        delivery.files.push((format!("{part}/report.html"), "the optimization itself, with its files"));
    }
    let caption = |words: &str, shape: &SolvedShape| format!("{words}, Θ = {:.4e}", shape.value);
    let (with, without) = (&compared.own[0][1], &compared.crossed[0]);
    let wanted = &case.output;
    let seen = [
        Seen::new(objective, "optimized_with_friction", caption("optimized with friction", with), with, wanted)?,
        Seen::new(
            objective,
            "optimized_without_friction",
            caption("optimized without friction", without),
            without,
            wanted,
        )?,
    ];
    delivery.tabulate(objective, &seen)?;
    delivery.draw_shapes(objective, &seen)?;
    delivery.report(source, |context| report_pages::comparison(context, compared))
}
