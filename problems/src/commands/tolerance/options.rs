//! The options of `tolerance`.

use crate::commands::failure::{Failure, refused};
use clap::Args;
use std::path::PathBuf;

/// The form errors, and of which shape.
#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Tolerance")]
pub struct ToleranceOptions {
    /// Largest deviation from the shape along its normals: half the width of a profile tolerance.
    #[arg(long, value_name = "MM", value_parser = positive)]
    pub amplitude: f64,
    /// Length of the waves that the form errors consist of: at least 4 facets of the shaped faces.
    #[arg(long, value_name = "MM", value_parser = positive)]
    pub wavelength: f64,
    /// Number of random shapes that first derivatives rate; 20 of them are solved to check that.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = count)]
    pub samples: usize,
    /// Another number, other random shapes.
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub seed: u64,
    /// The shape is that of the optimization in the folder DIR, as with export; the result goes there, and into its
    /// pages.
    #[arg(long, value_name = "DIR")]
    pub run: Option<PathBuf>,
}

impl ToleranceOptions {
    /// Refuses options that do not go together; `has_folder`, `has_controls`: `--out` and `--controls` are given.
    ///
    /// # Errors
    /// [`Failure::Input`] naming the option.
    pub fn check(&self, has_folder: bool, has_controls: bool) -> Result<(), Failure> {
        if has_controls && self.run.is_some() {
            return refused("--controls", "without --run, which names the shape");
        }
        if has_folder && self.run.is_some() {
            return refused("--out", "without --run, whose folder takes the result");
        }
        Ok(())
    }
}

fn positive(text: &str) -> Result<f64, &'static str> {
    let size = text.parse().ok().filter(|size: &f64| size.is_finite() && *size > 0.0);
    size.ok_or("allowed: a finite number > 0")
}

fn count(text: &str) -> Result<usize, &'static str> {
    let count = text.parse().ok().filter(|count| (20..=100_000).contains(count));
    count.ok_or("allowed: 20 to 100000")
}
