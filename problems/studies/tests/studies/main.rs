//! The studies on small cases.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod accuracy;
mod manufactured;
#[path = "../optimizer/mod.rs"]
mod optimizer;
mod pages_run;
mod scaling;
mod stability;
