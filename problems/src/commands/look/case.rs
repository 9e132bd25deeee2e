//! A load case before its solve.

use crate::commands::failure::Failure;
use contact::equilibrium::{ContactProblem, ContactRows, Positions, Preview};

/// A load case at a shape: where its nodes are, and what is known without a solve.
pub struct LookedCase<'a> {
    /// Its name; empty for a scene without cases.
    pub name: String,
    pub problem: &'a ContactProblem,
    pub positions: Positions,
    pub rows: ContactRows,
    pub preview: Preview,
}

impl<'a> LookedCase<'a> {
    /// A case at the shape of some controls.
    ///
    /// # Errors
    /// [`Failure`] for controls without a shape.
    pub fn new(name: &str, problem: &'a ContactProblem, controls: &[f64]) -> Result<Self, Failure> {
        let points = problem.positions(controls).map_err(Failure::computation)?;
        let rows = match points == problem.start_positions() {
            true => problem.start_rows().clone(),
            false => problem.rows(&points).map_err(Failure::computation)?,
        };
        let preview = problem.preview_at(&points, &rows);
        let positions = problem.map.positions(controls);
        Ok(Self { name: name.to_owned(), problem, positions, rows, preview })
    }
}

/// What is said of every case: what is the same in all of them once, the rest with the name of its case.
pub fn by_case(cases: &[LookedCase<'_>], of_case: impl Fn(&LookedCase<'_>) -> Vec<String>) -> Vec<String> {
    let all: Vec<Vec<String>> = cases.iter().map(of_case).collect();
    let is_common = |words: &String| all.iter().all(|own| own.contains(words));
    let mut found: Vec<String> = all.iter().take(1).flatten().filter(|words| is_common(words)).cloned().collect();
    for (case, own) in cases.iter().zip(&all) {
        let rest = own.iter().filter(|words| !is_common(words));
        found.extend(rest.map(|words| format!("case \"{}\": {words}", case.name)));
    }
    found
}
