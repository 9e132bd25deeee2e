//! Convex problems whose variables have different units, and whose minimum an independent method finds.
//!
//! ```text
//! fits, vertices, reported → problem (function, set, starts) → cases: units, offsets
//! cases ─┬─ truth: cone program in variables of unit 1 → minimum, minimiser
//!        └─ checked_run: the engine in the units of the user → record → report
//! ```

mod cases;
mod checked_run;
mod cone_program;
mod fits;
mod function;
mod problem;
mod report;
mod reported;
mod truth;
mod vertices;

pub use report::{UnitReport, mixed_units};
