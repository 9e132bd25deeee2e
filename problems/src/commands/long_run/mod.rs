//! Runs that survive: every evaluation is kept on disk, interruption ends a run orderly, a run continues bit by bit.
//!
//! ```text
//! DIR/scene.toml, *.csv, start.json     the run as stated                       folder.rs
//! DIR/journal.jsonl                     every evaluation: point, answer         journal.rs
//! DIR/warm_start_K.bin                  restart data of the center's and the last evaluation
//! DIR/snapshot.json                     the optimizer's state after every serious step (nonsmooth::Snapshot)
//! ```
//! `--resume` runs the optimizer from its start and answers from the journal as long as that lasts: the optimizer is
//! deterministic and costs nothing beside the contact problem, so that it arrives where it was, and the next evaluation
//! starts from the same restart data as in a run that was never interrupted.

mod folder;
mod interrupt;
mod journal;
mod journaled;
mod progress;
mod status;
mod warm_start;

pub use folder::{COMPARED, RunFolder};
pub use interrupt::{STATUS, interrupted, watch_interrupts};
pub use journal::{Entry, Journal, Outcome, parse as parse_journal};
pub use journaled::{Journaled, Kept};
pub use progress::Progress;
pub use status::{StageLayer, StatusLine};
