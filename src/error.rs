//! Error types of the framework: what, where, the value found, what is allowed.

use thiserror::Error;

/// Input that cannot be worked with; nothing has been computed yet.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum InputError {
    /// A vector or matrix has the wrong size.
    #[error("{what} has {found} entries, expected {expected}")]
    Dimension {
        /// Name of the vector or matrix.
        what: &'static str,
        /// The size it must have.
        expected: usize,
        /// The size it has.
        found: usize,
    },
    /// An entry is NaN or infinite.
    #[error("{what}: entry {index} is {value}, expected a finite number")]
    NotFinite {
        /// The vector or matrix that holds the entry.
        what: &'static str,
        /// Position of the entry.
        index: usize,
        /// The offending value.
        value: f64,
    },
    /// A lower bound lies above its upper bound.
    #[error("{what} {index}: lower bound {lower} exceeds upper bound {upper}")]
    EmptyInterval {
        /// `variable` or `row`.
        what: &'static str,
        /// Position of the interval.
        index: usize,
        /// Lower bound found.
        lower: f64,
        /// Upper bound found.
        upper: f64,
    },
    /// A setting is outside its admissible range.
    #[error("{setting} = {value} is not allowed; allowed: {allowed}")]
    OutOfRange {
        /// Name of the setting.
        setting: &'static str,
        /// Value found, as text.
        value: String,
        /// Admissible values, as text.
        allowed: &'static str,
    },
}

/// Why an oracle (state solver, coderivative, objective) has no answer at a point.
///
/// The engine treats every variant as "shorten the step", except [`Interrupted`](Self::Interrupted) and
/// [`Contradiction`](Self::Contradiction), which end the run at once; otherwise the run ends only when failures repeat.
/// The report has the best point and the whole history.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OracleError {
    /// The point lies outside the domain of the objective (an inverted element, a negative argument of a logarithm).
    #[error("outside the domain: {reason}")]
    OutsideDomain {
        /// What left the domain, where, and by how much.
        reason: String,
    },
    /// An iterative solver did not reach the accuracy asked for.
    #[error("{solver} did not converge: residual {residual:.3e} after {iterations} iterations")]
    NotConverged {
        /// Name of the solver.
        solver: &'static str,
        /// Relative residual reached.
        residual: f64,
        /// Number of iterations of the solver.
        iterations: usize,
    },
    /// Value or subgradient is not finite.
    #[error("{what} is not finite")]
    NotFinite {
        /// `value`, or the name of the vector.
        what: &'static str,
    },
    /// Value or subgradient is finite, but too large to compute with beside the others.
    #[error("{what} of size {size:.1e} is too large to compute with; allowed: {allowed:.1e}")]
    TooLarge {
        /// `value` or `subgradient`.
        what: &'static str,
        /// Size of the value or the dual norm of the subgradient.
        size: f64,
        /// The largest size that is allowed.
        allowed: f64,
    },
    /// The user's code panicked; the payload's text is kept.
    #[error("the objective panicked: {message}")]
    Panicked {
        /// Text of the panic.
        message: String,
    },
    /// The answer has a wrong size, or an entry that is not finite: a Jacobian among others.
    #[error(transparent)]
    Input(InputError),
    /// The answer contradicts an earlier one of the same oracle: its number of outputs is another one. The run ends at
    /// once with [`Termination::OracleContradiction`](crate::Termination::OracleContradiction).
    #[error("the oracle contradicts its earlier answers: {0}")]
    Contradiction(#[source] InputError),
    /// The caller wants the run to end: nothing is wrong with the point. The run ends at once with
    /// [`Termination::StoppedByObserver`](crate::Termination::StoppedByObserver); the evaluation does not count, and no
    /// journal keeps it.
    #[error("the evaluation was interrupted")]
    Interrupted,
    /// Any other failure of the problem behind the oracle.
    #[error("{0}")]
    Failed(#[source] Box<dyn std::error::Error + Send + Sync>),
}

impl From<InputError> for OracleError {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

/// Why a run could not begin. Everything that happens after the first evaluation ends in a report instead.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OptimizeError {
    /// Sizes or numbers that cannot be worked with.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The admissible set is empty.
    #[error("the admissible set is empty: the constraints contradict each other by {violation:.3e} (relative)")]
    Infeasible {
        /// Relative violation that remains.
        violation: f64,
    },
    /// The first evaluation failed; there is no point to return.
    #[error("the first evaluation failed: {0}")]
    Oracle(#[source] OracleError),
}
