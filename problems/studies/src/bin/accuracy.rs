//! `accuracy`: error against run time of discretisation, contact solvers, subgradient and optimization; see `--help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    studies::accuracy::run()
}
