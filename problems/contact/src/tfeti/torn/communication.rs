//! What passes between the processes of a run, and nothing else does.
//!
//! Every process works on a range of subdomains: it assembles, factors and solves only those. Dual vectors (multipliers, rows
//! of B u) and the coarse problem are replicated, so that dot products, Newton's decisions and coarse solves are local and the
//! same everywhere; what has to travel are contributions to rows, a few sums, and sensitivities.
//!
//! ```text
//! exchange:  rows of B (own torn displacements)   →  sums over all processes       (neighbours only, in a distributed run)
//! sum:       short vectors (stiffness, heights)   →  sums over all processes     (and nodal displacements, if asked for)
//! ```
//! A sum must come out the same on every process; implementations add in the order of ranks.

use std::fmt::Debug;
use std::ops::Range;

/// One process of a run.
pub trait Communication: Debug + Send + Sync {
    /// The subdomains of this process, out of `count`.
    fn owned(&self, count: usize) -> Range<usize>;

    /// Replaces contributions to the rows of B by their sums over all processes. Only processes whose subdomains share a row
    /// have to talk to each other about it.
    fn exchange(&self, rows: &mut [f64]);

    /// Replaces a short vector by its sum over all processes.
    fn sum(&self, values: &mut [f64]);
}

/// All subdomains in this process: nothing has to travel.
#[derive(Debug, Clone, Copy, Default)]
pub struct InProcess;

impl Communication for InProcess {
    fn owned(&self, count: usize) -> Range<usize> {
        0..count
    }

    fn exchange(&self, _rows: &mut [f64]) {}

    fn sum(&self, _values: &mut [f64]) {}
}
