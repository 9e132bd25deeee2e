//! Whether what the optimizer says at the end of its runs is true: on published problems in variants, and on convex
//! problems in variables of different units.

mod collection;
mod problem;
mod units;

pub use collection::collection;
pub use units::mixed_units;

/// One run and what it claims.
#[derive(Debug, Clone, Default)]
pub struct Run {
    /// Name of the run.
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

/// Prints the tables of docs/stability.md; no end may be false.
pub fn check(runs: &[Run], least: usize) {
    for column in 0..2 {
        println!("\n| | runs | reached | confirmed | median of evaluations |\n|---|---|---|---|---|");
        let mut rows: Vec<&str> = vec![];
        for run in runs {
            if !rows.contains(&&*run.rows[column]) {
                rows.push(&run.rows[column]);
            }
        }
        for row in rows {
            let of = || runs.iter().filter(|run| run.rows[column] == row);
            let mut evaluations: Vec<usize> = of().map(|run| run.evaluations).collect();
            evaluations.sort_unstable();
            let (reached, confirmed) =
                (of().filter(|run| run.reached).count(), of().filter(|run| run.confirmed).count());
            println!("| {row} | {} | {reached} | {confirmed} | {} |", of().count(), evaluations[evaluations.len() / 2]);
        }
    }
    let is_wrong = |run: &&Run| run.wrong.is_some();
    let said = |run: &Run| format!("{}: {:?} by {:.1e}: {}", run.name, run.wrong, run.excess, run.termination);
    let offenders: Vec<String> = runs.iter().filter(is_wrong).map(said).collect();
    assert!(offenders.is_empty(), "{offenders:#?}");
    assert!(runs.len() >= least, "{} runs", runs.len());
}
