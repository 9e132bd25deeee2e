//! Why an iteration ended above its tolerance: the data in double precision, or the iteration itself.
//!
//! ```text
//! gaps:       ε c max|g| / load                          forces that close the rounding errors of the gaps
//! stiffness:  |K⁺K x − x|/|x| modulo rigid motions       digits that the factors of a subdomain lose
//! ```

use crate::error::ContactError;
use crate::tfeti::dual::TornContact;
use crate::tfeti::newton::settings::NewtonSettings;

/// Multiple of its rounding floor up to which a residual counts as having reached it.
const FLOOR_REACHED: f64 = 10.0;

/// The error of a run that ended at a residual above what is acceptable.
pub(crate) fn not_converged(
    contact: &TornContact<'_>,
    residual: f64,
    settings: &NewtonSettings,
    history: Vec<f64>,
) -> ContactError {
    let largest = contact.rows.gaps().fold(0.0, |largest: f64, gap| largest.max(gap.abs()));
    let gaps = f64::EPSILON * contact.stiffness * largest / contact.load;
    let stiffness = contact.operator.system.forward_error;
    let (floor, what) = if gaps > stiffness {
        (gaps, "gaps (distances or loads of very different size)")
    } else {
        (
            stiffness,
            "stiffness (bricks of extreme shape or nearly incompressible; direct condensation loses fewer digits)",
        )
    };
    // A diverged iterate says nothing about rounding: the residual must have come down to the floor.
    if residual <= FLOOR_REACHED * floor {
        return ContactError::BeyondPrecision { what, floor, residual, tolerance: settings.acceptable };
    }
    ContactError::NotConverged {
        solver: "semismooth Newton on TFETI",
        residual,
        tolerance: settings.tolerance,
        iterations: history.len() - 1,
        history,
    }
}
