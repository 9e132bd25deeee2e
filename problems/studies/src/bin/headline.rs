//! `headline`: the tables that docs/measurements.md begins with, computed anew; see `--help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    studies::headline::main()
}
