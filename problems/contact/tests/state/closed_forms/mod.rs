//! Closed forms that the contact solvers must meet; measured errors stand in `docs/verification.md`.

mod balance;
mod bar;
mod boussinesq;
mod hertz;
mod invariance;
mod mindlin;
mod objectives;
mod patch;
mod punch;
mod setting;
