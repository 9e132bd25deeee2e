//! Euclidean projection onto a polyhedron.
//!
//! ```text
//! min ½ |y − x|²   over   lower ≤ y ≤ upper,  row_lower ≤ A y ≤ row_upper
//! ```
//! In d = y − x this is the QP with the single cut 0 ≤ v and H = I.

use super::correction::corrected;
use super::independent_rows::IndependentRows;
use super::least_violation::least_violation;
use super::problem::{EpigraphQp, Metric, QpError};
use super::solver::EpigraphQpSolver;
use crate::{InputError, Polyhedron, Vector};

/// The point of the polyhedron nearest to x (`dimension()` entries); x itself if it is admissible.
///
/// # Errors
/// [`QpError::Infeasible`] for an empty set, with the least violation that a point can have; [`QpError::Input`] for an
/// x of wrong size or with entries that are not finite; [`QpError::NotSolved`] if rounding keeps the quadratic program
/// from being solved.
///
/// ```
/// use nonsmooth::{Polyhedron, Vector, qp::project};
///
/// let square = Polyhedron::boxed(Vector::zeros(2), Vector::from_element(2, 1.0))?;
/// assert_eq!(project(&square, &Vector::from_vec(vec![3.0, 0.5]))?, Vector::from_vec(vec![1.0, 0.5]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn project(set: &Polyhedron, x: &Vector) -> Result<Vector, QpError> {
    InputError::check_vector("point", set.dimension(), x)?;
    nearest(IndependentRows::new(set, |_| 1.0).consistent(set, x)?, x)
}

/// As [`project`], onto a set whose equality rows are independent.
pub(crate) fn nearest(set: &Polyhedron, x: &Vector) -> Result<Vector, QpError> {
    let clamped = set.clamp_to_box(x);
    if clamped == *x && set.violation(x) == 0.0 {
        return Ok(clamped);
    }
    let first = shortest_step(set, x).map_err(|error| measured(set, &clamped, error))?;
    let mut point = set.clamp_to_box(&(x + first));
    // The rounding of a step is relative to its length: a second, tiny step lands closer.
    for _ in 0..REFINEMENTS {
        let violation = set.violation(&point);
        if violation <= f64::EPSILON {
            break;
        }
        let Ok(step) = shortest_step(set, &point) else { break };
        let candidate = set.clamp_to_box(&(&point + step));
        if set.violation(&candidate) >= violation {
            break;
        }
        point = candidate;
    }
    Ok(if set.violation(&point) > ADMISSIBLE { corrected(set, &point, &point) } else { point })
}

/// The solver reports the violation of one side where it gave up, or none at all; what is told is the least that a
/// point of the box has.
fn measured(set: &Polyhedron, x: &Vector, error: QpError) -> QpError {
    match error {
        QpError::Infeasible { .. } | QpError::NotSolved { .. } => {
            let violation = least_violation(set, x);
            // A point was found after all: the error of the solver stands.
            if violation > ADMISSIBLE { QpError::Infeasible { violation } } else { error }
        }
        error => error,
    }
}

/// Whether a point x of the polyhedron is its only one, as far as points within `distance` tell.
///
/// The unit vectors and minus their sum span everything with positive factors. If the points at the given distance from
/// x along them all have x as their nearest point, the normal cone at x is therefore the whole space. A nearest point
/// within [`ALONE`] of the distance counts as x.
pub(crate) fn is_only_point(set: &Polyhedron, x: &Vector, distance: f64) -> bool {
    if set.rows().nrows() == 0 {
        return set.lower() == set.upper();
    }
    let n = x.len();
    let direction = |k: usize| Vector::from_fn(n, |i, _| if k == n { -distance } else { distance * f64::from(i == k) });
    (0..=n).all(|k| nearest(set, &(x + direction(k))).is_ok_and(|point| (point - x).amax() <= ALONE * distance))
}

/// Relative violation of a point that counts as one of the set.
const ADMISSIBLE: f64 = 1e-14;
/// Largest number of steps taken after the first.
const REFINEMENTS: usize = 2;
/// Rounding of a nearest point, relative to the distance of the point that is projected.
const ALONE: f64 = 1e-12;

/// The shortest d with x + d in the set.
fn shortest_step(set: &Polyhedron, x: &Vector) -> Result<Vector, QpError> {
    let shift = set.rows() * x;
    let qp = EpigraphQp {
        metric: Metric::ScaledIdentity(1.0),
        slopes: &[Vector::zeros(x.len())],
        offsets: &[0.0],
        cut_ids: &[0],
        rows: set.rows(),
        row_lower: &(set.row_lower() - &shift),
        row_upper: &(set.row_upper() - &shift),
        lower: &(set.lower() - x),
        upper: &(set.upper() - x),
    };
    Ok(EpigraphQpSolver::new().solve(&qp)?.step)
}
