//! The table of a study as text, as comma-separated values and as JSON.

use crate::commands::facts::{Value, aligned, line};
use crate::commands::numbers::exact;
use crate::commands::study::plan::Plan;
use crate::commands::study::row::{Optimized, Outcome, Row, Solved};
use crate::commands::study::varied::Varied;
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

    /// The rows so far.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Names of the columns of the table.
    pub fn head(&self) -> Vec<String> {
        let varied = self.vary.iter().map(|varied| varied.name().to_owned());
        varied.chain(self.shown().map(|column| column.name.to_owned())).collect()
    }

    /// The cells of a row; a failed one has its reason in the first cell after the values.
    pub fn cells(&self, row: &Row) -> Vec<String> {
        let mut cells = values(row);
        match &row.outcome {
            Outcome::Failed(reason) => cells.push(reason.clone()),
            Outcome::Solved(solved) => cells.extend(self.shown().map(|column| (column.value)(solved).shown())),
        }
        cells
    }

    /// The columns that people read.
    fn shown(&self) -> impl Iterator<Item = &'static Column> {
        COLUMNS.iter().filter(|column| !column.name.is_empty() && (self.optimize || !column.of_run))
    }

    /// Comma-separated values with all digits, one line per row.
    pub fn csv(&self) -> String {
        let varied = self.vary.iter().map(|varied| varied.name().replace('-', "_"));
        let columns: Vec<&Column> = COLUMNS.iter().filter(|column| !column.key.is_empty()).collect();
        let keys = columns.iter().map(|column| column.key.to_owned());
        let head: Vec<String> = varied.chain(keys).chain(["seconds", "reason"].map(str::to_owned)).collect();
        let mut table = head.join(",") + "\n";
        for row in &self.rows {
            let (cells, reason): (Vec<String>, String) = match &row.outcome {
                Outcome::Failed(reason) => {
                    let reason = format!("\"{}\"", reason.replace('"', "\"\"").replace('\n', " "));
                    (vec![String::new(); columns.len()], reason)
                }
                Outcome::Solved(solved) => {
                    (columns.iter().map(|column| cell(&(column.value)(solved))).collect(), String::new())
                }
            };
            let cells = values(row).into_iter().chain(cells).chain([exact(row.seconds), reason]);
            table += &(cells.collect::<Vec<_>>().join(",") + "\n");
        }
        table
    }

    /// How many rows there are of how many, and what did not succeed.
    pub fn counted(&self) -> String {
        let unchanged = self.rows.iter().filter(|row| row.is_unchanged()).count();
        let unchanged = if unchanged == 0 { String::new() } else { format!(", {unchanged} found no better shape") };
        format!("{} of {}, {} failed{unchanged}", self.rows.len(), self.rows_in_all, self.failures)
    }
}

/// A column of the table behind those of the options.
struct Column {
    /// Its name in the comma-separated values, with its unit.
    key: &'static str,
    /// Its name for people; empty in the comma-separated values only.
    name: &'static str,
    /// Whether only rows that were optimized have it.
    of_run: bool,
    value: fn(&Solved) -> Value,
}

/// A column of a row that was optimized.
fn of_run(solved: &Solved, value: fn(&Optimized) -> Value) -> Value {
    solved.optimization.as_ref().map_or(Value::Missing, value)
}

/// The columns; the two on the start come first.
const COLUMNS: &[Column] = &[
    Column {
        key: "objective_start",
        name: "objective at start",
        of_run: true,
        value: |solved| of_run(solved, |run| run.objective_start.into()),
    },
    Column {
        key: "peak_pressure_start_MPa",
        name: "peak at start, MPa",
        of_run: true,
        value: |solved| of_run(solved, |run| run.peak_pressure_start.into()),
    },
    Column { key: "objective", name: "objective", of_run: false, value: |solved| solved.objective.into() },
    Column { key: "objective_unit", name: "", of_run: false, value: |solved| solved.objective_unit.clone().into() },
    Column { key: "peak_pressure_MPa", name: "peak, MPa", of_run: false, value: |solved| solved.peak_pressure.into() },
    Column {
        key: "contact_area_mm2",
        name: "contact area, mm²",
        of_run: false,
        value: |solved| solved.contact_area.into(),
    },
    Column { key: "total_normal_force_N", name: "", of_run: false, value: |solved| solved.total_normal_force.into() },
    Column { key: "open", name: "open", of_run: false, value: |solved| solved.status.open.into() },
    Column { key: "stick", name: "stick", of_run: false, value: |solved| solved.status.stick.into() },
    Column { key: "slip", name: "slip", of_run: false, value: |solved| solved.status.slip.into() },
    Column {
        key: "evaluations",
        name: "evaluations",
        of_run: true,
        value: |solved| of_run(solved, |run| run.evaluations.into()),
    },
    Column {
        key: "confirmed",
        name: "",
        of_run: true,
        value: |solved| of_run(solved, |run| run.confirmed.to_string().into()),
    },
    Column {
        key: "",
        name: "ended",
        of_run: true,
        value: |solved| {
            let ended = |run: &Optimized| match run.confirmed {
                true => "confirmed".to_owned(),
                false => run.termination.clone(),
            };
            let unchanged = if solved.is_unchanged() { "no better shape; " } else { "" };
            solved.optimization.as_ref().map_or(Value::Missing, |run| format!("{unchanged}{}", ended(run)).into())
        },
    },
    Column {
        key: "warnings",
        name: "warnings",
        of_run: false,
        value: |solved| match solved.warnings.is_empty() {
            true => Value::Missing,
            false => solved.warnings.join(" ").into(),
        },
    },
];

/// A value as it stands between commas.
fn cell(value: &Value) -> String {
    match value {
        Value::Number(value) | Value::Rough(value) => exact(*value),
        Value::Missing => String::new(),
        Value::Count(_) | Value::Text(_) => value.shown(),
    }
}

/// The folder of a row, by its number from 1.
pub fn row_folder(number: usize) -> String {
    format!("row_{number:03}")
}

/// The values of a row, without the names of its options.
pub fn values(row: &Row) -> Vec<String> {
    let value = |option: &String| option.split_once('=').map_or(String::new(), |(_, value)| value.to_owned());
    row.options.iter().map(value).collect()
}

/// Columns side by side, a line per row.
impl fmt::Display for StudyJson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows: Vec<Vec<String>> = self.rows.iter().map(|row| self.cells(row)).collect();
        write!(f, "{}{}", aligned(&self.head(), &rows), line("rows", &self.counted()))
    }
}
