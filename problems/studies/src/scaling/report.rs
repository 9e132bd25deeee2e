//! Rows and their growth together: the JSON output.

use crate::scaling::growth::Growth;
use crate::scaling::rows::ScalingRow;
use serde::Serialize;

/// Everything measured in one run.
#[derive(Debug, Clone, Serialize)]
pub struct ScalingReport {
    /// Threads that the machine runs at once.
    pub machine_threads: usize,
    /// One entry per case and variant.
    pub rows: Vec<ScalingRow>,
    /// Growth at fixed H/h, per scene and variant.
    pub growth: Vec<Growth>,
    /// Messages about cases that could not be measured.
    pub failures: Vec<String>,
}

impl ScalingReport {
    /// A report over rows.
    pub fn new(rows: Vec<ScalingRow>, failures: Vec<String>) -> Self {
        let machine_threads = std::thread::available_parallelism().map_or(1, usize::from);
        let growth = Growth::of(&rows);
        Self { machine_threads, rows, growth, failures }
    }
}
