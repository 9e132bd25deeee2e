//! Taylor test of a subgradient: does ⟨ξ, d⟩ predict the change of Θ along d?
//!
//! ```text
//! first(h)  = |Θ(x + h d) − Θ(x) − h⟨ξ, d⟩|                      falls like h² where Θ is smooth
//! centred(h) = |(Θ(x + h d) − Θ(x − h d))/(2h) − ⟨ξ, d⟩| / |⟨ξ, d⟩|      best relative derivative error
//! ```

use crate::{InputError, NonsmoothObjective, OracleError, Request, Vector};
use std::fmt;
use thiserror::Error;

/// The direction of a [`taylor_test`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Direction {
    /// A given direction; its length is the unit of the steps.
    Given(Vector),
    /// A reproducible pseudo-random direction with entries in (−1, 1).
    Seeded(u64),
}

/// One step of a Taylor test.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct TaylorRow {
    /// Step h.
    pub step: f64,
    /// |Θ(x + h d) − Θ(x) − h⟨ξ, d⟩|.
    pub remainder: f64,
    /// Slope of log(remainder) against log(h) from the row before; none in the first row.
    pub slope: Option<f64>,
    /// Relative error of the centred difference quotient against ⟨ξ, d⟩.
    pub derivative_error: f64,
}

/// Result of a Taylor test. `Display` is the table.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct TaylorTest {
    /// ⟨ξ, d⟩.
    pub directional_derivative: f64,
    /// Rows in the order of the steps.
    pub rows: Vec<TaylorRow>,
    /// Slope fitted over the rows whose remainder exceeds rounding and the error bounds of Θ: 2 for a smooth Θ and a
    /// right ξ, 1 for a wrong ξ or across a kink; none if fewer than two rows can be used.
    pub fitted_slope: Option<f64>,
    /// The smallest derivative error of all rows.
    pub best_derivative_error: f64,
}

/// Why a Taylor test has no result.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// An input of the wrong size, or a number that is not finite or outside its range.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The objective failed at one of the points.
    #[error("the objective failed: {0}")]
    Oracle(#[from] OracleError),
}

/// Compares Θ near x with its subgradient along a direction, for the given steps (positive, descending).
///
/// # Errors
/// [`VerifyError`] on wrong sizes, on steps that are not positive, and where the objective fails.
///
/// ```
/// use nonsmooth::{FnObjective, Vector, verify::{Direction, STEPS, taylor_test}};
/// let theta = FnObjective::new(2, |x: &Vector| (x.norm_squared(), x * 2.0));
/// let test = taylor_test(&theta, &Vector::from_vec(vec![1.0, -3.0]), &Direction::Seeded(7), &STEPS)?;
/// assert!((test.fitted_slope.unwrap() - 2.0).abs() < 0.1);
/// assert!(test.best_derivative_error < 1e-8);
/// # Ok::<(), nonsmooth::verify::VerifyError>(())
/// ```
pub fn taylor_test<O: NonsmoothObjective>(
    objective: &O,
    x: &Vector,
    direction: &Direction,
    steps: &[f64],
) -> Result<TaylorTest, VerifyError> {
    let direction = check_input(objective.dimension(), x, direction, steps)?;
    let here = objective.evaluate(&Request::tight(x))?.into_evaluation();
    if here.subgradient.len() != x.len() {
        let (expected, found) = (x.len(), here.subgradient.len());
        return Err(InputError::Dimension { what: "subgradient", expected, found }.into());
    }
    let derivative = here.subgradient.dot(&direction);
    let mut noise = 1e3 * f64::EPSILON * here.value.abs() + here.error_bound;
    let mut value = |h: f64| -> Result<f64, VerifyError> {
        let evaluation = objective.evaluate(&Request::tight(&(x + &direction * h)))?.into_evaluation();
        noise = noise.max(1e3 * f64::EPSILON * here.value.abs() + here.error_bound + evaluation.error_bound);
        Ok(evaluation.value)
    };
    let mut rows: Vec<TaylorRow> = vec![];
    for &step in steps {
        let (ahead, behind) = (value(step)?, value(-step)?);
        let remainder = (ahead - here.value - step * derivative).abs();
        let quotient = (ahead - behind) / (2.0 * step);
        let size = derivative.abs().max(f64::MIN_POSITIVE);
        let derivative_error = if quotient == derivative { 0.0 } else { (quotient - derivative).abs() / size };
        let slope = rows.last().map(|row| (row.remainder / remainder).ln() / (row.step / step).ln());
        rows.push(TaylorRow { step, remainder, slope: slope.filter(|slope| slope.is_finite()), derivative_error });
    }
    Ok(TaylorTest {
        directional_derivative: derivative,
        fitted_slope: fitted_slope(&rows, noise),
        best_derivative_error: rows.iter().map(|row| row.derivative_error).fold(f64::INFINITY, f64::min),
        rows,
    })
}

/// Steps from 1e-1 down to 1e-8.
pub const STEPS: [f64; 8] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];

fn check_input(dimension: usize, x: &Vector, direction: &Direction, steps: &[f64]) -> Result<Vector, InputError> {
    let direction = match direction {
        Direction::Given(direction) => direction.clone(),
        Direction::Seeded(seed) => seeded_direction(dimension, *seed),
    };
    for (what, vector) in [("point", x), ("direction", &direction)] {
        InputError::check_vector(what, dimension, vector)?;
    }
    match steps.iter().find(|step| !(**step > 0.0 && step.is_finite())) {
        Some(step) => Err(InputError::OutOfRange { setting: "step", value: step.to_string(), allowed: "> 0, finite" }),
        None => Ok(direction),
    }
}

/// The reproducible pseudo-random direction of [`Direction::Seeded`]: entries in (−1, 1) from the generator SplitMix64,
/// a counter with a constant increment whose values are mixed by multiplications and shifts \[SteeleLeaFlood2014\].
pub fn seeded_direction(dimension: usize, seed: u64) -> Vector {
    let mut state = seed;
    Vector::from_fn(dimension, |_, _| {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^= mixed >> 31;
        2.0 * ((mixed >> 11) as f64 + 0.5) / (1u64 << 53) as f64 - 1.0
    })
}

/// Least squares of log(remainder) over log(step) for remainders above the rounding level.
fn fitted_slope(rows: &[TaylorRow], rounding: f64) -> Option<f64> {
    let usable = rows.iter().filter(|row| row.remainder > rounding && row.remainder > 0.0);
    let points: Vec<(f64, f64)> = usable.map(|row| (row.step.ln(), row.remainder.ln())).collect();
    if points.len() < 2 {
        return None;
    }
    let count = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / count, sum.1 + point.1 / count));
    let (above, below) = points.iter().fold((0.0, 0.0), |(above, below), (x, y)| {
        (above + (x - mean.0) * (y - mean.1), below + (x - mean.0) * (x - mean.0))
    });
    Some(above / below)
}

impl fmt::Display for TaylorTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "directional derivative {:.10e}", self.directional_derivative)?;
        writeln!(f, "{:>9} {:>12} {:>7} {:>17}", "step", "remainder", "slope", "derivative error")?;
        for row in &self.rows {
            let slope = row.slope.map_or_else(|| "-".to_owned(), |slope| format!("{slope:.2}"));
            writeln!(f, "{:>9.1e} {:>12.3e} {:>7} {:>17.2e}", row.step, row.remainder, slope, row.derivative_error)?;
        }
        let fitted = self.fitted_slope.map_or_else(|| "none".to_owned(), |slope| format!("{slope:.3}"));
        writeln!(f, "fitted slope {fitted}, best relative derivative error {:.2e}", self.best_derivative_error)
    }
}
