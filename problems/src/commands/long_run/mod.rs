//! Runs that can be continued: every evaluation is kept on disk, interruption ends a run orderly, a run continues bit
//! by bit.
//!
//! ```text
//! DIR/scene.toml, *.csv, start.json                              the run as stated                            folder.rs
//! DIR/journal.jsonl, warm_start_K.json, linearization_K.bin      every evaluation, restart data, Jacobians    nonsmooth::journal
//! ```
//! `--resume` reads the run as stated from the folder and runs it again; the journal answers as long as it lasts.

mod folder;
mod progress;
mod status;

pub use folder::RunFolder;
pub use progress::Progress;
pub use status::{StageLayer, StatusLine};
