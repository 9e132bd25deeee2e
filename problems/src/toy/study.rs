//! Minimises the toy from many starts and says how far each run ended from the known minimiser.

use super::{Kink, LOWER, MINIMUM, UPPER, admissible_set, minimiser, toy_objective};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{
    Accuracy, BundleTrust, BundleTrustConfig, Cost, OptimizeError, OracleError, StateSolver, Termination, Vector,
};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Tolerance of the runs; sharp growth turns it into a distance of about five times this.
const TOLERANCE: f64 = 1e-10;

/// Distance |α − α*| up to which a run has found the minimiser, mm.
pub const SUCCESS: f64 = 1e-8;

/// One run of the engine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ToyRun {
    /// The controls at which the run starts.
    pub start: [f64; 2],
    /// The controls that it found.
    pub solution: [f64; 2],
    /// Θ at these controls.
    pub value: f64,
    /// The distance |α − α*| of these controls from the minimiser, mm.
    pub error: f64,
    /// Number of evaluations of Θ.
    pub evaluations: usize,
    /// The reason why it ended.
    pub termination: Termination,
}

/// All runs, and the kinks on which the best one ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ToyStudy {
    /// The minimiser in closed form.
    pub minimiser: [f64; 2],
    /// The minimum in closed form.
    pub minimum: f64,
    /// The run that ended nearest to the minimiser.
    pub best: ToyRun,
    /// For each node the kink nearest to the best solution, and the distance of its support from it.
    pub kinks: [Option<(Kink, f64)>; 2],
    /// All runs in the order of the starts.
    pub runs: Vec<ToyRun>,
}

/// `count` reproducible pseudo-random starts in the admissible box.
pub fn random_starts(seed: u64, count: usize) -> Vec<[f64; 2]> {
    let place = |unit: f64| 0.5 * (LOWER + UPPER) + 0.5 * (UPPER - LOWER) * unit;
    let units = seeded_direction(2 * count, seed);
    units.as_slice().chunks_exact(2).map(|pair| [place(pair[0]), place(pair[1])]).collect()
}

/// Runs the engine on the toy from every start; none if there is no start.
///
/// # Errors
/// [`OptimizeError`] if a start is not finite.
///
/// ```
/// let study = problems::toy::run_study(&[[-3.0, 5.0]])?.ok_or("one start")?;
/// assert!(study.best.error < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_study(starts: &[[f64; 2]]) -> Result<Option<ToyStudy>, OptimizeError> {
    let runs = starts.iter().map(run).collect::<Result<Vec<_>, _>>()?;
    let Some(best) = runs.iter().min_by(|a, b| a.error.total_cmp(&b.error)).cloned() else {
        return Ok(None);
    };
    let kinks = toy_objective().solver().nearest_kinks(&Vector::from_row_slice(&best.solution))?;
    Ok(Some(ToyStudy { minimiser: super::MINIMISER, minimum: MINIMUM, best, kinks, runs }))
}

fn run(start: &[f64; 2]) -> Result<ToyRun, OptimizeError> {
    let config = BundleTrustConfig { tolerance: TOLERANCE, ..BundleTrustConfig::default() };
    let mut method = BundleTrust::new(config)?.constraints(admissible_set());
    let report = method.minimize(&toy_objective(), Vector::from_row_slice(start))?;
    Ok(ToyRun {
        start: *start,
        solution: [report.solution[0], report.solution[1]],
        value: report.value,
        error: (&report.solution - minimiser()).norm(),
        evaluations: report.counts.evaluations,
        termination: report.termination,
    })
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

impl ToyStudy {
    /// Number of runs that found the minimiser up to [`SUCCESS`].
    pub fn successes(&self) -> usize {
        self.runs.iter().filter(|run| run.error <= SUCCESS).count()
    }

    /// Whether every run found the minimiser.
    pub fn all_found(&self) -> bool {
        self.successes() == self.runs.len()
    }
}

impl fmt::Display for ToyStudy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, second] = self.best.solution;
        let [exact_first, exact_second] = self.minimiser;
        writeln!(f, "two nodes on a shaped support with Coulomb friction")?;
        writeln!(f, "minimiser:   ({first:.12}, {second:.12})   exact ({exact_first}, {exact_second})")?;
        writeln!(f, "objective:   {:.12}   exact {}", self.best.value, self.minimum)?;
        writeln!(f, "error:       {:.1e}, allowed {SUCCESS:.0e}", self.best.error)?;
        for (node, kink) in self.kinks.iter().enumerate() {
            if let Some((Kink { height, below, above }, distance)) = kink {
                let node = node + 1;
                writeln!(f, "node {node}:      {distance:.1e} from the kink {below} | {above} at height {height}")?;
            }
        }
        writeln!(f, "found by:    {} of {} runs", self.successes(), self.runs.len())?;
        writeln!(
            f,
            "\n{:>10} {:>10} {:>16} {:>9} {:>6}  stopped",
            "start 1", "start 2", "objective", "error", "evals"
        )?;
        for ToyRun { start: [first, second], value, error, evaluations, termination, .. } in &self.runs {
            writeln!(f, "{first:>10.4} {second:>10.4} {value:>16.12} {error:>9.1e} {evaluations:>6}  {termination}")?;
        }
        Ok(())
    }
}
