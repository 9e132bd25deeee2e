//! The commands of the contact binaries.
//!
//! Contract (kept stable): `NAME [optimize|compare|study|look|evaluate|verify|tolerance|recheck DIR|export]
//! [options]`, for
//! `contact3d` with a scene file before the command. Exit status: 0 success; 1 the computation failed, its result could
//! not be printed or written, or a certificate does not agree; 2 bad input; 130 interrupted, with a report. `--json`
//! prints one JSON object on stdout and nothing else there.

mod arguments;
mod body_fields;
mod case_facts;
mod command_line;
mod compare;
mod controls;
mod evaluate;
mod export;
mod facts;
mod failure;
mod field_list;
mod file_limit;
mod folder;
mod interrupt;
mod limit_check;
mod limited_value;
mod loaded_scene;
mod long_run;
mod look;
mod new_scene;
mod numbers;
mod optimize;
mod output;
pub mod processes;
mod recheck;
mod register;
mod report;
mod run_kind;
mod scene_difference;
mod scene_options;
mod scene_words;
mod shape_facts;
mod solved_shape;
mod study;
mod tolerance;
mod vectors;
mod verify;

pub use arguments::Arguments;
pub use command_line::{execute, execute_among, run, run_any_among};
pub use controls::{Layout, parse as parse_controls};
pub use failure::{Failure, failed};
pub use folder::{Folder, json, printed_with_files};
pub use interrupt::leave_interrupts;
pub use long_run::StageLayer;
pub use look::page as look_page;
pub use new_scene::new_scene;
pub use numbers::raised;
pub use output::{arguments, finish, notice, print, print_failure};
pub use report::solved_page;
pub use solved_shape::{ContactObjective, SolvedShape, objective};
pub use verify::{DIRECTION_SEED, smooth_taylor_test, taylor_steps};
