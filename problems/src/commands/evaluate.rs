//! `evaluate`: objective, subgradient and certificates at one shape.

use crate::commands::folder::{Folder, json, peak_pressure};
use crate::commands::report::files;
use crate::commands::solved_shape::SolvedShape;
use crate::commands::{Arguments, ContactObjective, Failure, Source, controls};
use contact::equilibrium::{Diagnosis, Kink, Residuals, StatusCounts};
use nonsmooth::{Accuracy, StateSolver};
use scene_file::Case;
use serde::Serialize;
use std::fmt;
use std::time::Instant;

/// What `evaluate` reports; the keys of its JSON.
#[derive(Debug, Serialize)]
struct Evaluated {
    objective: f64,
    subgradient: Vec<f64>,
    peak_pressure: f64,
    total_normal_force: f64,
    status: StatusCounts,
    kink: Kink,
    residuals: Residuals,
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

pub fn run(
    objective: &ContactObjective,
    source: &Source,
    case: &Case,
    arguments: &Arguments,
) -> Result<String, Failure> {
    let folder = Folder::for_results(case.output.folder.as_deref())?;
    let shape = objective.solver();
    let control = controls::load(shape, case, arguments.controls.as_deref())?;
    let clock = Instant::now();
    let state = shape.solve(&control, None, Accuracy::TIGHTEST)?;
    let state_seconds = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let evaluation = objective.differentiate(&control, &state)?;
    let subgradient_seconds = clock.elapsed().as_secs_f64();
    let diagnosis = if arguments.diagnose { Some(shape.diagnose(&state)?) } else { None };
    let result = Evaluated {
        objective: evaluation.value,
        subgradient: evaluation.subgradient.as_slice().to_vec(),
        peak_pressure: peak_pressure(objective, &state),
        total_normal_force: state.forces.total_normal_force(),
        status: state.forces.counts(),
        kink: state.forces.kink,
        residuals: state.forces.residuals,
        work: state.work(),
        contraction: state.contraction,
        diagnosis,
        seconds: Seconds { state: state_seconds, subgradient: subgradient_seconds },
        left_out: shape.left_out(),
    };
    let json = json(&result)?;
    if let Some(folder) = folder {
        let solved =
            SolvedShape { controls: control, value: result.objective, peak_pressure: result.peak_pressure, state };
        let printed = if arguments.json { json.clone() } else { result.to_string() };
        files::write_evaluation(&folder, source, case, objective, &solved, &json)
            .map_err(|failure| failure.after(&printed))?;
    }
    Ok(if arguments.json { json } else { result.to_string() })
}

impl fmt::Display for Evaluated {
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
        writeln!(f, "left out             {}", self.left_out.join("; "))
    }
}
