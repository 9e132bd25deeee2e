//! The studies behind `docs/measurements.md` (scaling, accuracy) and `docs/stability.md`, each with a binary of its
//! name, and `headline`, which computes the tables that `docs/measurements.md` begins with.

pub mod accuracy;
pub mod headline;
mod held_block;
mod markdown;
mod rates;
pub mod scaling;
pub mod stability;
