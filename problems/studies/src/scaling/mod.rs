//! How work, time and memory grow with the mesh: the study behind `docs/scaling.md`.
//!
//! ```text
//! cli ─ cases ─ measure, memory ─ ScalingRow
//! rows ─ growth ─ ScalingReport ─ table (Markdown) or JSON
//! ```
//! Contract (kept stable): exit status 0 success, 1 a computation failed, 2 bad input; `--json` prints one JSON object
//! on stdout and nothing else there.

mod cases;
mod cli;
mod growth;
mod measure;
mod memory;
mod report;
mod rows;
mod table;

pub use cases::{Case, Extent, SceneName, Variant, option_name};
pub use cli::{ScalingArguments, run};
pub use growth::{CountGrowth, Growth};
pub use memory::peak as peak_memory;
pub use report::ScalingReport;
pub use rows::{Adjoint, Sample, ScalingRow, Solve, Start};
