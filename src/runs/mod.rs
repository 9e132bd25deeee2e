//! Several runs that lead to one result: starts, subspaces, objectives in turn.
//!
//! A [`Stage`] is a run that has not begun: an objective, a set, a start, settings and, if the run moves in a subspace,
//! its directions. [`run_in_turn`] asks for one stage after the other. Whoever chooses the next stage knows how the
//! runs before it have ended; whoever performs a stage decides about journals, progress and interruptions. Stages that
//! are chosen from reports alone are chosen again in the same way when a run is repeated from its journals.
//!
//! ```
//! use nonsmooth::runs::{Ended, Stage, run_in_turn, seeded_start};
//! use nonsmooth::{BundleTrustConfig, FnObjective, Polyhedron, Vector};
//! use std::ops::ControlFlow;
//! use std::sync::Arc;
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // |x² − 1| + 0.1 |x − 1| has a local minimum at −1 and its least one at 1.
//! let theta = Arc::new(FnObjective::new(1, |x: &Vector| {
//!     let [bowl, slope] = [x[0] * x[0] - 1.0, x[0] - 1.0];
//!     (bowl.abs() + 0.1 * slope.abs(), Vector::from_element(1, bowl.signum() * 2.0 * x[0] + 0.1 * slope.signum()))
//! }));
//! let set = Polyhedron::boxed(Vector::from_element(1, -3.0), Vector::from_element(1, 3.0))?;
//! let first = Vector::from_element(1, -2.0);
//! let mut ended: Vec<Ended<_, usize>> = Vec::new();
//! let next = |ended: &[Ended<_, usize>]| {
//!     if ended.len() == 4 {
//!         return Ok(None);
//!     }
//!     let start = seeded_start(&set, &first, 4.0, ended.len() as u64)?;
//!     let (objective, set, config) = (Arc::clone(&theta), set.clone(), BundleTrustConfig::default());
//!     Ok(Some(Stage { label: ended.len(), objective, set, start, directions: None, config }))
//! };
//! let perform = |stage: Stage<_, usize>| {
//!     let report = stage.run(&*stage.objective, &mut |_, _| ControlFlow::Continue(()))?;
//!     Ok(Ended { stage, report, replayed: 0, is_kept: true, is_last: false })
//! };
//! run_in_turn::<_, _, Box<dyn std::error::Error>>(&mut ended, next, perform)?;
//! let best = ended.iter().map(|run| run.report.value).fold(f64::INFINITY, f64::min);
//! assert!(ended.len() == 4 && best < 1e-6);
//! # Ok(())
//! # }
//! ```

mod subspace;

pub use subspace::Subspace;

use crate::qp::{QpError, project};
use crate::verify::seeded_direction;
use crate::{
    BundleTrust, BundleTrustConfig, IterationRecord, Matrix, NonsmoothObjective, OptimizeError, Polyhedron, Report,
    Termination, Vector,
};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Sees every step of a run that ends with evaluations: the best point so far, which lies in the space of the
/// objective, and the records that are new. `Break` ends the run.
pub type Watch<'w> = dyn FnMut(&Vector, &[IterationRecord]) -> ControlFlow<()> + 'w;

/// A run that has not begun; `L` says what it is among others.
#[derive(Debug)]
pub struct Stage<O, L> {
    /// The label of the run.
    pub label: L,
    /// The objective to minimise.
    pub objective: Arc<O>,
    /// The admissible set.
    pub set: Polyhedron,
    /// Where the run begins.
    pub start: Vector,
    /// The run moves from its start along these columns alone; none: in the whole space.
    pub directions: Option<Matrix>,
    /// The settings of the run; in a subspace, its scaling is one of the coefficients of the directions.
    pub config: BundleTrustConfig,
}

/// A run that has ended.
#[derive(Debug)]
pub struct Ended<O, L> {
    /// The run as it began.
    pub stage: Stage<O, L>,
    /// The report, with a solution in the space of the objective.
    pub report: Report,
    /// Number of evaluations that were answered from a journal.
    pub replayed: usize,
    /// Whether its journal, if it has one, holds all evaluations.
    pub is_kept: bool,
    /// Whether no other run may begin, whatever its end.
    pub is_last: bool,
}

impl<O, L> Stage<O, L> {
    /// Performs the run. `objective` is that of the stage, or what stands for it: one with a journal, for example.
    ///
    /// # Errors
    /// As [`BundleTrust::start`], and [`OptimizeError::Input`] for settings or directions that cannot be worked with.
    pub fn run<P: NonsmoothObjective>(&self, objective: &P, watch: &mut Watch<'_>) -> Result<Report, OptimizeError> {
        let method = BundleTrust::new(self.config.clone())?;
        let Some(directions) = &self.directions else {
            return watched(method.constraints(self.set.clone()), objective, self.start.clone(), watch);
        };
        let subspace = Subspace::new(objective, self.start.clone(), directions.clone());
        let method = method.constraints(subspace.set(&self.set)?);
        let origin = Vector::zeros(directions.ncols());
        let mut seen = |center: &Vector, new: &[IterationRecord]| watch(&subspace.point(center), new);
        Ok(subspace.reported(watched(method, &subspace, origin, &mut seen)?))
    }
}

/// The run of a method that is watched.
fn watched<O: NonsmoothObjective>(
    mut method: BundleTrust<'_>,
    objective: &O,
    start: Vector,
    watch: &mut Watch<'_>,
) -> Result<Report, OptimizeError> {
    let mut run = method.start(objective, start)?;
    let (mut told, mut goes_on) = (0, true);
    loop {
        // What ended the run is told too.
        let is_stopped = watch(run.center(), &run.history()[told..]).is_break();
        told = run.history().len();
        if is_stopped || !goes_on {
            let mut report = run.finish();
            if is_stopped && report.termination == Termination::Unfinished {
                report.termination = Termination::StoppedByObserver;
            }
            return Ok(report);
        }
        goes_on = run.step().is_continue();
    }
}

/// Performs one stage after the other until there is no next one, until one may not be followed by others, or until one
/// has used up its time. The runs are added to those that have ended before, and stay there when a later one fails.
///
/// # Errors
/// The first error of `next`, which chooses a stage by the runs that have ended, and of `perform`.
pub fn run_in_turn<O, L, E>(
    ended: &mut Vec<Ended<O, L>>,
    mut next: impl FnMut(&[Ended<O, L>]) -> Result<Option<Stage<O, L>>, E>,
    mut perform: impl FnMut(Stage<O, L>) -> Result<Ended<O, L>, E>,
) -> Result<(), E> {
    let goes_on = |run: &Ended<O, L>| !run.is_last && run.report.termination != Termination::TimeLimit;
    while ended.last().is_none_or(goes_on)
        && let Some(stage) = next(ended)?
    {
        ended.push(perform(stage)?);
    }
    Ok(())
}

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
