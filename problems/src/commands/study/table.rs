//! The table of a study as text, as comma-separated values and as JSON.

use crate::commands::output::pressure;
use crate::commands::study::plan::Plan;
use crate::commands::study::row::{Outcome, Row, Solved};
use crate::commands::study::varied::{Varied, parts};
use serde::Serialize;
use std::fmt;

/// The keys of the JSON of `study`.
#[derive(Debug, Serialize)]
pub struct StudyJson {
    /// What is varied, in the order of the options of every row; the last one changes fastest.
    vary: Vec<Varied>,
    /// Whether every row was optimized.
    optimize: bool,
    /// Number of rows of the whole study.
    rows_in_all: usize,
    /// Number of rows without a result.
    failures: usize,
    /// The rows so far.
    rows: Vec<Row>,
}

impl StudyJson {
    /// The rows so far of a study of `rows_in_all`.
    pub fn new(plan: &Plan, rows: Vec<Row>, rows_in_all: usize) -> Self {
        let failures = rows.iter().filter(|row| matches!(row.outcome, Outcome::Failed(_))).count();
        Self { vary: plan.vary.clone(), optimize: plan.optimize, rows_in_all, failures, rows }
    }

    /// Whether no row has a result.
    pub fn all_failed(&self) -> bool {
        self.failures == self.rows.len() && self.failures > 0
    }

    /// What is varied.
    pub fn vary(&self) -> &[Varied] {
        &self.vary
    }

    /// Number of rows of the whole study.
    pub fn rows_in_all(&self) -> usize {
        self.rows_in_all
    }

    /// The rows so far.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Names of the columns of the table.
    pub fn head(&self) -> Vec<String> {
        let mut head: Vec<String> = self.vary.iter().map(|varied| varied.name().to_owned()).collect();
        if self.optimize {
            head.extend(["objective at start", "peak at start, MPa"].map(str::to_owned));
        }
        head.extend(["objective", "peak, MPa", "contact area, mm²", "open", "stick", "slip"].map(str::to_owned));
        if self.optimize {
            head.extend(["evaluations", "ended"].map(str::to_owned));
        }
        head.push("warnings".to_owned());
        head
    }

    /// The cells of a row; a failed one has its reason in the first cell after the values.
    pub fn cells(&self, row: &Row) -> Vec<String> {
        let mut cells = values(row);
        match &row.outcome {
            Outcome::Failed(reason) => cells.push(reason.clone()),
            Outcome::Solved(solved) => cells.extend(self.result(solved)),
        }
        cells
    }

    fn result(&self, solved: &Solved) -> Vec<String> {
        let mut cells = Vec::new();
        let run = solved.optimization.as_ref();
        cells.extend(run.map(|run| format!("{:.6e}", run.objective_start)));
        cells.extend(run.map(|run| pressure(run.peak_pressure_start)));
        let status = &solved.status;
        cells.push(format!("{:.6e}", solved.objective));
        cells.push(pressure(solved.peak_pressure));
        cells.push(format!("{:.1}", solved.contact_area));
        cells.extend([status.open, status.stick, status.slip].map(|count| count.to_string()));
        cells.extend(run.map(|run| run.evaluations.to_string()));
        cells.extend(run.map(|run| if run.confirmed { "confirmed".into() } else { run.termination.clone() }));
        cells.push(if solved.warnings.is_empty() { "–".into() } else { solved.warnings.join(", ") });
        cells
    }

    /// Comma-separated values with all digits, one line per row.
    pub fn csv(&self) -> String {
        let mut table: String =
            self.vary.iter().map(|varied| format!("{},", varied.name().replace('-', "_"))).collect();
        table += "objective_start,peak_pressure_start,objective,peak_pressure,contact_area,total_normal_force,open,stick,slip,evaluations,confirmed,warnings,seconds,reason\n";
        for row in &self.rows {
            table += &values(row).iter().map(|value| format!("{value},")).collect::<String>();
            table += &match &row.outcome {
                Outcome::Failed(reason) => {
                    format!(",,,,,,,,,,,,{},\"{}\"\n", row.seconds, reason.replace('"', "\"\"").replace('\n', " "))
                }
                Outcome::Solved(solved) => line(solved, row.seconds),
            };
        }
        table
    }
}

/// The folder of a row, by its number from 1.
pub fn row_folder(number: usize) -> String {
    format!("row_{number:03}")
}

/// The values of a row, without the names of its options.
pub fn values(row: &Row) -> Vec<String> {
    row.options.iter().map(|option| parts(option).1.to_owned()).collect()
}

fn line(solved: &Solved, seconds: f64) -> String {
    let Solved { objective, peak_pressure, contact_area, total_normal_force, status, optimization, .. } = solved;
    let start = optimization
        .as_ref()
        .map_or_else(|| ",".to_owned(), |run| format!("{},{}", run.objective_start, run.peak_pressure_start));
    let end =
        optimization.as_ref().map_or_else(|| ",".to_owned(), |run| format!("{},{}", run.evaluations, run.confirmed));
    let warnings = solved.warnings.join(" ");
    let [open, stick, slip] = [status.open, status.stick, status.slip];
    format!(
        "{start},{objective},{peak_pressure},{contact_area},{total_normal_force},{open},{stick},{slip},{end},{warnings},{seconds},\n"
    )
}

/// Columns side by side, a line per row.
impl fmt::Display for StudyJson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = self.head();
        let rows: Vec<Vec<String>> = self.rows.iter().map(|row| self.cells(row)).collect();
        let count = |cell: &String| cell.chars().count();
        // The reason of a failed row runs over the columns behind it, and the last column over the end.
        let whole = rows.iter().filter(|cells| cells.len() == head.len());
        let mut widths: Vec<usize> = head.iter().map(count).collect();
        for cells in whole {
            for (width, cell) in widths.iter_mut().zip(cells) {
                *width = (*width).max(count(cell));
            }
        }
        for cells in std::iter::once(&head).chain(&rows) {
            let last = cells.len() - 1;
            let padded = cells.iter().zip(&widths).enumerate().map(|(index, (cell, &width))| match index {
                index if index == last && cells.len() != head.len() => cell.clone(),
                _ => format!("{cell:>width$}"),
            });
            writeln!(f, "{}", padded.collect::<Vec<_>>().join("  "))?;
        }
        let (done, all) = (self.rows.len(), self.rows_in_all);
        writeln!(f, "rows:        {done} of {all}, {} failed", self.failures)
    }
}
