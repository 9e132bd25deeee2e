//! Whether a point is Clarke stationary, from true gradients around it and nothing that the optimizer computed.
//!
//! ```text
//! r = |D (Σ λ_j g_j + Aᵀμ + ν)| / Σ λ_j |D g_j|       over gradients at x + D d, |d|∞ ≤ ρ,  λ ≥ 0, Σ λ = 1
//! D = diag max(|x_i|, 1e-3 (c + |x|∞))
//! ```
//! λ, μ and ν make the numerator least; c is the unit of the variables. r compares with what cancels: beside the
//! longest gradient, a slope along a steep wall would count as nothing. The gradients are those at random points, and
//! then, as long as r is large, one more along the step that they propose: where a piece is the largest one in a narrow
//! part of the ball only, random points miss it. A step along which f does fall shows that x is not stationary at ρ.

use crate::stability::optimizer_variants::Changed;
use nonsmooth::qp::{EpigraphQp, EpigraphQpSolver, Metric};
use nonsmooth::{InputError, Matrix, Polyhedron, Vector};
use testset::kit::Random;

/// Radii ρ, in turn.
const RADII: [f64; 4] = [1e-8, 1e-7, 1e-6, 1e-5];
/// Largest r of a stationary point.
const LARGEST_RESIDUAL: f64 = 1e-3;
/// A side within this relative distance is active.
const ACTIVE_SIDE: f64 = 1e-6;
/// Length that a step has where the combination is as long as the longest gradient: short beside inactive sides.
const SHORT: f64 = 1e-3 * ACTIVE_SIDE;
/// Least size of a variable relative to c + |x|∞.
const LEAST_SIZE: f64 = 1e-3;
/// Gradients that are looked for along steps, per variable.
const ROUNDS_PER_VARIABLE: usize = 10;
/// Halvings of a step on which a gradient is looked for.
const BISECTIONS: usize = 60;
/// Number of random gradients per variable, and how many there are besides.
const SAMPLES: (usize, usize) = (4, 20);

/// f around a point, as a function of the relative change d of the variables.
struct Around<'a> {
    changed: &'a Changed<'a>,
    x: &'a Vector,
    sizes: Vector,
}

impl<'a> Around<'a> {
    fn new(changed: &'a Changed<'a>, x: &'a Vector) -> Self {
        let least = LEAST_SIZE * (changed.variant.unit + x.amax());
        Self { changed, x, sizes: x.map(|entry| entry.abs().max(least)) }
    }

    /// f and its gradient at a relative change.
    fn at(&self, d: &Vector) -> (f64, Vector) {
        let (value, gradient) = self.changed.exact(&(self.x + self.sizes.component_mul(d)));
        (value, gradient.component_mul(&self.sizes) / self.changed.variant.unit)
    }

    /// Gradients at x and at random points around it.
    fn random_gradients(&self, radius: f64) -> Vec<Vector> {
        let mut random = Random(1);
        let n = self.x.len();
        let points = (0..SAMPLES.0 * n + SAMPLES.1).map(|k| {
            let share = if k == 0 { 0.0 } else { radius };
            Vector::from_fn(n, |_, _| share * random.signed())
        });
        let gradients = points.map(|point| self.at(&point).1);
        gradients.filter(|gradient| gradient.iter().all(|entry| entry.is_finite())).collect()
    }

    /// A gradient on the way along a step of which the gradients so far say that f changes by `promised`: one that
    /// falls by less than half of it. None if f itself falls by half of it: then no gradient is missing.
    fn missing_gradient(&self, step: &Vector, promised: f64) -> Option<Vector> {
        let enough = 0.5 * promised;
        let (mut near, mut far) = ((0.0, self.at(&Vector::zeros(step.len())).0), (1.0, self.at(step).0));
        if far.1 - near.1 <= enough {
            return None;
        }
        for _ in 0..BISECTIONS {
            let middle: f64 = 0.5 * (near.0 + far.0);
            let (value, gradient) = self.at(&(step * middle));
            if !value.is_finite() || gradient.iter().any(|entry| !entry.is_finite()) {
                return None;
            }
            if gradient.dot(step) > enough {
                return Some(gradient);
            }
            // On one of the halves f falls by less than it should.
            if far.1 - value > enough * (far.0 - middle) {
                near = (middle, value);
            } else {
                far = (middle, value);
            }
        }
        None
    }
}

/// The admissible set in relative changes; sides that are not active are as far as they are.
fn relative_set(around: &Around<'_>) -> Result<Polyhedron, InputError> {
    let set = around.changed.set()?;
    let slack = |side: f64, at: f64| if (side - at).abs() <= ACTIVE_SIDE * (1.0 + at.abs()) { 0.0 } else { side - at };
    let sides = |side: &Vector, at: &Vector| Vector::from_fn(side.len(), |i, _| slack(side[i], at[i]));
    let at_rows = set.rows() * around.x;
    let lower = sides(set.lower(), around.x).map(|side| side.min(0.0)).component_div(&around.sizes);
    let upper = sides(set.upper(), around.x).map(|side| side.max(0.0)).component_div(&around.sizes);
    let row_lower = sides(set.row_lower(), &at_rows).map(|side| side.min(0.0));
    let row_upper = sides(set.row_upper(), &at_rows).map(|side| side.max(0.0));
    let rows = Matrix::from_fn(set.rows().nrows(), around.x.len(), |i, j| set.rows()[(i, j)] * around.sizes[j]);
    Polyhedron::boxed(lower, upper)?.with_rows(&rows, &row_lower, &row_upper)
}

/// Minus the shortest combination of gradients and active sides, and Σ λ_j |D g_j|, both relative to the longest
/// gradient; none where they cannot be found.
fn steepest_step(gradients: &[Vector], largest: f64, set: &Polyhedron) -> Option<(Vector, f64)> {
    let slopes: Vec<Vector> = gradients.iter().map(|g| g / largest).collect();
    let ids: Vec<u64> = (0..slopes.len() as u64).collect();
    let qp = EpigraphQp {
        metric: Metric::ScaledIdentity(1.0 / SHORT),
        slopes: &slopes,
        offsets: &vec![0.0; slopes.len()],
        cut_ids: &ids,
        rows: set.rows(),
        row_lower: set.row_lower(),
        row_upper: set.row_upper(),
        lower: set.lower(),
        upper: set.upper(),
    };
    let answer = EpigraphQpSolver::new().solve(&qp).ok()?;
    let cancelled =
        slopes.iter().zip(&answer.cut_multipliers).map(|(slope, multiplier)| multiplier * slope.norm()).sum();
    Some((answer.step / SHORT, cancelled))
}

/// Whether the gradients around a point of the changed problem balance each other and the active constraints.
pub fn is_clarke_stationary(changed: &Changed<'_>, x: &Vector) -> Result<bool, InputError> {
    let around = Around::new(changed, x);
    let set = relative_set(&around)?;
    Ok(RADII.into_iter().any(|radius| balance_within(radius, &around, &set)))
}

/// Whether gradients within one radius prove Clarke stationarity.
fn balance_within(radius: f64, around: &Around<'_>, set: &Polyhedron) -> bool {
    let mut gradients = around.random_gradients(radius);
    for _ in 0..=ROUNDS_PER_VARIABLE * around.x.len() {
        let largest = gradients.iter().map(Vector::norm).fold(0.0, f64::max);
        if largest <= 0.0 {
            return true;
        }
        let Some((step, cancelled)) = steepest_step(&gradients, largest, set) else { return false };
        let residual = step.norm();
        if residual <= LARGEST_RESIDUAL * cancelled {
            return true;
        }
        let step = step * (radius / residual);
        match around.missing_gradient(&step, -largest * residual * radius) {
            Some(gradient) => gradients.push(gradient),
            None => return false,
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::optimizer_variants::Variant;

    /// A local minimum of PBC1 at 0.390 by five of its 60 pieces, one of them nearly flat. A linear program in all
    /// pieces finds a descent of 1.2e-9 at most within a relative distance of 1e-5.
    const LOCAL_MINIMUM: [f64; 5] = [
        -8.650_753_089_488_213e3,
        8.027_759_719_025_914e5,
        1.306_802_877_746_793e7,
        8.683_459_527_780_067e5,
        1.050_599_379_970_918e7,
    ];

    fn is_stationary_at(name: &str, variant: Variant, x: &[f64]) -> bool {
        let problem = testset::find(name).expect("a problem of the collection");
        is_clarke_stationary(&Changed::new(&problem, variant), &Vector::from_column_slice(x)).expect("a set")
    }

    #[test]
    fn a_piece_that_random_points_miss_is_found_along_the_step() {
        let problem = testset::find("PBC1").expect("a problem of the collection");
        let (changed, x) = (Changed::new(&problem, Variant::PLAIN), Vector::from_column_slice(&LOCAL_MINIMUM));
        let around = Around::new(&changed, &x);
        let set = relative_set(&around).expect("a set");
        let gradients = around.random_gradients(RADII[0]);
        let largest = gradients.iter().map(Vector::norm).fold(0.0, f64::max);
        let (step, cancelled) = steepest_step(&gradients, largest, &set).expect("a step");
        assert!(step.norm() > LARGEST_RESIDUAL * cancelled);
        assert!(balance_within(RADII[0], &around, &set));
    }

    #[test]
    fn stationarity_does_not_depend_on_the_unit() {
        let scaled = LOCAL_MINIMUM.map(|x| 100.0 * x);
        assert!(is_stationary_at("PBC1", Variant { unit: 100.0, ..Variant::PLAIN }, &scaled));
    }

    /// f = max(−x₁, 1e4 x₁) − x₂ falls along the foot of a steep wall.
    #[test]
    fn a_steep_wall_hides_no_slope_along_it() {
        let gradients = [Vector::from_vec(vec![-1.0, -1.0]), Vector::from_vec(vec![1e4, -1.0])];
        let (step, cancelled) =
            steepest_step(&gradients, gradients[1].norm(), &Polyhedron::unbounded(2)).expect("a step");
        assert!(step.norm() > 0.1 * cancelled, "{} of {cancelled}", step.norm());
    }

    #[test]
    fn points_beside_a_minimum_are_not_stationary() {
        for (entry, share) in (0..5).flat_map(|entry| [(entry, 1.0 + 1e-3), (entry, 1.0 - 1e-3)]) {
            let mut x = LOCAL_MINIMUM;
            x[entry] *= share;
            assert!(!is_stationary_at("PBC1", Variant::PLAIN, &x), "entry {entry}, factor {share}");
        }
        // On the kink of a curved valley, away from its lowest point (1, 1).
        assert!(is_stationary_at("ChebRosenN1_2", Variant::PLAIN, &[1.0, 1.0]));
        assert!(!is_stationary_at("ChebRosenN1_2", Variant::PLAIN, &[0.5, -0.5]));
    }
}
