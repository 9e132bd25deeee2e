//! Contact shape optimization in several processes that communicate by MPI.
//!
//! `contact3d-mpi` takes the arguments of `contact3d`. Started by `mpirun` or `srun`, its processes share the
//! subdomains of total FETI; process 0 does everything else ([`problems::commands::processes`]).
//! `docs/several_machines.md` of the repository says how to build and to run it.

mod build_name;
mod ending;
mod world;

pub use build_name::build_name;
pub use world::World;

use contact::communication::Communication;
use ending::{FAILED, end_all, end_with_panics};
use mpi::Threading;
use problems::commands::processes::run_together;
use problems::commands::{leave_interrupts, notice, print_failure, run_any_among};
use std::process::ExitCode;
use std::sync::Arc;

/// Exit status of a program that cannot begin.
const NOT_BEGUN: u8 = 1;

/// Runs the program of this name in one of the processes that MPI has started. `connection` may put something between
/// the program and MPI.
pub fn run(binary: &'static str, connection: impl FnOnce(World) -> Arc<dyn Communication>) -> ExitCode {
    // One thread at a time calls MPI: the one that runs the command, or one that ends all processes.
    let Some((universe, provided)) = mpi::initialize_with_threading(Threading::Serialized) else {
        notice("error: MPI has been initialized before");
        return ExitCode::from(NOT_BEGUN);
    };
    let world = World::new();
    let rank = world.rank();
    if provided < Threading::Serialized {
        if rank == 0 {
            notice("error: the MPI library is not built for programs with threads (MPI_THREAD_SERIALIZED)");
        }
        return ExitCode::from(NOT_BEGUN);
    }
    end_with_panics(rank, world.size());
    if rank > 0 {
        // The first process gets requests to end too, and decides what follows.
        leave_interrupts();
    }
    let communication = connection(world);
    let result = run_together(&communication, &build_name(), |processes| run_any_among(binary, processes));
    let status = match result {
        Ok(Some(status)) => status,
        Ok(None) => ExitCode::SUCCESS,
        Err(failure) if rank == 0 => print_failure(&failure),
        Err(failure) => end_all(&failure.to_string(), FAILED),
    };
    drop(universe);
    status
}
