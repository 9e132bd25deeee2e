//! Whether a point is Clarke stationary, from true gradients around it and nothing that the optimizer computed.
//!
//! ```text
//! r = min |Σ λ_j g_j + Aᵀμ + ν| / max |g_j|       over the gradients at random points within ρ of x,  λ ≥ 0, Σ λ = 1
//! ```

use crate::stability::optimizer_variants::Changed;
use nonsmooth::qp::{EpigraphQp, EpigraphQpSolver, Metric};
use nonsmooth::{InputError, Vector};
use testset::kit::Random;

/// Radii ρ relative to 1 + |x|∞, in turn.
const RADII: [f64; 4] = [1e-8, 1e-7, 1e-6, 1e-5];
/// Largest r of a stationary point.
const LARGEST_RESIDUAL: f64 = 1e-3;
/// A side within this relative distance is active.
const ACTIVE_SIDE: f64 = 1e-6;
/// Number of gradients per variable, and how many there are besides.
const SAMPLES: (usize, usize) = (4, 20);

/// Whether the gradients around a point of the changed problem balance each other and the active constraints.
pub fn is_clarke_stationary(changed: &Changed<'_>, x: &Vector) -> Result<bool, InputError> {
    let set = changed.set()?;
    let size = (1.0 + x.amax()) * changed.variant.unit.min(1.0);
    let slack = |side: f64, at: f64| if (side - at).abs() <= ACTIVE_SIDE * (1.0 + at.abs()) { 0.0 } else { side - at };
    let sides = |side: &Vector, at: &Vector| Vector::from_fn(side.len(), |i, _| slack(side[i], at[i]));
    let at_rows = set.rows() * x;
    let lower = sides(set.lower(), x).map(|side| side.min(0.0));
    let upper = sides(set.upper(), x).map(|side| side.max(0.0));
    let row_lower = sides(set.row_lower(), &at_rows).map(|side| side.min(0.0));
    let row_upper = sides(set.row_upper(), &at_rows).map(|side| side.max(0.0));
    for radius in RADII {
        let gradients = gradients_around(changed, x, radius * size);
        let largest = gradients.iter().map(Vector::norm).fold(0.0, f64::max);
        if largest <= 0.0 {
            return Ok(true);
        }
        // Scaled so that the step is minus the combination, and short beside the open sides.
        let short = 1e-3 * ACTIVE_SIDE * size;
        let slopes: Vec<Vector> = gradients.iter().map(|g| g / largest).collect();
        let ids: Vec<u64> = (0..slopes.len() as u64).collect();
        let qp = EpigraphQp {
            metric: Metric::ScaledIdentity(1.0 / short),
            slopes: &slopes,
            offsets: &vec![0.0; slopes.len()],
            cut_ids: &ids,
            rows: set.rows(),
            row_lower: &row_lower,
            row_upper: &row_upper,
            lower: &lower,
            upper: &upper,
        };
        if EpigraphQpSolver::new().solve(&qp).is_ok_and(|answer| answer.step.norm() / short <= LARGEST_RESIDUAL) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Gradients at x and at random points around it.
fn gradients_around(changed: &Changed<'_>, x: &Vector, radius: f64) -> Vec<Vector> {
    let mut random = Random(1);
    let count = SAMPLES.0 * x.len() + SAMPLES.1;
    let points = (0..count).map(|k| {
        let share = if k == 0 { 0.0 } else { radius };
        Vector::from_fn(x.len(), |i, _| x[i] + share * random.signed())
    });
    let gradients = points.map(|point| changed.exact(&point).1);
    gradients.filter(|gradient| gradient.iter().all(|entry| entry.is_finite())).collect()
}
