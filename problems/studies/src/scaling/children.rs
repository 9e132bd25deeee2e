//! One process per case and variant: each has a peak memory of its own.

use crate::scaling::cases::{Case, SceneName, Variant, word};
use crate::scaling::report::Report;
use crate::scaling::row::Row;
use problems::commands::Failure;
use std::process::{Command, Stdio};

/// Measures a case in a process of this binary.
///
/// # Errors
/// [`Failure`] with the text of the process; of bad input when it exits with status 2.
pub fn row(scene: SceneName, case: Case, variant: Variant) -> Result<Row, Failure> {
    let name = format!("{} {case} {}", word(&scene), word(&variant));
    let failed = |reason: String| Failure::Computation(format!("{name}: {reason}"));
    let binary = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
    let output = Command::new(binary)
        .args(["--scene", &word(&scene), "--case", &case.to_string(), "--variant", &word(&variant), "--json"])
        .stdin(Stdio::null())
        .output()
        .map_err(|error| failed(error.to_string()))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        let reason = format!("{name}: {} ({})", text.trim(), output.status);
        return Err(if output.status.code() == Some(2) {
            Failure::Input(reason)
        } else {
            Failure::Computation(reason)
        });
    }
    let report: Report = serde_json::from_slice(&output.stdout).map_err(|error| failed(error.to_string()))?;
    report.rows.into_iter().next().ok_or_else(|| failed("no row was printed".into()))
}
