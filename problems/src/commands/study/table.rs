//! The table of a study as text, as comma-separated values and as JSON.

use crate::commands::facts::{Value, aligned, line};
use crate::commands::numbers::exact;
use crate::commands::study::plan::Plan;
use crate::commands::study::row::{Optimized, Outcome, Row, Solved};
use crate::commands::study::varied::{Varied, parts};
use serde::Serialize;
use std::fmt;

/// The keys of the JSON of `study`.
#[derive(Debug, Serialize)]
pub struct StudyJson {
    /// What is varied, in the order of the options of every row; the last one changes fastest.
    pub vary: Vec<Varied>,
    /// Whether every row was optimized.
    optimize: bool,
    /// Number of rows of the whole study.
    rows_in_all: usize,
    /// Number of rows without a result.
    failures: usize,
    /// The rows so far.
    pub rows: Vec<Row>,
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
    fn shown(&self) -> impl Iterator<Item = &Column> {
        self.columns().filter(|column| !column.name.is_empty() && (self.optimize || !column.of_run))
    }

    /// The columns; that of the limit only where a row has one.
    fn columns(&self) -> impl Iterator<Item = &Column> {
        let limited = |row: &Row| matches!(&row.outcome, Outcome::Solved(solved) if solved.limit_violation.is_some());
        let has_limit = self.rows.iter().any(limited);
        COLUMNS.iter().filter(move |column| has_limit || column.key != LIMIT_VIOLATION)
    }

    /// Comma-separated values with all digits, one line per row.
    pub fn csv(&self) -> String {
        let varied = self.vary.iter().map(|varied| varied.name().replace('-', "_"));
        let columns: Vec<&Column> = self.columns().filter(|column| !column.key.is_empty()).collect();
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

/// A column that every row has.
const fn column(key: &'static str, name: &'static str, value: fn(&Solved) -> Value) -> Column {
    Column { key, name, of_run: false, value }
}

/// A column that rows have which were optimized.
const fn of_run(key: &'static str, name: &'static str, value: fn(&Solved) -> Value) -> Column {
    Column { key, name, of_run: true, value }
}

/// A value of a row that was optimized.
fn run<V: Into<Value>>(solved: &Solved, value: fn(&Optimized) -> V) -> Value {
    solved.optimization.as_ref().map_or(Value::Missing, |run| value(run).into())
}

/// The column of the limits.
const LIMIT_VIOLATION: &str = "limit_violation";

const COLUMNS: [Column; 15] = [
    of_run("objective_start", "objective at start", |row| run(row, |run| run.objective_start)),
    of_run("peak_pressure_start_MPa", "peak at start, MPa", |row| run(row, |run| run.peak_pressure_start)),
    column("objective", "objective", |row| row.objective.into()),
    column("objective_unit", "", |row| row.objective_unit.clone().into()),
    column("peak_pressure_MPa", "peak, MPa", |row| row.peak_pressure.into()),
    column(LIMIT_VIOLATION, "beyond limits, share", |row| row.limit_violation.into()),
    column("contact_area_mm2", "contact area, mm²", |row| row.contact_area.into()),
    column("total_normal_force_N", "", |row| row.total_normal_force.into()),
    column("open", "open", |row| row.status.open.into()),
    column("stick", "stick", |row| row.status.stick.into()),
    column("slip", "slip", |row| row.status.slip.into()),
    of_run("evaluations", "evaluations", |row| run(row, |run| run.evaluations)),
    of_run("confirmed", "", |row| run(row, |run| run.confirmed.to_string())),
    of_run("", "ended", |row| {
        let ended = run(row, |run| if run.confirmed { "confirmed".into() } else { run.termination.clone() });
        if row.is_unchanged() { format!("no better shape; {}", ended.shown()).into() } else { ended }
    }),
    column("warnings", "warnings", |row| match row.warnings.is_empty() {
        true => Value::Missing,
        false => row.warnings.join("; ").into(),
    }),
];

/// A value as it stands between commas.
fn cell(value: &Value) -> String {
    match value {
        Value::Number(value) | Value::Rough(value) => exact(*value),
        Value::Missing => String::new(),
        Value::Count(_) | Value::Text(_) => value.shown(),
    }
}

pub fn row_folder(number: usize) -> String {
    format!("row_{number:03}")
}

/// The values of a row, without the names of its options.
pub fn values(row: &Row) -> Vec<String> {
    row.options.iter().map(|option| parts(option).1.to_owned()).collect()
}

/// Columns side by side, a line per row.
impl fmt::Display for StudyJson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows: Vec<Vec<String>> = self.rows.iter().map(|row| self.cells(row)).collect();
        write!(f, "{}{}", aligned(&self.head(), &rows), line("rows", &self.counted()))
    }
}
