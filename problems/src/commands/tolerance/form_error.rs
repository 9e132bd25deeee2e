//! What form errors do to a shape, as a file keeps it: rows of objective, cases and limits; its text and its section.

use crate::commands::facts::{Fact, Facts, Group, Value};
use crate::commands::failure::Failure;
use crate::commands::folder::{SCENE, json, quoted};
use crate::commands::numbers::{exact, rounded};
use figures::page::{Block, Section};
use scene_file::read_text;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The file of a folder that holds it.
pub const FORM_ERROR: &str = "form_error.json";
/// The heading of its section.
pub const TITLE: &str = "Form error";
/// Largest file of a result that is read, bytes.
const LARGEST_FILE: u64 = 1 << 24;
/// Share of the objective that may be lost.
pub const LOSS: f64 = 0.05;
/// Share of the shapes that must keep within it.
pub const SHARE: f64 = 0.95;
/// Model error from which on the result is rough.
const LARGEST_MODEL_ERROR: f64 = 0.2;
/// Model error from which first derivatives say nothing of the changes.
pub const MEANINGLESS_MODEL_ERROR: f64 = 0.5;
/// Largest multiple of the amplitude that is looked at.
pub const LARGEST_TIMES: f64 = 10.0;

/// Amplitude that 95 % of the shapes allow, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Allowed {
    pub amplitude: f64,
    /// Whether it is the largest one that was looked at.
    pub or_more: bool,
}

/// A quantity over all random shapes, by first derivatives, and over those that were solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub quantity: String,
    pub unit: String,
    /// Without form error.
    pub nominal: f64,
    pub median: f64,
    /// What 95 % of the shapes are no worse than.
    pub percentile_95: f64,
    pub worst: f64,
    /// Share of the shapes that keep the limit; none for what is no limit.
    pub kept: Option<f64>,
    /// Whether it decides what is allowed: limits of states, and the objective or its root.
    pub decides: bool,
    /// None for a quantity that does not decide, and where first derivatives say nothing.
    pub allowed: Option<Allowed>,
    /// The worst of the shapes that were solved.
    pub worst_state: f64,
    /// Largest difference of the first-order value from that of a state, over the largest change of a state.
    pub model_error: Option<f64>,
}

/// The result of `tolerance`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FormError {
    pub scene: String,
    /// Where the shape comes from.
    pub shape: String,
    pub controls: Vec<f64>,
    pub amplitude: f64,
    pub wavelength: f64,
    pub samples: usize,
    pub seed: u64,
    /// Number of shapes that were solved.
    pub states: usize,
    pub rows: Vec<Row>,
    /// Amplitude up to which 95 % of the shapes keep the limits and lose at most 5 % of the objective; none where it is
    /// not known for a row that decides.
    pub allowed: Option<Allowed>,
}

impl Row {
    /// Whether first derivatives say what is allowed, where it decides.
    pub fn is_known(&self) -> bool {
        !self.decides || self.allowed.is_some()
    }
}

impl Allowed {
    pub fn words(&self) -> String {
        let least = if self.or_more { "at least " } else { "" };
        format!("{least}{}", rounded(self.amplitude, 3))
    }
}

impl FormError {
    /// What an engineer asks: how good the shape must be made.
    pub fn verdict(&self) -> String {
        let Some(allowed) = self.allowed else {
            let unknown: Vec<&str> =
                self.rows.iter().filter(|row| !row.is_known()).map(|row| &row.quantity[..]).collect();
            return format!(
                "what is allowed is not known: first derivatives say too little of {}; judge by the worst states",
                unknown.join(", ")
            );
        };
        let least = |row: &&Row| row.allowed.map_or(f64::INFINITY, |allowed| allowed.amplitude);
        let decisive = self.rows.iter().min_by(|a, b| least(a).total_cmp(&least(b)));
        let name = decisive.map_or("", |row| row.quantity.as_str());
        if allowed.amplitude == 0.0 {
            return format!("no form error is allowed: without one, no room is left by {name}");
        }
        let what = "95 % of the shapes keep the limits and lose at most 5 % of the objective";
        let by = if allowed.or_more { String::new() } else { format!(" (decided by {name})") };
        format!("up to a form error of {} mm, {what}{by}", allowed.words())
    }

    /// What is allowed, in sentences.
    pub fn short(&self) -> String {
        let Self { amplitude, wavelength, samples, .. } = self;
        let verdict = self.verdict();
        let (first, rest) = verdict.split_at(1);
        let [amplitude, wavelength] = [amplitude, wavelength].map(|length| exact(*length));
        format!(
            "{}{rest}. By {samples} random shapes that deviate by at most {amplitude} mm along the normals of the shaped \
             faces, in waves of {wavelength} mm; first derivatives rate them.{}",
            first.to_uppercase(),
            self.caution().map_or_else(String::new, |words| format!(" Caution: {words}."))
        )
    }

    /// What is to be said where first derivatives say little.
    fn caution(&self) -> Option<String> {
        let errors = self.rows.iter().filter(|row| row.decides).filter_map(|row| row.model_error);
        let most = Some(errors.fold(0.0, f64::max)).filter(|most| *most > LARGEST_MODEL_ERROR)?;
        let percent = rounded(100.0 * most, 2);
        Some(format!("first derivatives are off by up to {percent} % of the largest change: take a smaller amplitude"))
    }

    /// The first lines of a text.
    fn lead(&self) -> Vec<String> {
        let Self { scene, shape, amplitude, wavelength, .. } = self;
        let errors = format!("form errors of at most {} mm, waves of {} mm", exact(*amplitude), exact(*wavelength));
        let lines = [format!("{scene}: {shape}, with {errors}"), self.verdict()];
        lines.into_iter().chain(self.caution()).collect()
    }

    /// The table with what is to be said about it.
    pub fn group(&self) -> Group {
        let columns = ["nominal", "median", "95 %", "worst", "kept", "allowed, mm", "worst state", "model error"]
            .map(str::to_owned);
        let percent = |share: f64| format!("{} %", rounded(100.0 * share, 3));
        let fact = |row: &Row| {
            let values = [row.nominal, row.median, row.percentile_95, row.worst].map(Value::from);
            let rest = [
                row.kept.map_or(Value::Missing, |share| percent(share).into()),
                match row.allowed {
                    Some(allowed) => allowed.words().into(),
                    None if row.decides => "not known".to_owned().into(),
                    None => Value::Missing,
                },
                row.worst_state.into(),
                row.model_error.map_or(Value::Missing, |share| percent(share).into()),
            ];
            Fact::row("", &row.quantity, values.into_iter().chain(rest).collect(), &row.unit)
        };
        Group {
            title: TITLE,
            columns: columns.into(),
            facts: self.rows.iter().map(fact).collect(),
            words: self.words(),
        }
    }

    fn words(&self) -> String {
        let Self { states, seed, .. } = self;
        let tight = self.rows.iter().any(|row| row.allowed.is_some_and(|allowed| allowed.amplitude == 0.0));
        let tight = if tight {
            " A limit that the shape attains allows no form error: to make room, tighten its bound by the difference \
             between nominal and 95 %, and optimize again."
        } else {
            ""
        };
        format!(
            "{} Seed {seed}. 95 %: what 95 % of the shapes are no worse than. Allowed: the amplitude up to which 95 % of the \
             shapes keep the limit, or lose at most 5 % of the objective, or of its root where that is a pressure; volume, mass \
             and equations are conditions of the optimization and decide nothing. {states} of \
             the shapes were solved: the ten that are worst by one of the rows, and ten others; the model error is the largest \
             difference of the first-order value from that of the state, over the largest change of a state.{tight}",
            self.short()
        )
    }

    /// The text for people.
    pub fn text(&self) -> String {
        Facts { lead: self.lead(), groups: vec![self.group()] }.text(false)
    }

    /// The content of its file.
    ///
    /// # Errors
    /// [`Failure::Computation`] for a number that JSON does not have.
    pub fn file(&self) -> Result<String, Failure> {
        json(self)
    }
}

/// The section of a page of an optimization: what was found for the shape with these controls, or how it is found.
pub fn section(folder: &Path, controls: &[f64]) -> Section {
    match known(folder, controls) {
        Some(found) => found.group().section(),
        None => of_text(not_computed(folder)),
    }
}

/// The section of a page that says no more than what is allowed.
pub fn short_section(folder: &Path, controls: &[f64]) -> Section {
    of_text(known(folder, controls).map_or_else(|| not_computed(folder), |found| found.short()))
}

/// The section of one paragraph.
pub fn of_text(text: String) -> Section {
    Section::new(TITLE, vec![Block::Text(text)])
}

fn not_computed(folder: &Path) -> String {
    format!("Not computed. The command: {}", command(folder))
}

/// What a folder says of the shape with these controls.
fn known(folder: &Path, controls: &[f64]) -> Option<FormError> {
    let text = read_text(&folder.join(FORM_ERROR), LARGEST_FILE).ok()?;
    serde_json::from_str::<FormError>(&text).ok().filter(|known| known.controls == controls)
}

/// The command that computes it, as it is typed in a shell.
fn command(folder: &Path) -> String {
    let path = |path: &Path| quoted(path.display().to_string());
    let (scene, run) = (path(&folder.join(SCENE)), path(folder));
    format!("contact3d {scene} tolerance --run {run} --amplitude MM --wavelength MM")
}
