//! How one process ends all of them.

use mpi::topology::{Communicator, SimpleCommunicator};
use problems::commands::notice;
use std::panic::{self, PanicHookInfo};
use std::thread;
use std::time::Duration;

/// Exit status of a computation that failed.
pub const FAILED: i32 = 1;
/// Exit status of a single process that panics.
const PANICKED: i32 = 101;

/// Between messages of neighbouring processes that fail at once: the first ends the others before they say the same.
const PATIENCE: Duration = Duration::from_millis(20);
/// Longest time that a message waits.
const LONGEST_PATIENCE: Duration = Duration::from_secs(1);

/// Ends all processes with a status, after a message.
pub fn end_all(message: &str, status: i32) -> ! {
    notice(&format!("error: {message}"));
    if mpi::is_initialized() && !mpi::is_finalized() {
        SimpleCommunicator::world().abort(status);
    }
    std::process::exit(status)
}

/// From now on a panic in any thread of this process ends all processes: those that wait for it would wait for ever.
pub fn end_with_panics(rank: usize, size: usize) {
    panic::set_hook(Box::new(move |info: &PanicHookInfo<'_>| {
        let payload = info.payload();
        let message = payload.downcast_ref::<String>().map(String::as_str);
        let message = message.or_else(|| payload.downcast_ref().copied()).unwrap_or("no message");
        let place = info.location().map_or_else(String::new, |place| format!(" at {place}"));
        let patience = PATIENCE.saturating_mul(u32::try_from(rank).unwrap_or(u32::MAX));
        thread::sleep(patience.min(LONGEST_PATIENCE));
        end_all(&format!("process {rank} of {size} panicked{place}: {message}"), PANICKED);
    }));
}
