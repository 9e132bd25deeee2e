//! The studies behind `docs/scaling.md`, `docs/accuracy.md` and `docs/stability.md`, each with a binary of its name.

pub mod accuracy;
pub mod scaling;
pub mod stability;
