//! The failures of a command, each with its exit status.

use contact::error::{ContactError, SceneError};
use nonsmooth::verify::VerifyError;
use nonsmooth::{InputError, JournalError, OptimizeError, OracleError, Termination};
use scene_file::optimization::OptimizationError;
use thiserror::Error;

/// The reason for which a command failed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Failure {
    /// Bad input: exit status 2.
    #[error("{0}")]
    Input(String),
    /// The computation failed: exit status 1.
    #[error("{0}")]
    Computation(String),
    /// The result for stdout is there, but something is to be said about it.
    #[error("{reason}")]
    Incomplete {
        /// The result for stdout.
        text: String,
        /// The message about it.
        reason: String,
        /// The exit status of the program.
        status: u8,
    },
}

impl Failure {
    /// A failed computation, for the reason that an error gives.
    pub fn computation(error: impl std::fmt::Display) -> Self {
        Self::Computation(error.to_string())
    }

    /// 2 for bad input, 1 for a failed computation, 130 for an interrupted one.
    pub fn status(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Computation(_) => 1,
            Self::Incomplete { status, .. } => *status,
        }
    }

    /// Adds a text for stdout that exists already to a failure, so that the text is not lost.
    #[must_use]
    pub fn after(self, printed: &str) -> Self {
        let status = self.status();
        match self {
            failure if printed.is_empty() => failure,
            Self::Incomplete { text, reason, .. } => {
                Self::Incomplete { text: format!("{printed}{text}"), reason, status }
            }
            other => Self::Incomplete { text: printed.to_owned(), reason: other.to_string(), status },
        }
    }
}

/// The refusal of an option that is given where it has no meaning.
///
/// # Errors
/// [`Failure::Input`], always.
pub fn refused(option: &str, allowed: &str) -> Result<(), Failure> {
    Err(Failure::Input(format!("{option} is allowed {allowed}")))
}

/// The end of a run in words, if failures of the oracle or of the subproblem ended it; none for every other end.
pub fn failed(termination: &Termination) -> Option<String> {
    let failed = matches!(
        termination,
        Termination::OracleFailing { .. }
            | Termination::OracleContradiction { .. }
            | Termination::SubproblemFailed { .. }
    );
    failed.then(|| termination.to_string())
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<ContactError> for Failure {
    fn from(error: ContactError) -> Self {
        Self::computation(error)
    }
}

impl From<JournalError> for Failure {
    fn from(error: JournalError) -> Self {
        match error {
            JournalError::File { .. } => Self::Computation(error.to_string()),
            _ => Self::Input(error.to_string()),
        }
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<OracleError> for Failure {
    fn from(error: OracleError) -> Self {
        let text = error.to_string();
        match error {
            OracleError::OutsideDomain { .. } | OracleError::Input(_) => Self::Input(text),
            OracleError::Failed(source)
                if matches!(
                    source.downcast_ref(),
                    Some(ContactError::NoEquilibrium { .. } | ContactError::FrictionTooWeak { .. })
                ) =>
            {
                Self::Input(text)
            }
            _ => Self::Computation(text),
        }
    }
}

impl From<OptimizeError> for Failure {
    fn from(error: OptimizeError) -> Self {
        match error {
            OptimizeError::Oracle(source) => source.into(),
            OptimizeError::Input(_) | OptimizeError::Infeasible { .. } => Self::Input(error.to_string()),
            _ => Self::Computation(error.to_string()),
        }
    }
}

impl From<OptimizationError> for Failure {
    fn from(error: OptimizationError) -> Self {
        match error {
            OptimizationError::Scene(error) => error.into(),
            OptimizationError::Run(error) => error.into(),
            error => Self::computation(error),
        }
    }
}

impl From<VerifyError> for Failure {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Input(error) => error.into(),
            VerifyError::Oracle(error) => error.into(),
            _ => Self::Computation(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_an_end_by_a_failure_is_one() {
        let last = "an element is inverted".to_owned();
        let words = failed(&Termination::OracleFailing { failures: 10, last: last.clone() }).expect("a failure");
        assert!(words.contains(&last), "{words}");
        assert!(failed(&Termination::SubproblemFailed { reason: last }).is_some());
        let limits =
            [Termination::EvaluationLimit, Termination::TimeLimit, Termination::Stationary { radius: 0.0, gap: None }];
        assert!(limits.iter().all(|end| failed(end).is_none()));
    }
}
