//! The studies behind `docs/scaling.md`, `docs/accuracy.md` and `docs/stability.md`, each with a binary of its name,
//! and `headline`, which computes the tables of README.md and `docs/results.md`.

pub mod accuracy;
pub mod headline;
mod held_block;
mod markdown;
mod rates;
pub mod scaling;
pub mod stability;
