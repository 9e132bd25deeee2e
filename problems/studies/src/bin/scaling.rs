//! `scaling`: tables of work, time and memory of the contact solvers over growing meshes; see `--help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    studies::scaling::run()
}
