//! `contact3d-mpi`: contact shape optimization of any scene file in several processes; see `--help`.

use std::process::ExitCode;
use std::sync::Arc;

fn main() -> ExitCode {
    problems_mpi::run(env!("CARGO_BIN_NAME"), |world| Arc::new(world))
}
