//! The optimization of a case: which runs follow each other, and where each begins.
//!
//! ```text
//! Case ─ stages: attempts, meshes, starts ─ Driver ─ ways: where a run begins ─┬ coarse_net: directions of few controls
//!                                             │                                └ fairness: the shape of least bending
//!                                    caller: performs a run, with a journal and an observer of its own
//! ```
//! The program, the Python package and programs in Rust use the same [`Driver`] and find the same controls, bit for
//! bit. A caller says where the journal of a run lies; [`Part::folder`] names its folder within that of the
//! optimization. Repeated from its journals, an optimization takes the same course again, and goes on where it was
//! interrupted.
//!
//! ```no_run
//! use scene_file::{Case, SceneFile, optimization::optimize};
//! use std::path::Path;
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let case = Case::new(&SceneFile::read(Path::new("scene.toml"))?, Path::new(""))?;
//! println!("{:?}", optimize(&case)?.chosen().map(|run| &run.report.solution));
//! # Ok(())
//! # }
//! ```

mod coarse_net;
mod driver;
mod fairness;
mod runs;
mod stages;
mod ways;

pub use driver::{ContactStage, Driver, optimize, settings};
pub use fairness::bending_of;
pub use runs::{ContactRun, Label, Runs};
pub use stages::{Attempt, MeshName, Part, PlannedRun, last_begun, stages};

use contact::error::SceneError;
use nonsmooth::qp::QpError;
use nonsmooth::{OptimizeError, OracleError};
use thiserror::Error;

/// Why an optimization ended without a result.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OptimizationError {
    /// The scene cannot be prepared on one of its meshes.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A run could not begin.
    #[error(transparent)]
    Run(#[from] OptimizeError),
    /// The derivatives at the end of a run, from which a fairer shape is computed, could not be had.
    #[error(transparent)]
    Derivatives(#[from] OracleError),
    /// A further start cannot be moved into the admissible set.
    #[error("start {number}: {source}")]
    Start {
        /// The number of the start; that of the scene is 1.
        number: usize,
        /// Why the projection failed.
        source: QpError,
    },
}
