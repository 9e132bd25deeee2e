//! What the commands print, write, refuse and resume.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

#[path = "../../../tests/common/documented_commands.rs"]
mod documented_commands;
#[path = "../../../tests/common/pages.rs"]
mod pages;

mod binaries;
mod compare;
mod contact3d;
mod fuzz;
mod long_runs;
mod pages_run;
mod pictures;
mod pins;
mod reports;
mod stages;
mod toy2d;
