//! What the system tells a program by signals: requests to end, and files that reach their limit.

use crate::commands::output::notice;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Once};
use std::thread;
use std::time::Duration;

/// Exit status of a run that was interrupted: 128 and the number of the signal, as shells have it.
pub const STATUS: u8 = 130;

/// Ctrl-C, and a request to terminate. A hangup is none: it ends the program, or nothing happens where `nohup` started it.
const REQUESTS: [i32; 2] = [SIGINT, SIGTERM];
/// Longest time between a request and the words about it.
const PATIENCE: Duration = Duration::from_millis(50);

static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// From now on the first request to end is remembered, the second ends the program at once. `said`: what happens next is said at once.
pub fn watch_interrupts(said: bool) {
    // Several runs of one process share what watches.
    static WATCHED: Once = Once::new();
    WATCHED.call_once(|| {
        let watch = |signal| -> io::Result<()> {
            // In this order: the first request finds the flag unset.
            flag::register_conditional_shutdown(signal, i32::from(STATUS), Arc::clone(&REQUESTED))?;
            flag::register(signal, Arc::clone(&REQUESTED))?;
            Ok(())
        };
        if let Err(error) = REQUESTS.into_iter().try_for_each(watch) {
            tracing::warn!("Ctrl-C is not watched: {error}");
        }
        if said {
            thread::spawn(|| {
                while !interrupted() {
                    thread::sleep(PATIENCE);
                }
                notice("interrupted: the current evaluation is finished first; once more ends the program at once");
            });
        }
    });
}

/// Whether an interruption was asked for.
pub fn interrupted() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// From now on requests to end do nothing here: another process gets them too, and decides what follows.
pub fn leave_interrupts() {
    // Nothing is lost where it cannot be done: the process then ends.
    for signal in REQUESTS {
        let _ = flag::register(signal, Arc::default());
    }
}

/// From now on a write beyond the limit on the size of files (`ulimit -f`) fails like one to a full disk. Left alone, the system ends the
/// program by SIGXFSZ, without a word.
#[cfg(unix)]
pub fn let_large_writes_fail() {
    if let Err(error) = flag::register(signal_hook::consts::SIGXFSZ, Arc::default()) {
        tracing::warn!("a limit on the size of files ends the program: {error}");
    }
}

/// Other systems have no such limit.
#[cfg(not(unix))]
pub fn let_large_writes_fail() {}
