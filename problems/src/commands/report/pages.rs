//! The HTML report of each command, without the sections on its scene and its files.

use crate::commands::compare::comparison::Comparison;
use crate::commands::optimize::mesh_run::MeshRun;
use crate::commands::optimize::stages::Part;
use crate::commands::optimize::summary::reduction;
use crate::commands::output::pressure;
use crate::commands::report::folder::Parts;
use crate::commands::report::sections::{certificate, course, found_label, pictures, states};
use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use contact::equilibrium::StageSeconds;
use figures::page::{Block, Page, Section};

/// The report of an optimization.
pub fn optimization(parts: Parts, runs: &[MeshRun], last: &MeshRun, shapes: &[SolvedShape; 2]) -> Page {
    let MeshRun { objective, report, .. } = last;
    let confirmed = if report.termination.is_confirmed() {
        "The optimum is confirmed by its certificate."
    } else {
        "It is the best shape found; the run ended without a proof of optimality."
    };
    let times = reduction(shapes[0].value, report.value);
    let times = times.map_or_else(String::new, |ratio| format!(", {ratio:.3} times less"));
    let lead = format!(
        "From the start to the shape found, Θ goes from {:.4e} to {:.4e}{times}; the peak pressure from {} to {} MPa, after {}. {confirmed}",
        shapes[0].value,
        report.value,
        pressure(shapes[0].peak_pressure),
        pressure(shapes[1].peak_pressure),
        evaluations(runs)
    );
    let sections = vec![
        parts.numbers,
        pictures(parts.pictures),
        states(objective, &[("start", &shapes[0]), (found_label(report), &shapes[1])]),
        stages(runs),
        course(report, &last.active_constraints()),
        certificate(report.certificate.as_ref()),
        controls(objective, shapes[1].controls.as_slice()),
        seconds(&shapes[1]),
    ];
    page(objective, "optimized shape", lead, sections)
}

/// The report of an evaluation.
pub fn evaluation(parts: Parts, objective: &ContactObjective, shape: &SolvedShape) -> Page {
    let counts = shape.state.forces.counts();
    let lead = format!(
        "Θ = {:.10e}, peak pressure {} MPa; {} contact nodes open, {} stick, {} slip.",
        shape.value,
        pressure(shape.peak_pressure),
        counts.open,
        counts.stick,
        counts.slip
    );
    let sections = vec![
        parts.numbers,
        pictures(parts.pictures),
        states(objective, &[("value", shape)]),
        controls(objective, shape.controls.as_slice()),
        seconds(shape),
    ];
    page(objective, "one shape", lead, sections)
}

/// The report of a comparison with and without friction.
pub fn comparison(parts: Parts, comparison: &Comparison<'_>) -> Page {
    let objective = &comparison.runs[0].objective;
    let sentences = comparison.conclusion();
    let confirmed = comparison.runs.iter().all(|run| run.report.termination.is_confirmed());
    let caveat = if confirmed { "" } else { " Not both runs ended with a proof of optimality." };
    let lead = sentences.first().cloned().unwrap_or_default() + caveat;
    let friction = objective.solver().problem().scene.friction;
    let head = [
        "shape".to_owned(),
        format!("Θ, friction {friction}"),
        "peak, MPa".into(),
        "Θ, no friction".into(),
        "peak, MPa".into(),
    ];
    let rows = comparison.rows().map(|row| {
        vec![
            row.shape.to_owned(),
            format!("{:.6e}", row.objective_with_friction),
            format!("{:.1}", row.peak_pressure_with_friction),
            format!("{:.6e}", row.objective_without_friction),
            format!("{:.1}", row.peak_pressure_without_friction),
        ]
    });
    let table = Section::new("Shapes in both models", vec![Block::table(head, rows), Block::List(sentences)]);
    let both =
        [("optimized with friction", &comparison.own[0][1]), ("optimized without friction", &comparison.crossed[0])];
    let mut with_friction = states(objective, &both);
    with_friction.title = format!("Both shapes with friction {friction}");
    let sections = vec![table, parts.numbers, pictures(parts.pictures), with_friction];
    page(objective, "with and without friction", lead, sections)
}

fn page(objective: &ContactObjective, what: &str, lead: String, sections: Vec<Section>) -> Page {
    let scene = &objective.solver().problem().scene;
    let [n1, n2, n3] = scene.mesh;
    let bodies = if scene.upper.is_some() { 2 } else { 1 };
    let title = format!("{}: {what} ({bodies} × {n1}×{n2}×{n3} bricks, friction {})", scene.name, scene.friction);
    Page { title, lead, sections, ..Page::default() }
}

/// "20 evaluations", on growing meshes or from several starts "150 + 37 evaluations in several runs".
fn evaluations(runs: &[MeshRun]) -> String {
    let counts: Vec<String> = runs.iter().map(|run| run.report.counts.evaluations.to_string()).collect();
    let growing = if counts.len() > 1 { " in several runs" } else { "" };
    format!("{} evaluations{growing}", counts.join(" + "))
}

/// The meshes of a coarse-to-fine optimization, or the starts; empty for a single run.
fn stages(runs: &[MeshRun]) -> Section {
    if runs.iter().all(|run| run.part == Part::Whole) {
        return Section::default();
    }
    let rows = runs.iter().map(|run| {
        let [n1, n2, n3] = run.objective.solver().problem().scene.mesh;
        vec![
            format!("{n1}×{n2}×{n3}"),
            format!("{:.4e}", run.report.start_value),
            format!("{:.4e}", run.report.value),
            run.report.counts.evaluations.to_string(),
            format!("{:.1}", run.report.seconds),
            run.report.termination.to_string(),
        ]
    });
    let head = ["bricks", "Θ at its start", "Θ at its end", "evaluations", "seconds", "ended"];
    let words = "Pictures, course and certificate are those of the last mesh, or of the best start; the start is that of the first run.";
    let rows: Vec<Vec<String>> = rows.collect();
    Section::new("Runs", vec![Block::table(head, rows), Block::Text(words.into())])
}

/// Control heights, one row per control point along x₁.
fn controls(objective: &ContactObjective, heights: &[f64]) -> Section {
    let [_, along] = objective.solver().problem().scene.control_points;
    let head = std::iter::once("mm".to_owned()).chain((1..=along).map(|j| format!("x₂: {j}")));
    let rows = heights.chunks(along).enumerate().map(|(i, line)| {
        std::iter::once(format!("x₁: {}", i + 1)).chain(line.iter().map(|height| format!("{height:.4}"))).collect()
    });
    Section::new("Control heights", vec![Block::table(head, rows.collect::<Vec<Vec<String>>>())])
}

/// Seconds of the parts of one state; empty for a solver that does not keep them.
fn seconds(shape: &SolvedShape) -> Section {
    let Some(stages) = shape.state.stages else { return Section::default() };
    let StageSeconds { equilibrium, factorization, coarse_space, newton, recovery } = stages;
    let stages = [
        ("equilibrium", equilibrium),
        ("factorization", factorization),
        ("coarse space", coarse_space),
        ("contact", newton),
        ("recovery", recovery),
    ];
    let total: f64 = stages.iter().map(|(_, seconds)| seconds).sum();
    let row = |(name, seconds): (&str, f64)| {
        vec![name.to_owned(), format!("{seconds:.4}"), format!("{:.0} %", 100.0 * seconds / total)]
    };
    let rows: Vec<Vec<String>> = stages.into_iter().map(row).collect();
    let words = "Wall-clock seconds of the last state, solved from nothing.";
    Section::new(
        "Time of one state",
        vec![Block::table(["stage", "seconds", "share"], rows), Block::Text(words.into())],
    )
}
