//! Sections that the report pages of several commands share.

use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use figures::page::{Block, Section};
use nonsmooth::{Certificate, Report};

/// The pictures of a page.
pub fn pictures(blocks: Vec<Block>) -> Section {
    Section::new("Pictures", blocks)
}

/// What the shape that an optimization ended at is called.
pub fn found_label(report: &Report) -> &'static str {
    if report.termination.is_confirmed() { "optimum" } else { "best found" }
}

/// Rows that objectives without a least value do not have.
const LEAST: &str = "least value for this total force";
const OVER_LEAST: &str = "Θ over that";

/// Contact states side by side: the bound of the objective, and residuals that say how far the numbers can be trusted.
pub fn states(objective: &ContactObjective, shapes: &[(&str, &SolvedShape)]) -> Section {
    let row = |name: &str, cell: &dyn Fn(&SolvedShape) -> String| -> Vec<String> {
        std::iter::once(name.to_owned()).chain(shapes.iter().map(|(_, shape)| cell(shape))).collect()
    };
    let force = |shape: &SolvedShape| shape.state.forces.total_normal_force();
    let bound = |shape: &SolvedShape| objective.lower_bound(force(shape));
    let unknown = || "–".to_owned();
    let mut rows = vec![
        row("objective Θ", &|shape| format!("{:.10e}", shape.value)),
        row(LEAST, &|shape| bound(shape).map_or_else(unknown, |bound| format!("{bound:.4e}"))),
        row(OVER_LEAST, &|shape| {
            let above_zero = bound(shape).filter(|bound| *bound > 0.0);
            above_zero.map_or_else(unknown, |bound| format!("{:.3}", shape.value / bound))
        }),
        row("total normal force, N", &|shape| format!("{:.8e}", force(shape))),
        row("nodes open / stick / slip", &|shape| {
            let counts = shape.state.forces.counts();
            format!("{} / {} / {}", counts.open, counts.stick, counts.slip)
        }),
        row("relative residual: equilibrium", &|shape| format!("{:.1e}", shape.state.forces.residuals.equilibrium)),
        row("complementarity", &|shape| format!("{:.1e}", shape.state.forces.residuals.complementarity)),
        row("friction cone", &|shape| format!("{:.1e}", shape.state.forces.residuals.friction_cone)),
        row("dissipation", &|shape| format!("{:.1e}", shape.state.forces.residuals.dissipation)),
        row("Newton", &|shape| format!("{:.1e}", shape.state.forces.residuals.newton)),
        row("relative distance to the nearest kink", &|shape| {
            format!("{:.1e}", shape.state.forces.kink.smallest_margin)
        }),
        row("weakly active nodes", &|shape| shape.state.forces.kink.weakly_active.to_string()),
    ];
    let head = std::iter::once("").chain(shapes.iter().map(|(label, _)| *label));
    let mut words = "Residuals are relative to the load.".to_owned();
    if shapes.iter().any(|(_, shape)| bound(shape).is_some()) {
        words +=
            " No shape that carries the same total force over the same contact nodes can be below the least value.";
    } else {
        rows.retain(|row| row[0] != LEAST && row[0] != OVER_LEAST);
    }
    Section::new("States", vec![Block::table(head, rows), Block::Text(words)])
}

/// The course of the optimization.
pub fn course(report: &Report, active: &str) -> Section {
    let counts = &report.counts;
    let first = report.history.first().map_or(0.0, |record| record.seconds);
    let slowest = report.history.windows(2).map(|pair| pair[1].seconds - pair[0].seconds).fold(first, f64::max);
    let rows = vec![
        vec!["evaluations".to_owned(), counts.evaluations.to_string()],
        vec![
            "serious / null / refined / failed".into(),
            format!("{} / {} / {} / {}", counts.serious, counts.null, counts.refined, counts.failed),
        ],
        vec!["restarts".into(), counts.restarts.to_string()],
        vec!["subproblems (by the fallback solver)".into(), format!("{} ({})", counts.qp_solves, counts.qp_fallbacks)],
        vec!["seconds".into(), format!("{:.2}", report.seconds)],
        vec![
            "seconds per evaluation: mean / longest".into(),
            format!("{:.3} / {slowest:.3}", report.seconds / counts.evaluations.max(1) as f64),
        ],
        vec!["largest relative violation of the constraints".into(), format!("{:.1e}", report.largest_violation)],
        vec!["constraints attained at the end".into(), active.to_owned()],
    ];
    let end = format!("The run ended: {}. {}.", report.termination, sentence(report.termination.advice()));
    Section::new("Course of the optimization", vec![Block::Text(end), Block::table(["quantity", "value"], rows)])
}

/// The certificate of stationarity.
pub fn certificate(certificate: Option<&Certificate>) -> Section {
    let Some(certificate) = certificate else {
        return Section::new("Certificate", vec![Block::Text("No subproblem was solved, so there is none.".into())]);
    };
    let rows = vec![
        vec!["norm of the aggregate subgradient".to_owned(), format!("{:.3e}", certificate.aggregate_norm)],
        vec!["aggregate error".into(), format!("{:.3e}", certificate.aggregate_error)],
        vec!["predicted decrease".into(), format!("{:.3e}", certificate.predicted_decrease)],
        vec![
            "predicted decrease over Θ".into(),
            format!("{:.1e}", certificate.predicted_decrease / certificate.value.abs()),
        ],
        vec![
            "active cuts".into(),
            format!("{} within {:.2e}", certificate.active_cuts().count(), certificate.active_radius),
        ],
        vec!["curvature added".into(), format!("{:.3e}", certificate.convexification)],
        vec!["noise".into(), format!("{:.1e}", certificate.noise)],
    ];
    let words = "At a stationary point the aggregate subgradient and the aggregate error vanish; the predicted decrease is what \
                 the model still hopes for. certificate.json holds all cuts and multipliers, from which \
                 the command recheck computes norm and error again.";
    Section::new("Certificate", vec![Block::table(["quantity", "value"], rows), Block::Text(words.into())])
}

/// The command, the scene and what it did not need.
pub fn origin(scene: &str, left_out: &[&str]) -> Section {
    let words: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    let mut blocks = vec![Block::Listing { title: "The command".into(), text: words.join(" ") }];
    if !left_out.is_empty() {
        blocks.push(Block::Text(format!("Left out, because this scene does not need it: {}.", left_out.join("; "))));
    }
    blocks
        .push(Block::Listing { title: "The scene, complete, with all options put in".into(), text: scene.to_owned() });
    Section::new("Scene", blocks)
}

/// A text that begins with a capital letter.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
