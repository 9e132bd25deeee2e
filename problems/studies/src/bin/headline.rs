//! `headline`: the tables of README.md and docs/results.md, computed anew; see `--help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    studies::headline::main()
}
