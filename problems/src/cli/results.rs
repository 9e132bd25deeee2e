//! The files of a run: tables, pictures, meshes for ParaView, report page. Nothing of this is computed unless a folder is asked
//! for.

use crate::cli::compared::Compared;
use crate::cli::optimized::{Finished, history_table};
use crate::cli::output::{self, Folder};
use crate::cli::solved::Solved;
use crate::cli::{Failure, Source, evaluate};
use crate::scene_file::Case;

/// The files of an optimization.
pub fn write_optimization(
    folder: &Folder,
    _source: &Source,
    _case: &Case,
    finished: &Finished,
    shapes: &[Solved; 2],
    _text: &str,
) -> Result<(), Failure> {
    folder.write("controls.json", &output::json(finished.report.solution.as_slice())?)?;
    folder.write("certificate.json", &output::json(&finished.report.certificate)?)?;
    folder.write("history.csv", &history_table(&finished.report))?;
    for (name, shape) in ["initial", "optimal"].into_iter().zip(shapes) {
        folder.write(&format!("pressure_{name}.csv"), &evaluate::pressure_table(&finished.objective, &shape.state))?;
    }
    Ok(())
}

/// The files of a comparison.
pub fn write_comparison(
    _folder: &Folder,
    _source: &Source,
    _case: &Case,
    _compared: &Compared<'_>,
) -> Result<(), Failure> {
    Ok(())
}
