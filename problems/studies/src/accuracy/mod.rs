//! Error against run time: the study behind "Accuracy" of `docs/measurements.md`.
//!
//! ```text
//! cli ─┬─ discretisation, manufactured      error against bricks, dofs, seconds
//!      ├─ algebra                           error against tolerance, seconds; the solver's estimate beside it
//!      ├─ subgradient                       Taylor tables, one-sided slopes at constructed kinks
//!      └─ optimization                      Θ(best) − Θ* against evaluations and products
//! every part ─ Markdown or JSON
//! ```
//! Contract (kept stable): exit status 0 success, 1 a computation failed, 2 bad input; `--json` prints one JSON object
//! on stdout and nothing else there.

mod algebra;
mod cli;
mod discretisation;
mod manufactured;
mod objective;
mod optimization;
mod subgradient;

pub use cli::run;
pub use manufactured::{manufactured_errors, smooth_gradient, smooth_solution};
