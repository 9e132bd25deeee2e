//! Iterative refinement in cycles: what follows a Krylov method with products in single or double precision.

use crate::tfeti::dual::Precision;

/// Cycles allowed: each recomputes the residual, so that the next one regains what rounding has taken.
pub const MAX_CYCLES: usize = 12;
/// Residual reduction asked of a cycle with single precision products.
pub const CYCLE_REDUCTION: f64 = 3e-5;
/// Residual reduction by a cycle that is too little for products in single precision.
const SLOW_REDUCTION: f64 = 0.1;
/// Residual reduction by a cycle that is too little for another one in double precision.
const STALLED_REDUCTION: f64 = 0.5;
/// Share of the right side below which its projection is known to few digits: relative residuals refer to no less.
pub const SMALLEST_PROJECTED_SHARE: f64 = 1e-5;
/// Relative residual accepted when rounding stops all progress.
pub const TIGHTEST_ACCEPTABLE: f64 = 1e-8;

/// What follows a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NextCycle {
    /// Another cycle in the same precision, or the end if the residual is small enough.
    Continue,
    /// Another cycle with products in double precision.
    Double,
    /// A cycle from zero with products in double precision: this cycle has made the residual larger.
    DoubleFromZero,
    /// Rounding has stopped all progress.
    Stop,
}

/// What follows a cycle, by the residual before and after it.
pub fn next_cycle(precision: Precision, previous: f64, residual: f64, goal: f64) -> NextCycle {
    let within = |share: f64| residual <= share * previous;
    if residual <= goal || within(SLOW_REDUCTION) {
        NextCycle::Continue
    } else if precision == Precision::Double && !within(STALLED_REDUCTION) {
        NextCycle::Stop
    } else if within(1.0) {
        NextCycle::Double
    } else {
        NextCycle::DoubleFromZero
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOAL: f64 = 1e-10;

    #[test]
    fn a_cycle_that_pays_or_reaches_the_goal_is_followed_by_the_same() {
        for precision in [Precision::Mixed, Precision::Double] {
            assert_eq!(next_cycle(precision, 1.0, 0.05, GOAL), NextCycle::Continue);
            assert_eq!(next_cycle(precision, 1.5 * GOAL, GOAL, GOAL), NextCycle::Continue);
        }
    }

    #[test]
    fn a_slow_cycle_in_single_precision_is_followed_by_double_precision() {
        assert_eq!(next_cycle(Precision::Mixed, 1.0, 0.2, GOAL), NextCycle::Double);
        assert_eq!(next_cycle(Precision::Mixed, 1.0, 1.0, GOAL), NextCycle::Double);
    }

    #[test]
    fn a_harmful_cycle_in_single_precision_is_undone() {
        assert_eq!(next_cycle(Precision::Mixed, 1.0, 1.1, GOAL), NextCycle::DoubleFromZero);
        assert_eq!(next_cycle(Precision::Mixed, 1.0, f64::NAN, GOAL), NextCycle::DoubleFromZero);
    }

    #[test]
    fn double_precision_goes_on_while_the_residual_halves() {
        assert_eq!(next_cycle(Precision::Double, 1.0, 0.4, GOAL), NextCycle::Double);
        assert_eq!(next_cycle(Precision::Double, 1.0, 0.6, GOAL), NextCycle::Stop);
        assert_eq!(next_cycle(Precision::Double, 1.0, f64::NAN, GOAL), NextCycle::Stop);
    }
}
