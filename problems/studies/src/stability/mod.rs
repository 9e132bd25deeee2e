//! Stiff and extreme cases: the study behind `docs/stability.md`.
//!
//! ```text
//! cli ─ matrix of cases ─┬─ checked_run ─ contact: scene → TotalFeti, DirectSolver, (successive approximations) → Record
//!                        └─ units, locking: scenes and fields compared with each other → Record
//!     └ optimizer: what the bundle method says at the end of its runs, compared with known minima
//! Records ─ table (Markdown) or JSON
//! ```
//! Every case states what it expects: a state with certificates that two independent paths agree on, a refusal of a
//! named kind, or a limit with its cause. Anything else is *broken* and makes the exit status 1. Contract (kept
//! stable): exit status 0 as expected, 1 a case is broken, 2 bad input; `--json` prints one JSON object on stdout and
//! nothing else there.

mod case;
mod checked_run;
mod cli;
mod contact;
mod contacts;
mod friction;
mod geometry;
mod loads;
mod locking;
mod materials;
mod matrix;
mod optimizer;
mod random;
mod record;
mod scenes;
mod table;
mod tearing;
mod units;

pub use case::Case;
pub use cli::run;
pub use locking::field_error;
pub use matrix::all;
pub use optimizer::{Run, collection, mixed_units, offenders};
pub use random::run as random_scenes;
pub use record::{CaseOutcome, Counts, StabilityReport};
