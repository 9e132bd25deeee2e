//! What a study varies, as the command line or the folder of a study states it.

use crate::commands::arguments::{Arguments, HeightError, Variation};
use crate::commands::failure::Failure;
use crate::commands::scene_options::SceneChanges;
use crate::commands::study::varied::{HEIGHT_ERROR, SEED, Varied, assignment};
use clap::Parser;
use contact::error::SceneError;
use serde::{Deserialize, Serialize};

const MAX_ROWS: usize = 1000;

/// The options of a row.
#[derive(Debug, Parser)]
#[command(allow_negative_numbers = true)]
pub struct RowOptions {
    /// What changes in the scene.
    #[command(flatten)]
    pub scene: SceneChanges,
    /// How far the shape is off.
    #[command(flatten)]
    pub error: HeightError,
}

/// What a study varies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The options with their values.
    pub vary: Vec<Varied>,
    /// Options that all rows have.
    pub fixed: Vec<String>,
    /// Whether every row is optimized.
    pub optimize: bool,
    /// Whether all rows begin at the controls of the study, or each at the start of its scene.
    pub same_start: bool,
}

impl Plan {
    /// The study that the command line states.
    pub fn stated(arguments: &Arguments) -> Result<Self, Failure> {
        let same_start = arguments.shape.controls.is_some() || arguments.course.start_controls.is_some();
        let HeightError { height_error, seed } = arguments.error;
        let height_error = height_error.map(|error| assignment(HEIGHT_ERROR, &error.to_string()));
        let seed = seed.map(|seed| assignment(SEED, &seed.to_string()));
        let fixed = height_error.into_iter().chain(seed).collect();
        let Variation { vary, optimize } = arguments.variation.clone();
        Self { vary, fixed, optimize, same_start }.checked()
    }

    /// The plan, unless its options cannot be varied together.
    ///
    /// # Errors
    /// [`Failure::Input`] naming the option and a value that it does not take, or for more than [`MAX_ROWS`] rows.
    pub fn checked(self) -> Result<Self, Failure> {
        let mut names: Vec<&str> = self.vary.iter().map(Varied::field).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(Failure::Input(format!("--vary {} is allowed once", pair[0])));
        }
        for varied in &self.vary {
            for value in varied.values() {
                options(&[&self.fixed[..], &[assignment(varied.name(), value)]].concat())?;
            }
        }
        let is_fixed = |name: &str| self.fixed.iter().any(|option| option.starts_with(&assignment(name, "")));
        let has = |name: &str| names.contains(&name) || is_fixed(name);
        if has(HEIGHT_ERROR) && self.optimize {
            return Err(Failure::Input(format!("--vary {HEIGHT_ERROR} is allowed without --optimize")));
        }
        if has(SEED) && !has(HEIGHT_ERROR) {
            return Err(Failure::Input(format!("{SEED} is allowed with {HEIGHT_ERROR} only")));
        }
        let count = self.vary.iter().fold(1_usize, |count, varied| count.saturating_mul(varied.values().len()));
        if !(1..=MAX_ROWS).contains(&count) {
            let allowed = format!("at least one row and at most {MAX_ROWS}");
            return Err(SceneError::out_of_range("--vary", format!("{count} rows"), allowed).into());
        }
        Ok(self)
    }
}

/// The options of a row from its words.
///
/// # Errors
/// [`Failure::Input`] for a value that the option does not take.
pub fn options(words: &[String]) -> Result<RowOptions, Failure> {
    let words = std::iter::once("study").chain(words.iter().map(String::as_str));
    RowOptions::try_parse_from(words).map_err(|error| {
        let text = error.to_string();
        let first = text.lines().next().unwrap_or_default();
        Failure::Input(first.trim_start_matches("error: ").to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_an_option_does_not_take_are_refused() {
        for (text, words) in [
            ("friction=0,x", "invalid value 'x'"),
            ("mesh=4:6:4", "invalid value"),
            ("friction=", "friction"),
            ("seed=1,-1", "seed"),
        ] {
            let vary = vec![Varied::parse(text).expect(text)];
            let refusal =
                Plan { vary, fixed: vec![], optimize: false, same_start: false }.checked().expect_err(text).to_string();
            assert!(refusal.contains(words), "{text}: {refusal}");
        }
    }
}
