//! The runs of an optimization, one after the other.

use crate::optimization::coarse_net::coarse_net;
use crate::optimization::stages::stages;
use crate::optimization::ways::{Beginning, beginning};
use crate::optimization::{Attempt, ContactRun, Label, OptimizationError, Part, PlannedRun, Runs};
use crate::{AccuracyName, Case, MethodName};
use contact::contact_objective::ContactObjective;
use contact::error::SceneError;
use contact::solvers::Processes;
use nonsmooth::runs::{Stage, run_in_turn};
use nonsmooth::{AccuracyPolicy, BundleTrustConfig, VariableScaling, Vector};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

/// A run of an optimization that has not begun.
pub type ContactStage = Stage<ContactObjective, Label>;

/// Predicted decrease, relative to Θ, and number of evaluations at which an attempt ends: enough to tell which one is
/// worth to go on from. What a coarse net has found is refined almost to its end, since that is where the whole run
/// then begins; a first run that is cut off there would have to learn its model again.
fn ends(attempt: Attempt) -> (f64, usize) {
    match attempt {
        Attempt::Direct | Attempt::Start(_) => (1e-2, 10),
        Attempt::Coarse => (1e-2, 25),
        Attempt::Refined => (1e-3, 25),
    }
}

/// The settings of the optimizer of a case.
pub fn settings(case: &Case) -> BundleTrustConfig {
    BundleTrustConfig {
        max_evaluations: case.optimizer.max_evaluations,
        tolerance: case.tolerance,
        max_seconds: case.optimizer.time_limit,
        first_step: case.optimizer.first_step,
        bundle_size: case.optimizer.bundle_size,
        accuracy: match case.optimizer.accuracy {
            AccuracyName::Tightest => AccuracyPolicy::Tightest,
            AccuracyName::OnDemand => AccuracyPolicy::ON_DEMAND,
        },
        composite_model: case.method == MethodName::Composite,
        ..BundleTrustConfig::default()
    }
}

/// Optimizes a case from its start, in this process and without a journal.
///
/// # Errors
/// [`OptimizationError`] of the scene, of a start, and of the first evaluation of a run.
pub fn optimize(case: &Case) -> Result<Runs, OptimizationError> {
    let (processes, mut runs) = (Processes::alone(), Runs::default());
    let (start, clock) = (Vector::from_vec(case.start_controls()), Instant::now());
    Driver::new(case, &processes)?.run((&start, &settings(case), clock), &mut runs, |stage| {
        let report = stage.run(&*stage.objective, &mut |_, _| ControlFlow::Continue(()))?;
        Ok::<_, OptimizationError>(ContactRun { stage, report, replayed: 0, is_kept: true, is_last: false })
    })?;
    Ok(runs)
}

/// The optimization of a case, with Θ on its first mesh.
#[derive(Debug)]
pub struct Driver<'p> {
    planned: Vec<PlannedRun>,
    first: Arc<ContactObjective>,
    processes: &'p Processes,
}

impl<'p> Driver<'p> {
    /// Prepares the solver of the first mesh. What is wrong on a later mesh is said before hours of work on the first.
    ///
    /// # Errors
    /// As [`Case::prepared`] and [`Case::check_ahead`].
    pub fn new(case: &Case, processes: &'p Processes) -> Result<Self, SceneError> {
        let planned = stages(case);
        let first = Arc::new(planned[0].case.prepared(case.wanted(), processes)?);
        let meshes = planned.iter().filter(|run| matches!(run.part, Part::Mesh(_)));
        for (index, later) in meshes.enumerate().skip(1) {
            let file = format!("optimizer.continuation[{index}]");
            let within = |source| SceneError::InFile { file, source: Box::new(source) };
            later.case.check_ahead(case.wanted(), processes).map_err(within)?;
        }
        Ok(Self { planned, first, processes })
    }

    /// Θ on the first mesh.
    pub fn objective(&self) -> &ContactObjective {
        &self.first
    }

    /// Optimizes from some controls, on all meshes in turn. `perform` makes a run, with a journal and an observer if the
    /// caller has some. `config`: as [`settings`]; its number of evaluations holds for every run, its time from `clock`
    /// on for all of them, its scaling, unless that is the usual one, for runs with all controls. The runs stay in `runs`
    /// when a later one fails.
    ///
    /// # Errors
    /// Those of `perform`, and [`OptimizationError`].
    pub fn run<E: From<OptimizationError>>(
        &self,
        (start, config, clock): (&Vector, &BundleTrustConfig, Instant),
        runs: &mut Runs,
        perform: impl FnMut(ContactStage) -> Result<ContactRun, E>,
    ) -> Result<(), E> {
        let step = config.first_step.unwrap_or_else(|| self.first.first_step(start));
        let Runs { ended, asked } = runs;
        *asked = self.planned.len();
        let mut planned = self.planned.iter().enumerate();
        let next = |ended: &[ContactRun]| -> Result<Option<ContactStage>, E> {
            for (index, run) in planned.by_ref() {
                let objective = self.objective_of(index, run).map_err(OptimizationError::from)?;
                if let Some(beginning) = beginning(run.part, &objective, ended, (start, step))? {
                    return Ok(Some(stage(run.part, objective, beginning, (config, clock))?));
                }
                *asked -= 1;
            }
            Ok(None)
        };
        run_in_turn(ended, next, perform)
    }

    /// Θ of a planned run; all runs on one mesh share it.
    fn objective_of(&self, index: usize, run: &PlannedRun) -> Result<Arc<ContactObjective>, SceneError> {
        if index == 0 || !matches!(run.part, Part::Mesh(_)) {
            return Ok(Arc::clone(&self.first));
        }
        Ok(Arc::new(run.case.prepared(run.case.wanted(), self.processes)?))
    }
}

/// A run from where it begins.
fn stage(
    part: Part,
    objective: Arc<ContactObjective>,
    Beginning { controls: start, first_step, bending_before }: Beginning,
    (config, clock): (&BundleTrustConfig, Instant),
) -> Result<ContactStage, OptimizationError> {
    let net = match part {
        Part::Try(Attempt::Coarse) => Some(coarse_net(&objective.solver().problem().scene)?),
        _ => None,
    };
    let scaling = match (&config.scaling, &net) {
        (_, Some(net)) => VariableScaling::Linear(objective.net_coordinates(&start, &net.counts, first_step)),
        (VariableScaling::FromBox, None) => VariableScaling::Linear(objective.coordinates(&start, first_step)),
        (given, None) => given.clone(),
    };
    let (tolerance, evaluations) = match part {
        Part::Try(attempt) => ends(attempt),
        _ => (0.0, usize::MAX),
    };
    let left = |limit: f64| (limit - clock.elapsed().as_secs_f64()).max(f64::MIN_POSITIVE);
    let config = BundleTrustConfig {
        max_evaluations: config.max_evaluations.min(evaluations),
        tolerance: config.tolerance.max(tolerance),
        confirm: config.confirm && !part.is_attempt(),
        max_seconds: config.max_seconds.map(left),
        first_step: Some(first_step),
        scaling,
        ..config.clone()
    };
    let set = objective.solver().problem().admissible.polyhedron().clone();
    Ok(Stage {
        label: Label { part, bending_before },
        objective,
        set,
        start,
        directions: net.map(|net| net.directions),
        config,
    })
}
