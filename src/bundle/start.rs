//! The ways to run a method, and the first evaluation: admissible start, norm, first weight.

use super::builder::BundleTrust;
use super::config::{AccuracyPolicy, BundleTrustConfig};
use super::constrained::Constraints;
use super::cut::Cut;
use super::kept_cuts::Bundle;
use super::limits;
use super::norm::ScaledNorm;
use super::oracle::{Oracle, OracleResult, WarmStarted, evaluate};
use super::proposers::list::Proposers;
use super::proposers::proposal::FEASIBILITY;
use super::run::Run;
use super::seen::Seen;
use super::state::BundleState;
use super::verdict;
use crate::checks::check_size;
use crate::composite::{LinearizationRequest, Linearized, OuterFunction};
use crate::qp::{EpigraphQpSolver, IndependentRows, QpError, is_only_point, nearest};
use crate::report::{Counts, IterationRecord, Origin, Report, StepKind};
use crate::{
    Accuracy, ConstraintKind, Evaluation, InputError, NonsmoothObjective, OptimizeError, OracleError, Polyhedron,
    Request, Vector,
};
use std::cell::RefCell;
use std::ops::ControlFlow::Break;
use std::time::Instant;

/// Relative violation that a projected start may keep.
const MAX_START_VIOLATION: f64 = 1e-9;
/// A start shorter than this share of the distance at which a linear Θ would vanish says nothing about lengths.
const LEAST_START_SHARE: f64 = 1e-6;

impl<'o> BundleTrust<'o> {
    /// Minimises the objective from a start that need not be admissible.
    ///
    /// # Errors
    /// As [`start`](Self::start). Everything that happens later ends in a [`Report`].
    pub fn minimize<O: NonsmoothObjective>(&mut self, objective: &O, x0: Vector) -> Result<Report, OptimizeError> {
        let mut run = self.start(objective, x0)?;
        while run.step().is_continue() {}
        Ok(run.finish())
    }

    /// Projects the start on the admissible set and evaluates it.
    ///
    /// # Errors
    /// [`OptimizeError::Input`] on sizes and numbers, [`OptimizeError::Infeasible`] if the set is empty or the start
    /// cannot be projected on it, [`OptimizeError::Oracle`] if the first evaluation fails or gives −∞.
    pub fn start<'r, O: NonsmoothObjective>(
        &'r mut self,
        objective: &'r O,
        x0: Vector,
    ) -> Result<Run<'r, 'o>, OptimizeError> {
        let clock = Instant::now();
        let kinds = objective.constraint_kinds();
        self.begin(Box::new(WarmStarted::new(objective)), objective.outer(), kinds, objective.dimension(), x0, clock)
    }

    fn begin<'r>(
        &'r mut self,
        mut oracle: Box<dyn Oracle + 'r>,
        outer: Option<&'r dyn OuterFunction>,
        kinds: &[ConstraintKind],
        dimension: usize,
        x0: Vector,
        clock: Instant,
    ) -> Result<Run<'r, 'o>, OptimizeError> {
        let set = self.constraints.clone().unwrap_or_else(|| Polyhedron::unbounded(dimension));
        InputError::check_vector("start point", dimension, &x0)?;
        check_size("constraints", dimension, set.dimension())?;
        let norm = ScaledNorm::new(&self.config.scaling, &set)?;
        let rows = IndependentRows::new(&set, |i| norm.unit(i));
        let start = admissible_start(&set, &rows, x0)?;
        let outer = outer.filter(|_| self.config.composite_model);
        let (state, linearization) =
            first_evaluation(oracle.as_mut(), outer.is_some(), kinds, &self.config, &rows.set, norm, start)?;
        oracle.keep_warm_start();
        let proposers = Proposers::new(outer.is_some(), dimension, state.first_weight);
        let mut run = Run {
            method: self,
            oracle,
            outer,
            rows,
            working: None,
            state,
            solver: EpigraphQpSolver::default(),
            proposers,
            termination: None,
            proof: None,
            clock,
            ways_out: (0, 0),
        };
        let (known, noted) = run.take_linearization(linearization);
        run.tell(|proposer, at| proposer.recenter(at, known.as_ref()));
        let seconds = clock.elapsed().as_secs_f64();
        if let Some(first) = run.state.history.first_mut() {
            first.seconds = seconds;
            first.note(noted);
        }
        if let Break(termination) = limits::after_evaluation(&run.state, run.method) {
            run.termination = Some(termination);
        } else if is_only_point(&run.rows.set, &run.state.center, run.state.length_scale().max(run.state.first_step)) {
            // Every subgradient is balanced by the constraints: nothing is left to find.
            run.termination = Some(run.ask(|_, at| verdict::only_point(at)));
        }
        Ok(run)
    }
}

/// Moves the start into the admissible set.
fn admissible_start(set: &Polyhedron, rows: &IndependentRows, x0: Vector) -> Result<Vector, OptimizeError> {
    let before = set.violation(&x0);
    let refused = |error| match error {
        QpError::Infeasible { violation } => OptimizeError::Infeasible { violation },
        _ => OptimizeError::Infeasible { violation: before },
    };
    let set = rows.consistent(set, &x0).map_err(refused)?;
    if set.violation(&x0) <= FEASIBILITY {
        return Ok(set.clamp_to_box(&x0));
    }
    let projected = nearest(set, &x0).map_err(refused)?;
    let violation = set.violation_near(&projected, &x0);
    if violation <= MAX_START_VIOLATION { Ok(projected) } else { Err(OptimizeError::Infeasible { violation }) }
}

/// The state after the first evaluation, and what that said about outputs and Jacobian.
type FirstEvaluation = (BundleState, Linearized);

/// Evaluates the start and sets up the state.
fn first_evaluation(
    oracle: &mut dyn Oracle,
    structured: bool,
    kinds: &[ConstraintKind],
    config: &BundleTrustConfig,
    set: &Polyhedron,
    norm: ScaledNorm,
    start: Vector,
) -> Result<FirstEvaluation, OptimizeError> {
    let accuracy = first_accuracy(config)?;
    let wanted = structured.then(|| LinearizationRequest::below(f64::INFINITY));
    let request = Request { linearization: wanted, accuracy, ..Request::tight(&start) };
    let evaluation = match evaluate(oracle, &request, kinds.len(), None) {
        OracleResult::Answer(answer) => answer.into_evaluation(),
        OracleResult::MinusInfinity => return Err(OptimizeError::Oracle(OracleError::NotFinite { what: "value" })),
        OracleResult::Failure(error) => return Err(OptimizeError::Oracle(error)),
    };
    let Evaluation { value, subgradient, error_bound, linearization, constraints, work, .. } = evaluation;
    let slope = norm.dual_length(&subgradient);
    let first_step = config.first_step.unwrap_or_else(|| natural_step(norm.length(&start), value, slope));
    let weight = if slope > 0.0 { slope / first_step } else { 1.0 };
    let known = |found| Box::new(Constraints::new(kinds, &start, value, found, &norm, slope));
    let constraints = constraints.as_ref().map(known);
    let (point, seen) = (start.clone(), Seen::new(&start, value, &subgradient));
    let cut =
        Cut { id: 1, point, radius: 0.0, value, subgradient, error_bound, certified: false, multiplier: 0.0, idle: 0 };
    let mut state = BundleState {
        norm,
        start: start.clone(),
        start_value: value,
        center: start,
        center_value: value,
        center_id: 1,
        bundle: Bundle::default(),
        seen,
        lowest: None,
        next_id: 2,
        weight,
        first_weight: weight,
        floor_share: 1.0,
        first_step,
        center_accuracy: accuracy.tolerance(),
        nonconvex: false,
        noise: 0.0,
        failures: 0,
        longest_step: None,
        known_trials: 0,
        counts: Counts { evaluations: 1, ..Counts::default() },
        history: vec![],
        output_scales: None,
        constraints,
        lengths: RefCell::default(),
    };
    state.bundle.push(cut, &state.norm);
    state.history.push(first_record(&state, set, slope, work));
    Ok((state, linearization))
}

/// The accuracy that the start is evaluated with.
fn first_accuracy(config: &BundleTrustConfig) -> Result<Accuracy, InputError> {
    match config.accuracy {
        AccuracyPolicy::OnDemand { coarsest, .. } => Accuracy::relative(coarsest),
        AccuracyPolicy::Tightest => Ok(Accuracy::TIGHTEST),
    }
}

/// A first step length that follows the units of variables and values: the length of the start, or where this is zero
/// the distance at which a linear Θ would vanish; 1 where both are zero. A length below a small share of this distance
/// is a rounding of zero, and the share takes its place.
fn natural_step(size: f64, value: f64, slope: f64) -> f64 {
    let vanishing = if slope > 0.0 { value.abs() / slope } else { 0.0 };
    if size > 0.0 {
        size.max(LEAST_START_SHARE * vanishing)
    } else if vanishing > 0.0 {
        vanishing
    } else {
        1.0
    }
}

fn first_record(state: &BundleState, set: &Polyhedron, slope: f64, work: usize) -> IterationRecord {
    IterationRecord {
        evaluation: 1,
        kind: StepKind::Start,
        origin: Origin::Given,
        value: Some(state.start_value),
        center_value: state.start_value,
        predicted_decrease: 0.0,
        aggregate_norm: slope,
        aggregate_error: 0.0,
        weight: state.weight,
        step_length: 0.0,
        violation: set.violation(&state.start),
        cuts: 1,
        convexification: 0.0,
        accuracy: state.center_accuracy,
        failure: None,
        jacobian: false,
        note: None,
        work,
        seconds: 0.0,
    }
}
