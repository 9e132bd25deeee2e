//! The failures of a command, each with its exit status.

use contact::error::{ContactError, SceneError};
use nonsmooth::verify::VerifyError;
use nonsmooth::{InputError, JournalError, OptimizeError, OracleError};
use std::io::{self, Write};
use std::process::ExitCode;
use thiserror::Error;

/// A failed command.
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
        /// The result.
        text: String,
        /// The message about it.
        reason: String,
        /// Exit status.
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

    /// The text for stdout after files were written; a file that could not be written does not lose the text.
    ///
    /// # Errors
    /// [`Failure::Incomplete`] with the text if a file could not be written.
    pub fn printed_with_files(text: String, written: Result<(), Self>) -> Result<String, Self> {
        match written {
            Ok(()) => Ok(text),
            Err(failure) => {
                let reason = format!("{failure}; the report above is complete");
                Err(Self::Incomplete { text, reason, status: 1 })
            }
        }
    }

    /// The same failure after a text for stdout is there already, so that the text is not lost.
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

/// Prints the text of a command on stdout and the message of its failure on stderr; the exit status that belongs to them.
pub fn finish(result: Result<String, Failure>) -> ExitCode {
    let text = match &result {
        Ok(text) | Err(Failure::Incomplete { text, .. }) => text,
        Err(_) => "",
    };
    // A reader that closes the pipe early has seen what it wanted; then the exit status is the message.
    let _ = io::stdout().write_all(text.as_bytes());
    let Err(failure) = result else { return ExitCode::SUCCESS };
    let _ = writeln!(io::stderr(), "error: {failure}");
    ExitCode::from(failure.status())
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<JournalError> for Failure {
    fn from(error: JournalError) -> Self {
        Self::Input(error.to_string())
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
            OracleError::OutsideDomain { .. } => Self::Input(text),
            OracleError::Failed(source)
                if source.is::<InputError>()
                    || matches!(source.downcast_ref(), Some(ContactError::NoEquilibrium { .. })) =>
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

impl From<VerifyError> for Failure {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Input(error) => error.into(),
            VerifyError::Oracle(error) => error.into(),
            _ => Self::Computation(error.to_string()),
        }
    }
}
