//! The table of a study as text, as comma-separated values and as JSON.

use crate::commands::facts::{Value, aligned, line};
use crate::commands::numbers::{exact, raised};
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
        varied.chain(self.shown().map(|column| column.name)).collect()
    }

    /// The cells of a row; a failed one has its reason in the first cell after the values.
    pub fn cells(&self, row: &Row) -> Vec<String> {
        let mut cells = values(row);
        match &row.outcome {
            Outcome::Failed(reason) => cells.push(reason.clone()),
            Outcome::Solved(solved) => cells.extend(self.shown().map(|column| column.value.of(solved).shown())),
        }
        cells
    }

    /// The columns that people read.
    fn shown(&self) -> impl Iterator<Item = Column> {
        let optimize = self.optimize;
        self.columns().into_iter().filter(move |column| !column.name.is_empty() && (optimize || !column.of_run))
    }

    /// The columns; that of the limits only where a row has one, and those of the quantities that rows have.
    fn columns(&self) -> Vec<Column> {
        let solved: Vec<&Solved> = self.rows.iter().filter_map(Row::solved).collect();
        let has_limit = solved.iter().any(|row| row.limit_violation.is_some());
        let mut columns = columns();
        columns.retain(|column| has_limit || column.key != LIMIT_VIOLATION);
        let quantities = self.quantities().into_iter().map(|(title, unit)| Column {
            key: key(&title, &unit),
            name: if unit.is_empty() { title.clone() } else { format!("{title}, {}", raised(&unit)) },
            of_run: false,
            value: Cell::Quantity(title),
        });
        let place = columns.iter().position(|column| column.key == CONTACT_AREA).unwrap_or(columns.len());
        columns.splice(place..place, quantities);
        columns
    }

    /// The quantities that rows have, with their units, in the order of the rows.
    pub fn quantities(&self) -> Vec<(String, String)> {
        let mut found: Vec<(String, String)> = Vec::new();
        for told in self.rows.iter().filter_map(Row::solved).flat_map(|row| &row.quantities) {
            let own = (told.title.clone(), told.unit.clone());
            if !found.contains(&own) {
                found.push(own);
            }
        }
        found
    }

    /// Comma-separated values with all digits, one line per row.
    pub fn csv(&self) -> String {
        let varied = self.vary.iter().map(|varied| varied.name().replace('-', "_"));
        let columns: Vec<Column> = self.columns().into_iter().filter(|column| !column.key.is_empty()).collect();
        let keys = columns.iter().map(|column| column.key.clone());
        let head: Vec<String> = varied.chain(keys).chain(["seconds", "reason"].map(str::to_owned)).collect();
        let mut table = head.join(",") + "\n";
        for row in &self.rows {
            let (cells, reason): (Vec<String>, String) = match &row.outcome {
                Outcome::Failed(reason) => {
                    let reason = format!("\"{}\"", reason.replace('"', "\"\"").replace('\n', " "));
                    (vec![String::new(); columns.len()], reason)
                }
                Outcome::Solved(solved) => {
                    (columns.iter().map(|column| cell(&column.value.of(solved))).collect(), String::new())
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
    key: String,
    /// Its name for people; empty in the comma-separated values only.
    name: String,
    /// Whether only rows that were optimized have it.
    of_run: bool,
    value: Cell,
}

/// What stands in a column.
enum Cell {
    Of(fn(&Solved) -> Value),
    /// The quantity with this title.
    Quantity(String),
}

impl Cell {
    fn of(&self, solved: &Solved) -> Value {
        match self {
            Self::Of(value) => value(solved),
            Self::Quantity(title) => {
                let own = solved.quantities.iter().find(|told| told.title == *title);
                own.map(|told| told.value).into()
            }
        }
    }
}

/// The name of a column of a quantity in comma-separated values, such as `contact_force_N`.
fn key(title: &str, unit: &str) -> String {
    let words = title.replace('"', "").replace([' ', '-', ','], "_");
    let unit = unit.replace('^', "").replace([' ', '·'], "");
    if unit.is_empty() { words } else { format!("{words}_{unit}") }
}

/// A column that every row has.
fn column(key: &str, name: &str, value: fn(&Solved) -> Value) -> Column {
    Column { key: key.to_owned(), name: name.to_owned(), of_run: false, value: Cell::Of(value) }
}

/// A column that rows have which were optimized.
fn of_run(key: &str, name: &str, value: fn(&Solved) -> Value) -> Column {
    Column { of_run: true, ..column(key, name, value) }
}

/// A value of a row that was optimized.
fn run<V: Into<Value>>(solved: &Solved, value: fn(&Optimized) -> V) -> Value {
    solved.optimization.as_ref().map_or(Value::Missing, |run| value(run).into())
}

/// The column of the limits.
const LIMIT_VIOLATION: &str = "limit_violation";

/// The column of the contact area, before which those of quantities stand.
const CONTACT_AREA: &str = "contact_area_mm2";

fn columns() -> Vec<Column> {
    vec![
        of_run("objective_start", "objective at start", |row| run(row, |run| run.objective_start)),
        of_run("peak_pressure_start_MPa", "peak at start, MPa", |row| run(row, |run| run.peak_pressure_start)),
        column("objective", "objective", |row| row.objective.into()),
        column("objective_unit", "", |row| row.objective_unit.clone().into()),
        column("peak_pressure_MPa", "peak, MPa", |row| row.peak_pressure.into()),
        column(LIMIT_VIOLATION, "beyond limits, share", |row| row.limit_violation.into()),
        column(CONTACT_AREA, "contact area, mm²", |row| row.contact_area.into()),
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
    ]
}

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
