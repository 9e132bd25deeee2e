//! The command line shared by `hertz3d` and `signorini3d`: parse, compute, print.
//!
//! Contract (kept stable): `NAME [optimize|evaluate|verify] [options]`; exit status 0 success, 1 the computation failed,
//! 2 bad input; `--json` prints one JSON object on stdout and nothing else there.

mod arguments;
mod controls;
mod evaluate;
mod failure;
mod optimize;
mod output;
mod picture;
mod verify;

pub use arguments::{Arguments, Command};
pub use failure::Failure;
pub(crate) use optimize::{first_step, mean_height_coordinates};
pub(crate) use output::{Folder, json};
pub(crate) use verify::smooth_step;

use crate::contact_shape::ContactShape;
use crate::cost::PressureCost;
use crate::error::SceneError;
use crate::scene::Scene;
use clap::Parser;
use nonsmooth::ReducedObjective;
use std::io::Write;
use std::process::ExitCode;

/// Θ of a scene.
pub type ContactObjective = ReducedObjective<ContactShape, PressureCost>;

/// Runs a binary on its default scene.
pub fn run(scene: Result<Scene, SceneError>) -> ExitCode {
    let arguments = Arguments::parse();
    match execute(scene, &arguments) {
        Ok(text) => {
            // A reader that closes the pipe early has seen what it wanted.
            let _ = std::io::stdout().write_all(text.as_bytes());
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("error: {failure}");
            failure.exit_code()
        }
    }
}

/// Computes what the arguments ask for; the text belongs on stdout.
///
/// # Errors
/// [`Failure`] with its exit status.
pub fn execute(scene: Result<Scene, SceneError>, arguments: &Arguments) -> Result<String, Failure> {
    arguments.check()?;
    if let Some(threads) = arguments.threads {
        // A second call in one process keeps the first pool; results do not depend on it.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
    let scene = arguments.apply(scene?)?;
    let shape = ContactShape::with_preconditioner(scene, arguments.solver, arguments.preconditioner)?;
    let cost = PressureCost::new(arguments.measure(), &shape.problem().boundary)?;
    let objective = ReducedObjective::new(shape, cost);
    match arguments.command {
        Command::Optimize => optimize::run(&objective, arguments),
        Command::Evaluate => evaluate::run(&objective, arguments),
        Command::Verify => verify::run(&objective, arguments),
    }
}
