//! The studies on small cases.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

#[path = "../../../../tests/common/documented_commands.rs"]
mod documented_commands;
#[path = "../../../../tests/common/pages.rs"]
mod pages;

mod accuracy;
mod manufactured;
mod pages_run;
mod scaling;
mod stability;
