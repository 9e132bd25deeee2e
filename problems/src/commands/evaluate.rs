//! `evaluate`: objective, subgradient and certificates at one shape.

use crate::commands::contact_objective::{self, SolvedShape, checks, solver_in_words};
use crate::commands::controls;
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, json, printed_with_files};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::processes::Usage;
use crate::commands::report::files;
use contact::contact_shape::SolverKind;
use contact::cost::ContactAreas;
use contact::equilibrium::{Diagnosis, Kink, Residuals, StatusCounts};
use contact::plausibility::Warning;
use serde::Serialize;
use std::fmt;
use std::time::Instant;

/// The keys of the JSON of `evaluate`.
#[derive(Debug, Serialize)]
struct EvaluationJson {
    objective: f64,
    /// The unit of the objective, or of its root.
    objective_unit: String,
    /// log₁₀ of the objective, of the pressure norm where its root is given.
    log10_objective: Option<f64>,
    /// p where objective and subgradient are those of the p-th root of a pressure norm, since those of the norm are no doubles; else 1.
    objective_root: f64,
    subgradient: Vec<f64>,
    peak_pressure: f64,
    total_normal_force: f64,
    /// Contact areas, where the open area is the objective.
    #[serde(skip_serializing_if = "Option::is_none")]
    contact_areas: Option<ContactAreas>,
    status: StatusCounts,
    kink: Kink,
    residuals: Residuals,
    solver: SolverKind,
    /// Why that solver, where another would have been the first choice.
    solver_reason: Option<String>,
    warnings: Vec<Warning>,
    work: contact::equilibrium::Work,
    /// Contraction factor seen by the successive approximations; null for the other solvers.
    contraction: Option<f64>,
    /// Contraction and condition at the state, with --diagnose.
    diagnosis: Option<Diagnosis>,
    seconds: Seconds,
    left_out: Vec<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    processes: Option<Usage>,
}

#[derive(Debug, Serialize)]
struct Seconds {
    state: f64,
    subgradient: f64,
}

/// The command.
pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let (objective, arguments) = (&contact_objective::objective(&loaded.case, &session.processes)?, session.arguments);
    let solver = objective.solver();
    let controls = controls::load(solver.problem(), &loaded.case, ("--controls", arguments.controls.as_deref()))?;
    let controls = controls::as_made(controls, arguments);
    let folder = Folder::of_command(&loaded.case, arguments)?;
    let clock = Instant::now();
    let abandon = |_: &Failure| folder.iter().for_each(Folder::abandon);
    let shape = SolvedShape::at(objective, &controls).inspect_err(abandon)?;
    let state_seconds = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let evaluation = objective.differentiate(&controls, &shape.state).map_err(Failure::from).inspect_err(abandon)?;
    let subgradient_seconds = clock.elapsed().as_secs_f64();
    let (state, forces) = (&shape.state, &shape.state.forces);
    let root = objective.root();
    // The norm of a root r is s r^p, with the derivative s p r^{p−1} ∂r.
    let (size, norm_unit) = objective.norm_of_root().unwrap_or_else(|| (1.0, objective.unit()));
    let (power, slope) = (size * evaluation.value.powf(root), size * root * evaluation.value.powf(root - 1.0));
    let representable = power.is_normal() && (slope * evaluation.subgradient.amax()).is_finite();
    let (value, slope, objective_root, objective_unit) = match representable {
        true => (power, slope, 1.0, norm_unit),
        false => (evaluation.value, 1.0, root, objective.unit()),
    };
    let result = EvaluationJson {
        objective: value,
        objective_unit: objective_unit.replace(['{', '}'], ""),
        log10_objective: (evaluation.value > 0.0).then(|| size.log10() + root * evaluation.value.log10()),
        objective_root,
        subgradient: (&evaluation.subgradient * slope).as_slice().to_vec(),
        peak_pressure: shape.peak_pressure,
        total_normal_force: forces.total_normal_force(),
        contact_areas: objective.contact_areas(state),
        status: forces.counts(),
        kink: forces.kink,
        residuals: forces.residuals,
        solver: state.solver,
        solver_reason: state.reason.clone(),
        warnings: checks(objective, &shape, arguments)?,
        work: state.work(),
        contraction: state.contraction,
        diagnosis: arguments.diagnose.then(|| solver.diagnose(state)).transpose()?,
        seconds: Seconds { state: state_seconds, subgradient: subgradient_seconds },
        left_out: arguments.left_out(solver),
        processes: session.processes.usage(state.solver)?,
    };
    let object = json(&result)?;
    let write = |folder: &Folder| files::write_evaluation(folder, loaded, objective, &shape, &object, &result.warnings);
    let printed = arguments.printed(result.to_string(), object.clone());
    printed_with_files(printed, arguments.json, folder.as_ref(), write)
}

impl fmt::Display for EvaluationJson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Squares of entries above 1e154 are no doubles.
        let largest = self.subgradient.iter().fold(f64::MIN_POSITIVE, |largest, x| largest.max(x.abs()));
        let norm = largest * self.subgradient.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt();
        let power = match self.objective_root {
            1.0 => String::new(),
            root => {
                let exponent = self.log10_objective.map_or_else(|| "–".into(), |exponent| format!("{exponent:.10}"));
                format!(", the root of degree {root} of a pressure norm of 10^{exponent}")
            }
        };
        writeln!(f, "objective            {:.10e} {}{power}", self.objective, self.objective_unit)?;
        writeln!(f, "|subgradient|        {norm:.6e} ({} controls)", self.subgradient.len())?;
        writeln!(f, "peak pressure        {:.6} MPa", self.peak_pressure)?;
        writeln!(f, "total normal force   {:.10e} N", self.total_normal_force)?;
        if let Some(areas) = &self.contact_areas {
            writeln!(f, "contact area         {areas}")?;
        }
        let status = &self.status;
        writeln!(f, "contact nodes        {} open, {} stick, {} slip", status.open, status.stick, status.slip)?;
        writeln!(
            f,
            "nearest kink         relative margin {:.1e}, {} nodes weakly active",
            self.kink.smallest_margin, self.kink.weakly_active
        )?;
        let r = &self.residuals;
        writeln!(f, "relative residuals   {r}")?;
        writeln!(f, "solver               {}", solver_in_words(self.solver, self.solver_reason.as_deref()))?;
        let work = &self.work;
        writeln!(
            f,
            "work                 {} Newton steps, {} products with the dual operator ({} for the adjoint), {} factorisations",
            work.newton_steps, work.dual_operator_applications, work.adjoint_applications, work.factorizations
        )?;
        writeln!(
            f,
            "seconds              state {:.3}, subgradient {:.3}",
            self.seconds.state, self.seconds.subgradient
        )?;
        if work.fixed_point_steps > 0 {
            let contraction = self.contraction.map_or_else(|| "unknown".to_owned(), |factor| format!("{factor:.3}"));
            writeln!(
                f,
                "dual QPs             {} Tresca problems, {} cg, {} expansion, {} proportioning steps, contraction {contraction}",
                work.fixed_point_steps, work.cg_steps, work.expansion_steps, work.proportioning_steps
            )?;
        }
        if let Some(diagnosis) = &self.diagnosis {
            writeln!(f, "diagnosis            {diagnosis}")?;
        }
        for warning in &self.warnings {
            writeln!(f, "warning              {warning}")?;
        }
        writeln!(f, "left out             {}", self.left_out.join("; "))?;
        self.processes.iter().try_for_each(|usage| writeln!(f, "processes            {usage}"))
    }
}
