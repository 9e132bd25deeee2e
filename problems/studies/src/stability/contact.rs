//! A contact case: a scene, its controls, what is expected, the paths that solve it, and how their results compare.

use crate::stability::case::{Case, CaseOutcome, Record};
use contact::contact_shape::Solver;
use contact::direct::DirectSolver;
use contact::equilibrium::{ContactForces, ContactProblem, Diagnosis};
use contact::error::{ContactError, SceneError};
use contact::scene::Scene;
use contact::tfeti::{DualMethod, TornOptions, TotalFeti};
use std::sync::Arc;
use testset::kit::wavy;

/// What a case is expected to end in.
#[derive(Debug, Clone)]
enum Expected {
    /// Certified states on which the paths agree.
    Solved,
    /// All paths refuse with an error of this kind.
    Refused(&'static str),
    /// What the paths do, and the cause. A case that both solve is as good, since rounding decides at the edge.
    Limit(LimitKinds, &'static str),
}

/// Kinds of refusals that are expected of total FETI, then of direct condensation; an empty list expects a state.
type LimitKinds = [&'static [&'static str]; 2];

/// A finding about a solved state, or what is wrong with it.
type Check = Box<dyn Fn(&ContactProblem, &ContactForces) -> Result<String, String> + Send + Sync>;

/// A contact case under construction.
pub struct ContactCase {
    scene: Result<Scene, SceneError>,
    controls: Option<Vec<f64>>,
    expected: Expected,
    check: Option<Check>,
    paper: bool,
}

/// Relative residual asked of the states, of the successive approximations, and of adjoints.
const TOLERANCES: [f64; 3] = [1e-12, 1e-7, 1e-10];
/// Largest relative residual of a solved state. A Newton residual of 1e-9 is accepted where rounding stops a solver;
/// residuals in other norms may be four times as large. The solvers themselves refuse a state only above 1e-8.
const CERTIFICATE: f64 = 4e-9;
/// Largest difference of forces between independent paths, over the largest force. Forces are less accurate than
/// residuals by the condition of the problem.
const AGREEMENT: f64 = 1e-6;
/// Largest difference of the sensitivities of the control heights.
const SUBGRADIENT_AGREEMENT: f64 = 1e-4;
/// Share of a brick's stiffness that is zero for a sensitivity.
const NEGLIGIBLE: f64 = 1e-6;

/// A state found by one path.
pub struct Found {
    pub residual: f64,
    pub forces: ContactForces,
    /// Sensitivities of the control heights, for a dual that is nothing special.
    pub heights: Result<Vec<f64>, String>,
    diagnosis: Option<Diagnosis>,
    /// The contraction that the successive approximations observed.
    contraction: Option<f64>,
}

/// What one solver did.
pub struct Attempt {
    solver: &'static str,
    /// Newton steps and products with the dual operator.
    pub work: String,
    /// The state, or kind and text of the error.
    pub found: Result<Found, (String, String)>,
}

impl Attempt {
    fn new(
        name: &'static str,
        solver: Result<Solver, ContactError>,
        controls: &[f64],
        tolerance: f64,
        diagnosed: bool,
    ) -> Self {
        match solver.and_then(|solver| Ok((solver.solve(controls, None, tolerance)?, solver))) {
            Ok((state, solver)) => {
                let (steps, products) = (state.work().newton_steps, state.work().dual_operator_applications);
                let work = if products > 0 { format!("{steps}: {products}") } else { steps.to_string() };
                let problem = solver.problem();
                let dual: Vec<f64> = (0..problem.boundary.row_count).map(|row| (0.7 * row as f64).cos()).collect();
                let heights = solver.sensitivities(&state.solution, &dual, TOLERANCES[2]);
                let found = Found {
                    residual: state.forces.residuals.largest(),
                    heights: heights.map(|found| problem.map.pull_back(&found.positions)).map_err(|e| e.to_string()),
                    diagnosis: diagnosed.then(|| solver.diagnose(&state.solution).ok()).flatten(),
                    contraction: state.contraction,
                    forces: state.forces,
                };
                Self { solver: name, work, found: Ok(found) }
            }
            Err(error) => Self { solver: name, work: "–".into(), found: Err((error.kind(), error.to_string())) },
        }
    }

    /// Total FETI and the semismooth Newton method.
    pub fn by_tfeti(problem: &Arc<ContactProblem>, controls: &[f64]) -> Self {
        let solver = TotalFeti::new(Arc::clone(problem), TornOptions::default()).map(Solver::from);
        Self::new("tfeti", solver, controls, TOLERANCES[0], false)
    }

    /// Newton on condensed bodies.
    pub fn by_condensation(problem: &Arc<ContactProblem>, controls: &[f64]) -> Self {
        let solver = DirectSolver::new(Arc::clone(problem)).map(Solver::from);
        Self::new("direct", solver, controls, TOLERANCES[0], true)
    }

    /// Successive approximations on TFETI.
    fn by_successive_approximations(problem: &Arc<ContactProblem>, controls: &[f64]) -> Self {
        let solver = TotalFeti::new(Arc::clone(problem), TornOptions::default());
        let solver = solver.map(|solver| Solver::from(solver.with_method(DualMethod::SuccessiveApproximations)));
        Self::new("successive approximations", solver, controls, TOLERANCES[1], false)
    }

    fn kind(&self) -> Option<&str> {
        self.found.as_ref().err().map(|(kind, _)| &**kind)
    }

    fn text(&self, with_reason: bool) -> String {
        match &self.found {
            Ok(_) => format!("{}: a state", self.solver),
            Err((kind, reason)) if with_reason => format!("{}: {kind}: {reason}", self.solver),
            Err((kind, _)) => format!("{}: {kind}", self.solver),
        }
    }
}

impl ContactCase {
    /// A case that is to be solved at the scene's start shape.
    pub fn new(scene: Result<Scene, SceneError>) -> Self {
        Self { scene, controls: None, expected: Expected::Solved, check: None, paper: false }
    }

    #[must_use]
    pub fn at(self, controls: Vec<f64>) -> Self {
        Self { controls: Some(controls), ..self }
    }

    /// At a gently wavy surface below the start height.
    #[must_use]
    pub fn wavy(self) -> Self {
        Self { controls: self.scene.as_ref().ok().map(wavy_controls), ..self }
    }

    /// Expects a refusal of all paths.
    #[must_use]
    pub fn refused(self, kind: &'static str) -> Self {
        Self { expected: Expected::Refused(kind), ..self }
    }

    /// Expects a known limit.
    #[must_use]
    pub fn limit(self, kinds: LimitKinds, cause: &'static str) -> Self {
        Self { expected: Expected::Limit(kinds, cause), ..self }
    }

    /// Looks at the state.
    #[must_use]
    pub fn check(
        self,
        check: impl Fn(&ContactProblem, &ContactForces) -> Result<String, String> + Send + Sync + 'static,
    ) -> Self {
        Self { check: Some(Box::new(check)), ..self }
    }

    /// Also by the successive approximations.
    #[must_use]
    pub fn with_paper(self) -> Self {
        Self { paper: true, ..self }
    }

    /// The case as a line of the matrix.
    pub fn case(self, group: &'static str, name: impl Into<String>) -> Case {
        Case::new(group, name, move || self.record())
    }

    /// Runs the case by all its paths and compares their results.
    fn record(&self) -> Record {
        let scene = self.scene.as_ref().map_err(ToString::to_string);
        let problem = scene.and_then(|scene| ContactProblem::new(scene.clone()).map_err(|error| error.to_string()));
        let problem = match problem.map(Arc::new) {
            Ok(problem) => problem,
            Err(reason) => {
                let expected = matches!(self.expected, Expected::Refused("Scene"));
                return Record::plain(if expected { CaseOutcome::Refused } else { CaseOutcome::Broken }, reason);
            }
        };
        let start = problem.scene.start();
        let controls = self.controls.as_ref().unwrap_or(&start);
        let paths = [Attempt::by_tfeti(&problem, controls), Attempt::by_condensation(&problem, controls)];
        let mut record = Record { work: paths.iter().map(|path| path.work.clone()).collect(), ..Record::default() };
        record.residual = paths.iter().flat_map(|path| &path.found).map(|found| found.residual).reduce(f64::max);
        if let Some(diagnosis) = paths[1].found.as_ref().ok().and_then(|found| found.diagnosis.as_ref()) {
            (record.contraction, record.condition) = (Some(diagnosis.contraction), diagnosis.condition);
        }
        (record.outcome, record.remark) = self
            .verdict(&problem, &mut record, &paths)
            .unwrap_or_else(|wrong| (CaseOutcome::Broken, format!("{wrong}; {}", texts(&paths, true))));
        let contracts = record.contraction.is_none_or(|factor| factor < 1.0);
        if !contracts {
            record.remark += "; Φ does not contract: uniqueness is not proved, other equilibria may exist";
        }
        if self.paper {
            let paper = Attempt::by_successive_approximations(&problem, controls);
            record.remark += &format!("; {}", paper.text(true));
            if let (Ok(found), Ok(torn)) = (&paper.found, &paths[0].found) {
                let difference = force_difference(&found.forces, &torn.forces);
                let observed = found.contraction.unwrap_or(0.0);
                record.remark += &format!(", observed contraction {observed:.3}, forces differ by {difference:.1e}");
                // An accurate pressure costs accuracy of the residual; where Φ does not contract, another equilibrium
                // is one.
                if contracts && difference > 100.0 * AGREEMENT {
                    record.outcome = CaseOutcome::Broken;
                }
            }
        }
        record.remark = record.remark.trim_start_matches("; ").to_owned();
        record
    }

    /// The outcome of the two Newton paths and the remark, or what is not as expected.
    fn verdict(
        &self,
        problem: &ContactProblem,
        record: &mut Record,
        paths: &[Attempt; 2],
    ) -> Result<(CaseOutcome, String), String> {
        match (&self.expected, &paths[0].found, &paths[1].found) {
            (Expected::Refused(kind), Err((_, reason)), Err(_))
                if paths.iter().all(|path| path.kind() == Some(kind)) =>
            {
                Ok((CaseOutcome::Refused, format!("{kind}: {reason}")))
            }
            // At the edge of double precision a known limit may be solved after all: then it is.
            (Expected::Solved | Expected::Limit(..), Ok(torn), Ok(direct)) => {
                let finding = self.checked(problem, record, torn)?;
                self.checked(problem, record, direct)?;
                compare(problem, record, torn, direct)?;
                Ok((CaseOutcome::Solved, finding))
            }
            (Expected::Limit(kinds, cause), torn, direct) => {
                let alike = |(path, kinds): (&Attempt, &&[&str])| {
                    path.kind().map_or(kinds.is_empty(), |kind| kinds.contains(&kind))
                };
                if !paths.iter().zip(kinds).all(alike) {
                    return Err("another limit".into());
                }
                let found = torn.as_ref().or(direct.as_ref()).ok();
                let finding = found.map_or(Ok(String::new()), |found| self.checked(problem, record, found))?;
                Ok((CaseOutcome::Limit, format!("{}; {cause} {finding}", texts(paths, false))))
            }
            _ => Err("not as expected".into()),
        }
    }

    /// Finite numbers, the certificate, and the case's own check.
    fn checked(&self, problem: &ContactProblem, record: &Record, found: &Found) -> Result<String, String> {
        let forces = &found.forces;
        let numbers = forces.normal.iter().chain(&forces.opening).chain(forces.tangential.iter().flatten());
        if numbers.chain(forces.slip.iter().flatten()).any(|value| !value.is_finite()) {
            return Err("a result is not finite".into());
        }
        if !record.residual.is_some_and(|residual| residual <= CERTIFICATE) {
            return Err(format!("certificate {:.1e}", record.residual.unwrap_or(f64::NAN)));
        }
        self.check.as_ref().map_or(Ok(String::new()), |check| check(problem, forces))
    }
}

/// What all paths did.
fn texts(paths: &[Attempt], with_reasons: bool) -> String {
    let texts: Vec<String> = paths.iter().map(|path| path.text(with_reasons)).collect();
    texts.join(", ")
}

/// Control heights of a gently wavy surface below the start height of a scene.
pub fn wavy_controls(scene: &Scene) -> Vec<f64> {
    let start = scene.start();
    wavy(start[0], start.len())
}

/// Agreement of forces and sensitivities of two states.
fn compare(problem: &ContactProblem, record: &mut Record, torn: &Found, direct: &Found) -> Result<(), String> {
    let difference = force_difference(&torn.forces, &direct.forces);
    record.force_difference = Some(difference);
    if difference.is_nan() || difference > AGREEMENT {
        return Err(format!("the paths' forces differ by {difference:.1e}"));
    }
    let (first, second) = (torn.heights.as_ref()?, direct.heights.as_ref()?);
    // Where equilibrium alone determines the forces, sensitivities vanish up to rounding of a brick's stiffness.
    let body = &problem.scene.bodies[0];
    let brick = body.block().map_or(0.0, |block| block.size[0] / block.bricks[0] as f64);
    let difference = difference_over(first, second, NEGLIGIBLE * body.material.young_modulus() * brick);
    // On a kink every path selects an element of its own.
    let smooth = torn.forces.kink.weakly_active == 0 && direct.forces.kink.weakly_active == 0;
    record.subgradient_difference = smooth.then_some(difference);
    if difference.is_nan() || smooth && difference > SUBGRADIENT_AGREEMENT {
        return Err(format!("the paths' subgradients differ by {difference:.1e}"));
    }
    Ok(())
}

/// Largest difference of contact forces over the largest normal force; 0 when there are none at all.
pub fn force_difference(first: &ContactForces, second: &ContactForces) -> f64 {
    let all = |forces: &ContactForces| -> Vec<f64> {
        forces.normal.iter().chain(forces.tangential.iter().flatten()).copied().collect()
    };
    difference_over(&all(first), &all(second), 0.0)
}

/// |a − b|∞ over the larger of |a|∞, |b|∞ and a floor; 0 if all vanish, NaN if a number is not finite.
pub fn difference_over(a: &[f64], b: &[f64], floor: f64) -> f64 {
    let (mut largest, mut difference) = (floor, 0.0_f64);
    for (a, b) in a.iter().zip(b) {
        if !a.is_finite() || !b.is_finite() {
            return f64::NAN;
        }
        largest = largest.max(a.abs()).max(b.abs());
        difference = difference.max((a - b).abs());
    }
    if largest == 0.0 { 0.0 } else { difference / largest }
}
