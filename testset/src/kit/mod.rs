//! What the tests of all packages share: reproducible numbers, scratch folders, programs run to their end, the commands
//! of the pages and the numbers that these share, and ranks that are threads.
//!
//! Nothing here knows the packages under test, so that every one of them can use it.

mod documented_commands;
pub mod facts;
mod mailbox;
mod numbers;
pub mod pages;
mod pins;
mod program;
pub mod step_file;
pub mod stl_file;
pub mod vtu_file;

pub use documented_commands::run_commands;
pub use mailbox::Mailbox;
pub use numbers::{Random, jitter, jitters, numbers, relative_difference, wavy};
pub use pins::{check_pins, rounds_alike};
pub use program::{command, errors, json, parsed, read_json, read_rows, refused, run, scratch, text};
