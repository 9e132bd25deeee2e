//! How work, time and memory grow with the mesh: the study behind `docs/scaling.md`.
//!
//! ```text
//! cli ─ cases ─┬─ children: one process per case and variant, so that each has its own peak memory
//!              └─ measure ─ timing, threads, bandwidth, memory ─ Row
//! Rows ─ growth ─ Report ─ table (Markdown) or JSON
//! ```
//! Contract (kept stable): exit status 0 success, 1 a computation failed, 2 bad input; `--json` prints one JSON object on
//! stdout and nothing else there.

mod bandwidth;
mod cases;
mod children;
mod cli;
mod growth;
mod measure;
mod memory;
mod repeat;
mod report;
mod row;
mod solve;
mod table;
mod threads;
mod timing;

pub use bandwidth::Bandwidth;
pub use cases::{Case, Extent, SceneName, Variant, word};
pub use cli::{Arguments, run};
pub use growth::Growth;
pub use memory::peak as peak_memory;
pub use report::Report;
pub use row::Row;
pub use solve::{Adjoint, Sample, Solve, Start};
pub use threads::{ThreadSample, Threads};
