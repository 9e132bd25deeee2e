//! One run of the engine on the toy with all points evaluated; values and kinks over the box for pictures.

use super::{LOWER, SURFACE, UPPER, admissible_set, toy_objective};
use nonsmooth::{
    Accuracy, BundleTrust, BundleTrustConfig, Cost, Evaluation, FnObjective, NonsmoothObjective, OptimizeError,
    OracleError, Report, Request, StateSolver, Vector,
};
use std::cell::RefCell;

/// Tolerance of the runs; sharp growth turns it into a distance of about five times this.
const TOLERANCE: f64 = 1e-10;

/// A run with the points of its evaluations.
#[derive(Debug, Clone)]
pub struct ToyTrace {
    /// The report of the engine, with one record per evaluation.
    pub report: Report,
    /// The points of the evaluations.
    pub points: Vec<[f64; 2]>,
}

/// Runs the engine from a start.
///
/// # Errors
/// [`OptimizeError`] if the start is not finite.
pub fn trace(start: [f64; 2]) -> Result<ToyTrace, OptimizeError> {
    let (objective, points) = (toy_objective(), RefCell::new(Vec::new()));
    let recorded = FnObjective::new(2, |control: &Vector| {
        points.borrow_mut().push([control[0], control[1]]);
        let answer =
            objective.evaluate(&Request::tight(control)).expect("invariant: the engine asks at finite controls");
        let Evaluation { value, subgradient, .. } = answer.into_evaluation();
        (value, subgradient)
    });
    let config = BundleTrustConfig { tolerance: TOLERANCE, ..BundleTrustConfig::default() };
    let mut method = BundleTrust::new(config)?.constraints(admissible_set());
    let report = method.minimize(&recorded, Vector::from_row_slice(&start))?;
    Ok(ToyTrace { report, points: points.into_inner() })
}

/// Controls on a uniform grid of the admissible box, `cells` + 1 per axis, with Θ; the second control runs fastest.
///
/// # Errors
/// An [`OracleError`] without cells.
///
/// ```
/// let points = problems::toy::landscape(4)?;
/// assert_eq!((points.len(), points[1].0), (25, [-4.0, -1.5]));
/// # Ok::<(), nonsmooth::OracleError>(())
/// ```
pub fn landscape(cells: usize) -> Result<Vec<([f64; 2], f64)>, OracleError> {
    let objective = toy_objective();
    let coordinate = |index: usize| LOWER + (UPPER - LOWER) * index as f64 / cells as f64;
    let controls = (0..=cells).flat_map(|i| (0..=cells).map(move |j| [i, j])).map(|place| place.map(coordinate));
    let point = |control: [f64; 2]| {
        let at = Vector::from_row_slice(&control);
        let state = objective.solver().solve(&at, None, Accuracy::TIGHTEST)?;
        Ok((control, objective.cost().value(&at, &state)))
    };
    controls.map(point).collect()
}

/// The lines in the admissible box on which a node has a kink: ends of each.
pub fn kink_lines() -> Vec<[[f64; 2]; 2]> {
    let objective = toy_objective();
    let nodes = objective.solver().nodes().iter().zip(SURFACE);
    nodes.flat_map(|(node, row)| node.kinks().into_iter().filter_map(move |kink| clipped(row, kink.height))).collect()
}

/// The part of the line row·α = height inside the box; both entries of a row are positive.
fn clipped([first, second]: [f64; 2], height: f64) -> Option<[[f64; 2]; 2]> {
    // Along the line α₁ falls as α₂ rises: its part in the box begins and ends where one of them meets a bound.
    let at = |alpha_2: f64| (height - second * alpha_2) / first;
    let low = LOWER.max((height - first * UPPER) / second);
    let high = UPPER.min((height - first * LOWER) / second);
    (low < high).then(|| [[at(low), low], [at(high), high]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_records_belong_together() {
        let trace = trace([-3.0, 5.0]).expect("a start in the box");
        assert_eq!(trace.points.len(), trace.report.history.len());
        let objective = toy_objective();
        for (point, record) in trace.points.iter().zip(&trace.report.history) {
            let value = objective.evaluate(&Request::tight(&Vector::from_row_slice(point))).expect("in the box");
            assert_eq!(Some(value.evaluation().value), record.value);
        }
    }

    #[test]
    fn kink_lines_end_at_the_box_and_lie_on_kinks() {
        let lines = kink_lines();
        assert_eq!(lines.len(), 6);
        for ends in &lines {
            for point in ends {
                assert!(point.iter().all(|x| (LOWER - 1e-12..=UPPER + 1e-12).contains(x)), "{point:?}");
                assert!(point.iter().any(|x| (x - LOWER).abs() < 1e-12 || (x - UPPER).abs() < 1e-12), "{point:?}");
            }
            let middle = Vector::from_fn(2, |i, _| 0.5 * (ends[0][i] + ends[1][i]));
            let kinks = toy_objective().solver().nearest_kinks(&middle).expect("finite");
            assert!(kinks.iter().flatten().any(|(_, distance)| *distance < 1e-12));
        }
    }
}
