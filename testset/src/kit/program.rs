//! Programs that a test runs to their end, and the files they leave.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A folder that is removed with the returned value.
///
/// # Panics
/// When the system has no place for it.
pub fn scratch() -> TempDir {
    tempfile::tempdir().expect("a scratch folder")
}

/// A path as text.
///
/// # Panics
/// When it is no Unicode.
pub fn text(path: &Path) -> &str {
    path.to_str().expect("a path in Unicode")
}

/// A program with arguments, its output kept for the test, without the logging and the locale that the environment may
/// ask for.
pub fn command(program: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    command
        .args(arguments)
        .env_remove("RUST_LOG")
        .env("LC_ALL", "C.UTF-8")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// Runs a program to its end.
///
/// # Panics
/// When it does not start.
pub fn run(program: &str, arguments: &[&str]) -> Output {
    command(program, arguments).output().expect("the program starts")
}

/// What a program printed on stderr.
pub fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The JSON that a successful program printed.
///
/// # Panics
/// When it failed, or printed something else.
pub fn parsed(output: &Output) -> Value {
    assert!(output.status.success(), "{}: {}", output.status, errors(output));
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", errors(output)))
}

/// Runs a program that succeeds and prints JSON.
///
/// # Panics
/// When it does not.
pub fn json(program: &str, arguments: &[&str]) -> Value {
    parsed(&run(program, arguments))
}

/// Runs a program that must refuse its input: exit status 2, nothing on stdout, all words in the message.
///
/// # Panics
/// When it behaves otherwise.
pub fn refused(program: &str, arguments: &[&str], words: &[&str]) {
    let output = run(program, arguments);
    let message = errors(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed on stdout");
    for word in words {
        assert!(message.contains(word), "{arguments:?}: {word:?} not in {message}");
    }
}

/// The numbers of a file of rows of numbers, one after the other.
///
/// # Panics
/// When it cannot be read as one.
pub fn read_rows(path: &Path) -> Value {
    let rows: Vec<Vec<f64>> = serde_json::from_value(read_json(path)).unwrap_or_else(|error| panic!("{error}"));
    rows.concat().into()
}

/// A JSON file.
///
/// # Panics
/// When it cannot be read as one.
pub fn read_json(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_slice(&bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
