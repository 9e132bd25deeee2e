//! `evaluate`: objective, subgradient and certificates at one shape.

use crate::commands::arguments::Arguments;
use crate::commands::contact_objective::{ContactObjective, SolvedShape, checks};
use crate::commands::controls;
use crate::commands::failure::Failure;
use crate::commands::folder::json;
use crate::commands::loaded_scene::LoadedScene;
use crate::commands::long_run::RunFolder;
use crate::commands::report::files;
use contact::contact_shape::SolverKind;
use contact::equilibrium::{Diagnosis, Kink, Residuals, StatusCounts};
use contact::plausibility::Warning;
use serde::Serialize;
use std::fmt;
use std::time::Instant;

/// The keys of the JSON of `evaluate`.
#[derive(Debug, Serialize)]
struct EvaluationJson {
    objective: f64,
    subgradient: Vec<f64>,
    peak_pressure: f64,
    total_normal_force: f64,
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
}

#[derive(Debug, Serialize)]
struct Seconds {
    state: f64,
    subgradient: f64,
}

/// The command.
pub fn run(objective: &ContactObjective, loaded: &LoadedScene, arguments: &Arguments) -> Result<String, Failure> {
    let folder = RunFolder::folder_for_results(loaded.case.output.folder.as_deref())?;
    let solver = objective.solver();
    let controls = controls::load(solver, &loaded.case, arguments.controls.as_deref())?;
    let clock = Instant::now();
    let shape = SolvedShape::at(objective, &controls)?;
    let state_seconds = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let evaluation = objective.differentiate(&controls, &shape.state)?;
    let subgradient_seconds = clock.elapsed().as_secs_f64();
    let (state, forces) = (&shape.state, &shape.state.forces);
    let result = EvaluationJson {
        objective: evaluation.value,
        subgradient: evaluation.subgradient.as_slice().to_vec(),
        peak_pressure: shape.peak_pressure,
        total_normal_force: forces.total_normal_force(),
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
    };
    let object = json(&result)?;
    let write = |folder| files::write_evaluation(&folder, loaded, objective, &shape, &object, &result.warnings);
    let written = folder.map_or(Ok(()), write);
    Failure::printed_with_files(arguments.printed(result.to_string(), object), written)
}

/// A solver and why it was taken.
pub fn said(solver: SolverKind, reason: Option<&str>) -> String {
    let name = match solver {
        SolverKind::Direct => "direct condensation",
        SolverKind::AugmentedLagrangian => "total FETI, successive approximations",
        _ => "total FETI, semismooth Newton",
    };
    reason.map_or_else(|| name.into(), |reason| format!("{name}; {reason}"))
}

impl fmt::Display for EvaluationJson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let norm = self.subgradient.iter().map(|x| x * x).sum::<f64>().sqrt();
        writeln!(f, "objective            {:.10e}", self.objective)?;
        writeln!(f, "|subgradient|        {norm:.6e} ({} controls)", self.subgradient.len())?;
        writeln!(f, "peak pressure        {:.6} MPa", self.peak_pressure)?;
        writeln!(f, "total normal force   {:.10e} N", self.total_normal_force)?;
        let status = &self.status;
        writeln!(f, "contact nodes        {} open, {} stick, {} slip", status.open, status.stick, status.slip)?;
        writeln!(
            f,
            "nearest kink         relative margin {:.1e}, {} nodes weakly active",
            self.kink.smallest_margin, self.kink.weakly_active
        )?;
        let r = &self.residuals;
        writeln!(f, "relative residuals   {r}")?;
        writeln!(f, "solver               {}", said(self.solver, self.solver_reason.as_deref()))?;
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
        writeln!(f, "left out             {}", self.left_out.join("; "))
    }
}
