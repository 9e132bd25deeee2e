//! Further starts within an admissible set, always the same ones.

use crate::qp::{QpError, project};
use crate::verify::seeded_direction;
use crate::{Polyhedron, Vector};

/// The point at which a start arrives that is moved along a direction until its largest entry has changed by `length`,
/// then into the set.
///
/// # Errors
/// As [`project`].
pub fn moved_start(set: &Polyhedron, start: &Vector, direction: &Vector, length: f64) -> Result<Vector, QpError> {
    let moved = start + direction * (length / direction.amax().max(f64::MIN_POSITIVE));
    project(set, &moved)
}

/// As [`moved_start`], along the pseudo-random direction of a seed.
///
/// # Errors
/// As [`project`].
pub fn seeded_start(set: &Polyhedron, start: &Vector, length: f64, seed: u64) -> Result<Vector, QpError> {
    moved_start(set, start, &seeded_direction(start.len(), seed), length)
}
