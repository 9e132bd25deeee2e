//! Whether a history of residuals still promises progress.

/// Newton steps in which the best residual must at least halve.
const MAX_CIRCLING_STEPS: usize = 16;

/// Whether the residual has not halved in the last `window` steps.
pub fn stagnates(history: &[f64], window: usize) -> bool {
    history.len() > window && history[history.len() - 1] > 0.5 * history[history.len() - 1 - window]
}

/// Whether the best residual of the last steps is more than half of the best before: active sets repeat.
pub fn circles(history: &[f64]) -> bool {
    let best = |part: &[f64]| part.iter().copied().fold(f64::INFINITY, f64::min);
    history.len() > 2 * MAX_CIRCLING_STEPS && {
        let (before, last) = history.split_at(history.len() - MAX_CIRCLING_STEPS);
        best(last) > 0.5 * best(before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_residual_that_halves_goes_on_and_one_that_repeats_does_not() {
        assert!(!stagnates(&[1.0, 0.4], 1) && stagnates(&[1.0, 0.6], 1) && !stagnates(&[1.0], 1));
        let falling: Vec<f64> = (0..40).map(|step| 0.9_f64.powi(step)).collect();
        let repeating: Vec<f64> = (0..40).map(|step| [1.0, 0.3, 0.7][step % 3]).collect();
        assert!(!circles(&falling) && circles(&repeating) && !circles(&repeating[..32]));
    }
}
