//! Ctrl-C and requests to terminate.

use crate::commands::output::notice;
use std::sync::Once;
use std::sync::atomic::{AtomicUsize, Ordering};

static INTERRUPTS: AtomicUsize = AtomicUsize::new(0);

/// Exit status of a run that was interrupted: 128 and the number of the signal, as shells have it.
pub const STATUS: u8 = 130;

/// From now on the first Ctrl-C (or request to terminate) is remembered, the second ends the program at once. `said`: what happens
/// next is said at once.
pub fn watch_interrupts(said: bool) {
    // Several runs of one process share the handler.
    static WATCHED: Once = Once::new();
    WATCHED.call_once(|| {
        let handler = move || {
            if INTERRUPTS.fetch_add(1, Ordering::SeqCst) > 0 {
                std::process::exit(i32::from(STATUS));
            }
            if said {
                notice("interrupted: the current evaluation is finished first; once more ends the program at once");
            }
        };
        // A program that has its own handler keeps it.
        if let Err(error) = ctrlc::set_handler(handler) {
            tracing::warn!("Ctrl-C is not watched: {error}");
        }
    });
}

/// Whether an interruption was asked for.
pub fn interrupted() -> bool {
    INTERRUPTS.load(Ordering::SeqCst) > 0
}
