//! Stiff and extreme cases: the study behind `docs/stability.md`.
//!
//! ```text
//! cli ─ matrix of cases ─┬─ checked_run ─ contact: scene → TotalFeti, DirectSolver, (successive approximations) → Record
//!                        └─ units, locking: scenes and fields compared with each other → Record
//!     └ optimizer_page ─┬─ optimizer_terminations: terminations on the collection, compared with known minima
//!                       └─ mixed_units: the same on convex problems in mixed units; cone programs give the minima
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
mod mixed_units;
mod optimizer_page;
mod optimizer_stationarity;
mod optimizer_terminations;
mod optimizer_variants;
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
pub use mixed_units::{UnitReport, mixed_units};
pub use optimizer_terminations::{TerminationKind, terminations};
pub use random::run as random_scenes;
pub use record::{CaseOutcome, Counts, StabilityReport};
