//! Long runs: every evaluation is kept on disk, and a run that ended for whatever reason continues bit by bit.
//!
//! An oracle that takes minutes is worth a journal. [`Journaled`] is the objective with one: every answer is appended
//! and synchronised before the method sees it, failed evaluations included. To continue, run the same program again.
//! The method begins at its start and is answered from the journal as long as it asks, bit by bit, for what was asked
//! for then; after that the oracle takes over with the restart data it had. If method and oracle are deterministic, the
//! end is that of a run that was never interrupted, and what an interruption costs is at most the evaluation that was
//! under way. Limits may be raised from one invocation to the next.
//!
//! ```
//! use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Journaled, Report, Vector};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = std::env::temp_dir().join(format!("nonsmooth-journal-example-{}", std::process::id()));
//! let run = |max_evaluations: usize| -> Result<Report, Box<dyn std::error::Error>> {
//!     let expensive = FnObjective::new(2, |x: &Vector| {
//!         (x[0].abs() + 2.0 * x[1] * x[1], Vector::from_vec(vec![x[0].signum(), 4.0 * x[1]]))
//!     });
//!     let theta = Journaled::open(expensive, &folder, "|x| + 2y²")?;
//!     println!("{} evaluations are in the journal", theta.held());
//!     let config = BundleTrustConfig { max_evaluations, ..BundleTrustConfig::default() };
//!     let mut report = BundleTrust::new(config)?.minimize(&theta, Vector::from_vec(vec![3.0, 2.0]))?;
//!     theta.complete(&mut report);
//!     Ok(report)
//! };
//! let first = run(5)?;
//! let continued = run(100)?;
//! assert_eq!(continued.history[4].value, first.history[4].value);
//! assert!(continued.value < 1e-6 && continued.warnings.is_empty());
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok(())
//! # }
//! ```
//!
//! # Files
//!
//! | file in the folder | what it holds |
//! |---|---|
//! | `journal.jsonl` | version, identity and dimension in the first line; an [`Entry`] in every other |
//! | `warm_start_K.json` | restart data of evaluation K: the last one, the one that it was restarted from, and those
//! behind a stored Jacobian |
//! | `linearization_K.bin` | outputs and Jacobian of evaluation K of a composite objective, with a checksum |
//!
//! Numbers are written so that they read back as the same bits; `"inf"`, `"-inf"` and `"NaN"` stand for what JSON
//! lacks. Restart data are written by their own `Serialize`, which JSON limits to finite numbers. A last line that is
//! not whole is cut off.
//!
//! # What goes wrong
//!
//! A journal of another objective is refused ([`JournalError`]). Everything after that is a warning
//! ([`Journaled::warnings`]), and the run goes on: lines that cannot be written are tried again with every evaluation;
//! restart data that are lost are replaced by none; a Jacobian whose file is lost or torn is computed again, to the
//! same bits; where a request differs from the recorded one, the rest of the journal is dropped and computed again.

mod contents;
mod entry;
mod error;
mod exact;
mod journaled;
mod linearization_file;
mod restart_files;
mod writer;

pub use contents::Journal;
pub use entry::{Entry, RecordedAnswer};
pub use error::JournalError;
pub use journaled::{Journaled, RestartData};
