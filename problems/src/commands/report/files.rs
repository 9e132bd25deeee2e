//! The files of each command. None of them is computed unless a folder is asked for.

use crate::commands::compare::comparison::Comparison;
use crate::commands::controls::{self, Layout};
use crate::commands::facts::Facts;
use crate::commands::failure::Failure;
use crate::commands::folder::{COMPARED, Folder, SUMMARY, json};
use crate::commands::loaded_scene::LoadedScene;
use crate::commands::optimize::summary::{Ended, all_warnings};
use crate::commands::report::folder::ReportFolder;
use crate::commands::report::sections::found_label;
use crate::commands::report::{captions, gallery, pages, summary, tables};
use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use contact::plausibility::Warning;
use scene_file::optimization::{ContactRun, ContactStage};

/// The files of an optimization.
pub fn write_optimization(
    folder: &Folder,
    loaded: &LoadedScene,
    ended: &Ended<'_>,
    facts: &Facts,
) -> Result<(), Failure> {
    let shapes = ended.shapes;
    let ContactRun { stage: ContactStage { objective, .. }, report, .. } = ended.last;
    let mut out = ReportFolder::new(folder, loaded, objective);
    let layout = Layout::of(&objective.solver().problem().scene);
    let written = controls::written(report.solution.as_slice(), layout)?;
    out.write("controls.json", &written, "the controls found")?;
    let what = "all cuts and multipliers behind the certificate, for recheck";
    out.write("certificate.json", &json(&report.certificate)?, what)?;
    out.write("history.csv", &tables::history(objective, report), "one line per evaluation")?;
    let shown = [("initial", "start", &shapes[0]), ("optimal", found_label(report), &shapes[1])];
    out.show(&shown)?;
    if out.wanted().pictures {
        let figure = gallery::convergence(objective, report, &shapes[1]).map_err(Failure::computation)?;
        out.draw(figure, "objective of every evaluation, kinds and origins of steps", captions::COURSE)?;
    }
    if out.wanted().report {
        let paper = summary::page(loaded, ended, facts, folder.path())?;
        out.write(SUMMARY, &paper, "one page to print, for the one who decides")?;
    }
    out.finish(|parts| pages::optimization(parts, ended, facts, folder.path()), &all_warnings(report, ended.checks))
}

/// The files of an evaluation.
pub fn write_evaluation(
    folder: &Folder,
    loaded: &LoadedScene,
    objective: &ContactObjective,
    shape: &SolvedShape,
    (facts, json): (&Facts, &str),
    checks: &[Warning],
) -> Result<(), Failure> {
    let mut out = ReportFolder::new(folder, loaded, objective);
    out.write("evaluation.json", json, "everything that evaluate knows, as one JSON object")?;
    out.show(&[("shape", "this shape", shape)])?;
    out.finish(|parts| pages::evaluation(parts, objective, shape, facts), checks)
}

/// The files of a comparison.
pub fn write_comparison(
    folder: &Folder,
    loaded: &LoadedScene,
    comparison: &Comparison<'_>,
    facts: &Facts,
) -> Result<(), Failure> {
    let mut out = ReportFolder::new(folder, loaded, &comparison.runs[0].stage.objective);
    for part in COMPARED {
        out.announce(&format!("{part}/report.html"), "the optimization itself, with its files");
    }
    let (with, without) = (&comparison.own[0][1], &comparison.crossed[0]);
    out.show(&[
        ("optimized_with_friction", "optimized with friction", with),
        ("optimized_without_friction", "optimized without friction", without),
    ])?;
    out.finish(|parts| pages::comparison(parts, comparison, facts), &[])
}
