//! One row of a study.

use crate::commands::arguments::HeightError;
use crate::commands::controls::{self, Layout};
use crate::commands::failure::Failure;
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::numbers::plain_unit;
use crate::commands::optimize::report;
use crate::commands::optimize::run::optimize;
use crate::commands::shape_facts::is_better;
use crate::commands::solved_shape::{self, ContactObjective, SolvedShape, checks};
use crate::commands::study::plan::{RowOptions, options};
use contact::equilibrium::StatusCounts;
use contact::solvers::Wanted;
use nonsmooth::Vector;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Instant;

/// One row of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The options that it has beside those of the study.
    pub options: Vec<String>,
    #[serde(flatten)]
    pub outcome: Outcome,
    /// Seconds that it took.
    pub seconds: f64,
}

/// What came out of a row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// The state, at the optimum if the row was optimized.
    Solved(Box<Solved>),
    /// Why there is none.
    Failed(String),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solved {
    /// The objective Θ.
    pub objective: f64,
    /// The unit of Θ.
    pub objective_unit: String,
    /// Largest contact pressure, MPa.
    pub peak_pressure: f64,
    /// The largest violation of a limit over its bound, where there are limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit_violation: Option<f64>,
    /// The quantities that the scene limits and reports.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub quantities: Vec<Told>,
    /// Tributary area of the closed contact nodes, mm².
    pub contact_area: f64,
    /// The total normal force Σλ_N, N.
    pub total_normal_force: f64,
    /// Numbers of nodes per status.
    pub status: StatusCounts,
    /// The control heights, mm.
    pub controls: Vec<f64>,
    /// Where the row was optimized, how.
    pub optimization: Option<Optimized>,
    /// Codes of what is implausible about the state, unless that is not checked.
    pub warnings: Vec<String>,
}

/// The value of a quantity that the scene limits or reports.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Told {
    /// The quantity with its case, or its label.
    pub title: String,
    /// The unit of the value.
    pub unit: String,
    pub value: f64,
}

impl Told {
    /// The quantities of a shape, each once.
    fn of(shape: &SolvedShape) -> Vec<Self> {
        let limits = shape.limits.iter().map(|own| (own.title(), own.limit.quantity.unit(), own.value));
        let reports = shape.reports.iter().map(|(report, value)| (report.title(), report.quantity.unit(), *value));
        let mut found: Vec<Self> = Vec::new();
        for (title, unit, value) in limits.chain(reports) {
            if found.iter().all(|other| other.title != title) {
                found.push(Self { title, unit: plain_unit(&unit), value });
            }
        }
        found
    }
}

/// The optimization of a row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Optimized {
    /// Θ at the start.
    pub objective_start: f64,
    /// Largest contact pressure at the start, MPa.
    pub peak_pressure_start: f64,
    pub evaluations: usize,
    /// Evaluations on the mesh that took most.
    pub most_evaluations: usize,
    pub termination: String,
    /// Whether the shape is confirmed.
    pub confirmed: bool,
    /// Whether more evaluations may improve it.
    pub can_continue: bool,
    /// Whether the start violates a limit: no other shape is worse than that.
    #[serde(default)]
    pub had_to_move: bool,
}

impl Solved {
    /// Whether it was optimized and its shape is no better than the start.
    pub fn is_unchanged(&self) -> bool {
        self.optimization
            .as_ref()
            .is_some_and(|run| !run.had_to_move && !is_better(run.objective_start, self.objective))
    }
}

impl Row {
    /// What came out, where something did.
    pub fn solved(&self) -> Option<&Solved> {
        match &self.outcome {
            Outcome::Solved(solved) => Some(solved),
            Outcome::Failed(_) => None,
        }
    }

    /// Whether it was optimized and found no better shape than its start.
    pub fn is_unchanged(&self) -> bool {
        matches!(&self.outcome, Outcome::Solved(solved) if solved.is_unchanged())
    }

    /// Evaluations on the mesh that took most, if the row was optimized.
    pub fn evaluations(&self) -> Option<usize> {
        let Outcome::Solved(solved) = &self.outcome else { return None };
        solved.optimization.as_ref().map(|run| run.most_evaluations)
    }

    /// Whether a study that is continued computes it again: it failed, or, where there is a new limit, its optimization
    /// ended at the old one.
    pub fn is_to_be_continued(&self, new_limit: bool) -> bool {
        match &self.outcome {
            Outcome::Failed(_) => true,
            Outcome::Solved(solved) => new_limit && solved.optimization.as_ref().is_some_and(|run| run.can_continue),
        }
    }
}

/// Computes a row: the scene with its options and those that all rows have, at controls that are given or at its own
/// start; optimized if asked for, in a folder if there is one. The inner error says why the row was cut short.
///
/// # Errors
/// [`Failure::Incomplete`] if files of the row could not be written; every other failure is the row's outcome.
pub fn computed(
    loaded: &LoadedScene,
    (words, fixed): (&[String], &[String]),
    (optimized, start, out): (bool, Option<&Vector>, Option<&Path>),
    session: &Session<'_>,
) -> Result<Result<Row, String>, Failure> {
    let clock = Instant::now();
    let outcome = match stated(loaded, (words, fixed), (start.is_some(), out)) {
        Ok((part, _)) if optimized => optimum(&part, start, session),
        Ok((part, options)) => evaluated(&part, start, &options.error, session).map(Ok),
        Err(failure) => Err(failure),
    };
    let outcome = match outcome {
        Ok(Ok(solved)) => Outcome::Solved(Box::new(solved)),
        Ok(Err(reason)) => return Ok(Err(reason)),
        // Its files could not be written.
        Err(failure @ Failure::Incomplete { .. }) => return Err(failure),
        Err(failure) => Outcome::Failed(failure.to_string()),
    };
    Ok(Ok(Row { options: words.to_vec(), outcome, seconds: clock.elapsed().as_secs_f64() }))
}

/// Why a row is known to fail before anything is computed, if it is: its options, its memory, its objective.
pub fn refusal(
    loaded: &LoadedScene,
    words: (&[String], &[String]),
    (optimized, has_start): (bool, bool),
    session: &Session<'_>,
) -> Option<Failure> {
    let checked = stated(loaded, words, (has_start, None)).and_then(|(part, _)| {
        let wanted = if optimized { part.case.wanted() } else { Wanted::States };
        Ok(part.case.check_ahead(wanted, &session.processes)?)
    });
    checked.err()
}

/// The scene of a row, with the options that it has; `has_start`: whether it is to take the controls of the study.
fn stated(
    loaded: &LoadedScene,
    (words, fixed): (&[String], &[String]),
    (has_start, out): (bool, Option<&Path>),
) -> Result<(LoadedScene, RowOptions), Failure> {
    let options = options(&[words, fixed].concat())?;
    let mut file = options.scene.apply(loaded.file.clone())?;
    file.output.folder = out.map(|path| path.display().to_string());
    let part = loaded.changed(|scene| *scene = file).map_err(|error| options.scene.blame(error))?;
    if has_start {
        let [given, own] = [&loaded.case, &part.case].map(|case| Layout::of(&case.scene));
        controls::check_layout(given, own, "the study, at which its rows begin")?;
    }
    Ok((part, options))
}

/// The state at one shape.
fn evaluated(
    part: &LoadedScene,
    start: Option<&Vector>,
    error: &HeightError,
    session: &Session<'_>,
) -> Result<Solved, Failure> {
    let objective = solved_shape::objective(&part.case, &session.processes)?;
    let controls = match start {
        Some(start) => {
            objective.solver().problem().admissible.check_shape(start)?;
            start.clone()
        }
        None => controls::load(objective.solver().problem(), &part.case, ("--controls", None))?,
    };
    solved(&objective, &SolvedShape::at(&objective, &controls::as_made(controls, error))?, session)
}

/// The optimum, or why the run was cut short.
fn optimum(
    part: &LoadedScene,
    start: Option<&Vector>,
    session: &Session<'_>,
) -> Result<Result<Solved, String>, Failure> {
    let run = optimize(part, start, session)?;
    if run.was_cut_short() {
        return Ok(Err("a limit of time or an interruption ended a row".into()));
    }
    if let Some(reason) = run.failure() {
        return Err(Failure::Computation(reason));
    }
    let (_, [first, last]) = report(&run, part, session, None)?;
    let chosen = run.runs.chosen().ok_or_else(|| Failure::computation("no mesh was begun"))?;
    let optimization = Optimized {
        objective_start: first.value,
        peak_pressure_start: first.peak_pressure,
        evaluations: run.runs.evaluations(),
        most_evaluations: run.runs.ended.iter().map(|run| run.report.counts.evaluations).max().unwrap_or(0),
        termination: chosen.report.termination.to_string(),
        confirmed: chosen.report.is_confirmed(),
        had_to_move: !first.keeps_limits(),
        can_continue: run.runs.can_continue(),
    };
    let objective = chosen.report.value;
    let mut solved = solved(&chosen.stage.objective, &last, session)?;
    solved.warnings.extend(run.runs.standstill((&last.controls, &last.states))?.map(|warning| warning.code.to_owned()));
    Ok(Ok(Solved { objective, optimization: Some(optimization), ..solved }))
}

/// What a row keeps of a solved shape.
fn solved(objective: &ContactObjective, shape: &SolvedShape, session: &Session<'_>) -> Result<Solved, Failure> {
    let forces = &shape.state().forces;
    Ok(Solved {
        objective: shape.value,
        objective_unit: plain_unit(&objective.unit()),
        peak_pressure: shape.peak_pressure,
        limit_violation: shape.limit_violation(),
        quantities: Told::of(shape),
        contact_area: shape.state().rows.closed_area(&forces.status),
        total_normal_force: forces.total_normal_force(),
        status: forces.counts(),
        controls: shape.controls.as_slice().to_vec(),
        optimization: None,
        warnings: checks(objective, shape, session.arguments)?
            .into_iter()
            .map(|warning| warning.code.to_owned())
            .collect(),
    })
}
