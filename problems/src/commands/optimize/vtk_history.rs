//! `--vtk-history`: the shapes that an optimization came through, as a series for ParaView.

use crate::commands::failure::Failure;
use crate::commands::folder::Folder;
use crate::commands::report::VTK;
use crate::commands::solved_shape::{SolvedShape, objective_note};
use crate::vtk_files::{FieldState, list, state_files};
use exchange::vtk::{Note, NoteValue};
use nonsmooth::{Journal, StepKind, Vector};
use scene_file::optimization::ContactRun;

/// The list of the series.
const LIST: &str = "history.pvd";

/// Writes the start and every serious step of runs that follow each other; the time of a shape is the number of its
/// evaluation, counted through all runs. Each state is solved again, since a run keeps its shapes and not their fields.
///
/// # Errors
/// [`Failure`] of the contact solver and of the files; [`Failure::Computation`] for a journal without the shape of a
/// step.
pub fn write(folder: &Folder, runs: &[&ContactRun]) -> Result<(), Failure> {
    let vtk = folder.within(VTK)?;
    let (mut entries, mut before) = (Vec::new(), 0);
    for run in runs {
        let place =
            run.stage.label.part.folder().map_or_else(|| folder.path().to_owned(), |name| folder.path().join(name));
        let journal = Journal::read(&place)?.map(|journal| journal.entries).unwrap_or_default();
        let steps =
            run.report.history.iter().filter(|record| [StepKind::Start, StepKind::Serious].contains(&record.kind));
        for record in steps {
            let missing = || {
                let words = "the journal does not hold the shape of evaluation";
                Failure::Computation(format!("{}: {words} {}", place.display(), record.evaluation))
            };
            let entry = journal.get(record.evaluation - 1).ok_or_else(missing)?;
            let solved = SolvedShape::at(&run.stage.objective, &Vector::from_column_slice(&entry.point))?;
            let fields = solved.fields(&run.stage.objective, solved.worst, true)?;
            let evaluation = before + record.evaluation;
            let number = NoteValue::Integer(i32::try_from(evaluation).unwrap_or(i32::MAX));
            let notes = [objective_note(&run.stage.objective, solved.value), Note::new("evaluation", "", number)];
            let name = format!("history_{evaluation:04}");
            let state = FieldState { time: evaluation as f64, name: &name, fields: &fields, notes: &notes };
            let files = state_files(entries.len() / 2, &state).map_err(Failure::computation)?;
            files.files.iter().try_for_each(|(name, text)| vtk.write(name, text))?;
            entries.extend(files.entries);
        }
        before += run.report.counts.evaluations;
    }
    vtk.write(LIST, list(&entries).map_err(Failure::computation)?)
}
