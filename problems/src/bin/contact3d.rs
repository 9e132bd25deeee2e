//! `contact3d`: contact shape optimization of any scene file; see `--help`.

use contact::solvers::Processes;
use std::process::ExitCode;

fn main() -> ExitCode {
    problems::commands::run_any_among("contact3d", &Processes::alone())
}
