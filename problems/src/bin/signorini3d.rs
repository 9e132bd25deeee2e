//! `signorini3d`: contact shape optimization of the paper's Example 5.1; see `--help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    problems::commands::run(env!("CARGO_BIN_NAME"), include_str!("../../scenes/signorini.toml"))
}
