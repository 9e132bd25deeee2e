//! `stability`: what the solvers and the optimizer do with stiff and extreme cases; see `--help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    studies::stability::run()
}
