//! `contact3d`: contact shape optimization of any scene file; see `--help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    problems::commands::run_any()
}
