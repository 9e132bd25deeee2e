//! Whether what the optimizer says at the end of its runs is true.
//!
//! ```text
//! collection: published problems in variants, compared with their minima ─┬─ Run ─ tables
//! units ─ problem: convex problems in variables of different units ───────┘
//! ```

mod collection;
mod problem;
mod units;

pub use collection::collection;
pub use units::mixed_units;

use crate::markdown::{section, table};
use clap::ValueEnum;
use problems::commands::Failure;

/// A part of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// The collection of test problems in variants.
    Collection,
    /// Convex problems whose variables have different units.
    Units,
}

/// One run and what it claims.
#[derive(Debug, Clone, Default)]
pub struct Run {
    /// Name of the run; `--only` with it takes this run alone.
    pub name: String,
    /// The rows that count the run, one in each table.
    pub rows: [String; 2],
    /// Value at the end above the minimum, relative to the size of the function.
    pub excess: f64,
    /// Whether the minimum is reached.
    pub reached: bool,
    /// Whether the end is confirmed.
    pub confirmed: bool,
    /// What is false about the end.
    pub wrong: Option<&'static str>,
    /// Evaluations of the run.
    pub evaluations: usize,
    /// The text of the termination.
    pub termination: String,
}

/// The runs with a false end.
pub fn offenders(runs: &[Run]) -> Vec<&Run> {
    runs.iter().filter(|run| run.wrong.is_some()).collect()
}

/// Runs a part and prints its tables; `only` selects runs by their names and lists them. A false end is a failure that
/// keeps the text.
///
/// # Errors
/// [`Failure::Incomplete`] with the text, and [`Failure::Input`] where no run is selected.
pub fn page(part: Part, only: Option<&str>) -> Result<String, Failure> {
    let wanted = |name: &str| only.is_none_or(|only| name.contains(only));
    let runs = match part {
        Part::Collection => collection(wanted),
        Part::Units => mixed_units(wanted),
    };
    let runs = runs.map_err(Failure::computation)?;
    if runs.is_empty() {
        return Err(Failure::Input(format!("--only {}: no run", only.unwrap_or_default())));
    }
    let text = markdown(&runs, only.is_some());
    match offenders(&runs).len() {
        0 => Ok(text),
        count => Err(Failure::Incomplete { text, reason: format!("{count} false terminations"), status: 1 }),
    }
}

/// Both tables, and the runs one by one: all of them, or those with a false end.
fn markdown(runs: &[Run], list: bool) -> String {
    let line = |run: &Run| {
        let verdict = run.wrong.map_or_else(String::new, |wrong| format!("FALSE: {wrong}"));
        let excess = format!("{:.1e}", run.excess);
        vec![run.name.clone(), verdict, excess, run.evaluations.to_string(), run.termination.clone()]
    };
    let listed = runs.iter().filter(|run| list || run.wrong.is_some()).map(line);
    let sum = format!("{} runs, {} false terminations.\n", runs.len(), offenders(runs).len());
    let head = "run | false | above the minimum | evaluations | end";
    [sum, by_row(runs, 0), by_row(runs, 1), section("Runs", head, listed)].join("\n")
}

/// The runs by one of their rows, in the order in which these appear.
fn by_row(runs: &[Run], column: usize) -> String {
    let mut rows: Vec<&str> = vec![];
    for run in runs {
        if !rows.contains(&&*run.rows[column]) {
            rows.push(&run.rows[column]);
        }
    }
    let line = |row: &str| {
        let of = || runs.iter().filter(|run| run.rows[column] == row);
        let mut evaluations: Vec<usize> = of().map(|run| run.evaluations).collect();
        evaluations.sort_unstable();
        let count = |is_so: fn(&Run) -> bool| of().filter(|run| is_so(run)).count();
        let (reached, confirmed) = (count(|run| run.reached), count(|run| run.confirmed));
        let numbers = [of().count(), reached, confirmed, count(|run| run.wrong.is_some())];
        let median = evaluations[evaluations.len() / 2];
        std::iter::once(row.to_owned()).chain(numbers.iter().chain([&median]).map(usize::to_string)).collect()
    };
    table("runs of | runs | reached | confirmed | false | median of evaluations", rows.into_iter().map(line))
}
