//! Time and memory of a state and its subgradient on many machines, from figures of one core and of a network.
//!
//! ```text
//! machine (measured) ─┐
//! network (options) ──┼─ prediction per number of ranks ─ table
//! run: ranks, subdomains per rank, with or without clusters ─┘
//! ```

mod interface;
mod machine;
mod prediction;
mod report;

pub use machine::Machine;
pub use prediction::{Network, Prediction, Workload};
pub use report::{ModelReport, Options, report};
