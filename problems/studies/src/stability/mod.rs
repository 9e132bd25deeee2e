//! Stiff and extreme cases: the study behind `docs/stability.md`.
//!
//! ```text
//! cli ─┬─ cases ─┬─ contact: scene → TotalFeti, DirectSolver, (successive approximations) → Record ─ tables
//!      │         └─ units, locking: scenes and fields compared with each other ─┘
//!      └─ random: random scenes by all solvers
//! ```
//! Every case states what it expects: a state with certificates that two independent paths agree on, a refusal of a
//! named kind, or a limit with its cause. Anything else is *broken* and makes the exit status 1. Contract (kept
//! stable): exit status 0 as expected, 1 a case is broken, 2 bad input.

mod case;
mod cli;
mod contact;
mod contacts;
mod geometry;
mod loads;
mod locking;
mod materials;
mod random;
mod scenes;
mod units;

pub use case::{Case, CaseOutcome, Record, counts};
pub use cli::run;
pub use locking::field_error;
pub use random::run as random_scenes;

/// All cases, in the order of the page.
pub fn all() -> Vec<Case> {
    let groups = [
        materials::cases(),
        locking::cases(),
        geometry::cases(),
        materials::friction(),
        contacts::cases(),
        loads::cases(),
        contacts::kinks(),
        units::cases(),
        geometry::subdomains(),
    ];
    groups.into_iter().flatten().collect()
}
