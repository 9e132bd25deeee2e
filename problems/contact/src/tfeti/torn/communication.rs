//! What passes between the processes of a run, and nothing else does.
//!
//! Every process works on a range of subdomains: it assembles, factors and solves only those. Dual vectors (multipliers, rows
//! of B u) and the coarse problem are replicated, so that dot products, Newton's decisions and coarse solves are local and the
//! same everywhere. What travels are pieces that belong to one subdomain each:
//!
//! ```text
//! product with F, preconditioner:   values at the dofs with rows          once per product
//! contact stiffness, factor errors, sensitivities, displacements:         once per shape
//! resultants of tangents:                                                 once per column
//! ```
//! Every process then adds the pieces itself, in the order of the subdomains, as a single process does: results are the same to
//! the last bit for any number of processes.

use std::fmt::Debug;
use std::ops::Range;

/// One process of a run. All processes call the same functions in the same order.
pub trait Communication: Debug + Send + Sync {
    /// Whether there is no other process. The answer is the same in all processes.
    fn is_alone(&self) -> bool {
        false
    }

    /// The subdomains of this process, out of `count`; there may be none.
    fn owned(&self, count: usize) -> Range<usize>;

    /// Completes pieces of which `pieces[i]` belongs to subdomain i: those of other processes' subdomains are replaced by what these
    /// processes have set, in length too.
    fn share(&self, pieces: &mut [Vec<f64>]);

    /// The failure of the first process that reports one, known to all; none if no process has failed.
    fn agree(&self, failure: Option<String>) -> Option<String>;
}

/// All subdomains in this process: nothing has to travel.
#[derive(Debug, Clone, Copy, Default)]
pub struct InProcess;

impl Communication for InProcess {
    fn is_alone(&self) -> bool {
        true
    }

    fn owned(&self, count: usize) -> Range<usize> {
        0..count
    }

    fn share(&self, _pieces: &mut [Vec<f64>]) {}

    fn agree(&self, failure: Option<String>) -> Option<String> {
        failure
    }
}
