//! Closed forms that the contact solvers must meet; measured errors stand in `docs/verification.md`.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod balance;
mod bar;
mod boussinesq;
mod hertz;
mod invariance;
mod manufactured;
mod mindlin;
mod patch;
mod punch;
mod setting;
