//! How work, time and memory grow with the mesh: a study behind `docs/measurements.md`.
//!
//! ```text
//! cli ─ cases ─ measure, memory ─ ScalingRow ─ table (Markdown) or JSON
//! ```
//! Contract (kept stable): exit status 0 success, 1 a computation failed, 2 bad input; `--json` prints one JSON object
//! on stdout and nothing else there.

mod cases;
mod cli;
mod measure;
mod memory;
mod table;

pub use cases::{Case, SceneName, Variant, option_name};
pub use cli::run;
pub use memory::peak as peak_memory;
