//! Contact between bodies whose meshes do not match: reference cases, patch tests, rates, smoothness, several bodies.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

#[path = "../common/mod.rs"]
mod common;
#[path = "../meshes/grid.rs"]
#[allow(dead_code, reason = "either binary uses a part of it")]
mod grid;
mod hertz;
mod patch;
mod processes;
mod products;
mod random;
#[path = "../state/rank.rs"]
mod rank;
mod rate;
mod reference;
mod setting;
mod smoothness;
mod special;
mod stack;
mod taylor;
