//! What a command prints: never lost without a word.

use crate::commands::failure::Failure;
use crate::commands::file_limit::let_large_writes_fail;
use clap::{Error, Parser};
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

/// Prints the text of a command on stdout and the message of its failure on stderr; the exit status that belongs to
/// them. `kept`: the folder that holds the result too, if there is one.
pub fn finish(result: Result<String, Failure>, kept: Option<&Path>) -> ExitCode {
    let (text, mut status) = match &result {
        Ok(text) => (text.as_str(), 0),
        Err(Failure::Incomplete { text, status, .. }) => (text.as_str(), *status),
        Err(failure) => ("", failure.status()),
    };
    let printed = print(text);
    if let Err(failure) = &result {
        notice(&format!("error: {failure}"));
    }
    match (printed, kept) {
        (Ok(()), _) => {}
        (Err(error), Some(folder)) if error.kind() == CLOSED => {
            notice(&format!("warning: stdout: {error}; the result is in {}", folder.display()));
        }
        (Err(error), _) => {
            notice(&format!("error: stdout: {error}; the result was not printed"));
            status = if status == 0 { 1 } else { status };
        }
    }
    ExitCode::from(status)
}

/// Prints the message of a failure on stderr; its exit status.
pub fn print_failure(failure: &Failure) -> ExitCode {
    notice(&format!("error: {failure}"));
    ExitCode::from(failure.status())
}

/// The kind of the error of a stdout that was closed from the beginning.
const CLOSED: io::ErrorKind = io::ErrorKind::NotConnected;

/// Prints a text on stdout.
///
/// # Errors
/// The system's reason, and a stdout that was closed from the beginning.
pub fn print(text: &str) -> io::Result<()> {
    if !text.is_empty() && is_closed() {
        return Err(io::Error::new(CLOSED, "it is closed"));
    }
    let mut stdout = io::stdout();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush())
}

/// A line on stderr. Where nobody listens there is nothing to be done.
pub fn notice(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Whether stdout was closed when the program began. What starts a program then opens /dev/null in its place, for
/// reading and writing, while `> /dev/null` opens it for writing alone.
#[cfg(target_os = "linux")]
fn is_closed() -> bool {
    let null = std::fs::read_link("/proc/self/fd/1").is_ok_and(|target| target == Path::new("/dev/null"));
    let state = std::fs::read_to_string("/proc/self/fdinfo/1").unwrap_or_default();
    let flags = state.lines().find_map(|line| line.strip_prefix("flags:"));
    let flags = flags.and_then(|octal| u32::from_str_radix(octal.trim(), 8).ok());
    null && flags.is_some_and(|flags| flags & ACCESS_MODE == READ_AND_WRITE)
}

/// Other systems do not tell.
#[cfg(not(target_os = "linux"))]
fn is_closed() -> bool {
    false
}

/// The bits of the flags of an open file that hold its access mode.
#[cfg(target_os = "linux")]
const ACCESS_MODE: u32 = 0b11;
/// The access mode of a file opened for reading and writing.
#[cfg(target_os = "linux")]
const READ_AND_WRITE: u32 = 0b10;

/// The arguments of a binary; ends the program where they ask for help or are wrong.
pub fn arguments<A: Parser>() -> A {
    let_large_writes_fail();
    A::try_parse().unwrap_or_else(|error| leave(&error))
}

/// Prints help, version or what is wrong with the arguments, and ends the program.
pub fn leave(error: &Error) -> ! {
    std::process::exit(i32::from(said(error)))
}

/// As [`leave`], for a program that has to end in another way.
pub fn left(error: &Error) -> ExitCode {
    ExitCode::from(said(error))
}

/// Prints help, version or what is wrong with the arguments; the exit status.
fn said(error: &Error) -> u8 {
    // What the parser prints itself is not flushed before the end.
    let text = error.render().to_string();
    let printed = if error.use_stderr() { write!(io::stderr(), "{text}") } else { print(&text) };
    let status = if error.exit_code() == 0 { 0 } else { BAD_INPUT };
    match printed {
        Ok(()) => status,
        Err(reason) => {
            notice(&format!("error: stdout: {reason}; the result was not printed"));
            status.max(1)
        }
    }
}

/// Exit status of wrong arguments.
const BAD_INPUT: u8 = 2;
