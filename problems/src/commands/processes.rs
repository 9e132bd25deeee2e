//! A command in several processes: whether all run the same program, and what the first and the others do.

use crate::commands::failure::Failure;
use contact::communication::Communication;
use contact::solvers::{Processes, follow, lead};
use std::sync::Arc;

/// Runs a command in one of several processes: the first does what `run` says, with the others at its hands, and the
/// others follow it. `build` names the program; all processes must have the same name for it. The first process gets
/// the result of `run`, the others get none.
///
/// # Errors
/// [`Failure::Input`] in the first process if the others run another program; [`Failure::Computation`] in another one
/// that does not understand the first.
pub fn run_together<T>(
    communication: &Arc<dyn Communication>,
    build: &str,
    run: impl FnOnce(&Processes) -> T,
) -> Result<Option<T>, Failure> {
    let builds = communication.gather_any(&build.bytes().map(f64::from).collect::<Vec<f64>>());
    let other = builds.iter().position(|other| *other != builds[0]);
    match (other, communication.rank()) {
        (Some(other), 0) => {
            let name = |build: &[f64]| {
                String::from_utf8_lossy(&build.iter().map(|b| *b as u8).collect::<Vec<u8>>()).into_owned()
            };
            let [first, other_build] = [&builds[0], &builds[other]].map(|build| name(build));
            Err(Failure::Input(format!(
                "process {other} runs {other_build}, process 0 runs {first}: all processes must run the same build of the program on processors of the same kind"
            )))
        }
        (Some(_), _) => Ok(None),
        (None, 0) => Ok(Some(lead(communication, run))),
        (None, rank) => {
            let failed =
                |reason| Failure::Computation(format!("process {rank} does not understand process 0: {reason}"));
            follow(communication).map(|()| None).map_err(failed)
        }
    }
}
