//! Ctrl-C and requests to terminate. A hangup is none: it ends the program, or nothing happens where `nohup` started
//! it.

use crate::commands::output::notice;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::io;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Exit status of a run that was interrupted: 128 and the number of the signal, as shells have it.
pub const STATUS: u8 = 130;

/// The signals that ask for an end.
const REQUESTS: [i32; 2] = [SIGINT, SIGTERM];
/// Further requests within one to two of these times after the first one are the same: what sends a request twice at
/// once, as `timeout` does, sends one.
const PATIENCE: Duration = Duration::from_millis(50);

/// Whether an end was asked for.
static REQUESTED: AtomicBool = AtomicBool::new(false);
/// Whether the next request ends the program at once.
static ANSWERED: AtomicBool = AtomicBool::new(false);

/// From now on a request to end is kept, and a second one ends the program at once. `said`: what happens next is said.
pub fn watch_interrupts(said: bool) {
    // Several runs of one process share what watches.
    static WATCHED: Once = Once::new();
    WATCHED.call_once(|| {
        let watch = |signal| -> io::Result<()> {
            flag::register_conditional_shutdown(signal, i32::from(STATUS), &ANSWERED)?;
            flag::register(signal, &REQUESTED)?;
            Ok(())
        };
        let answer = move || {
            while !interrupted() {
                thread::sleep(PATIENCE);
            }
            thread::sleep(PATIENCE);
            // The words promise what the next request does.
            ANSWERED.store(true, Ordering::SeqCst);
            if said {
                notice("interrupted: the current evaluation is finished first; once more ends the program at once");
            }
        };
        let watched = REQUESTS.into_iter().try_for_each(watch);
        if let Err(error) = watched.and_then(|()| thread::Builder::new().spawn(answer).map(|_| ())) {
            tracing::warn!("Ctrl-C is not watched: {error}");
        }
    });
}

/// Whether an interruption was asked for.
pub fn interrupted() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// From now on requests to end do nothing here: another process gets them too, and decides what follows.
pub fn leave_interrupts() {
    static LEFT: AtomicBool = AtomicBool::new(false);
    // Nothing is lost where it cannot be done: the process then ends.
    for signal in REQUESTS {
        let _ = flag::register(signal, &LEFT);
    }
}
