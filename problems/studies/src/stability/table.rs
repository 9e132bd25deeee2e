//! Records as a page.

use crate::stability::record::{Outcome, Path, Record, Report};
use std::fmt::Write;

/// One line per finished case.
pub fn progress(record: &Record) -> String {
    format!("{:9} {}: {} {}", word(record.outcome), record.group, record.name, record.remark)
}

fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Solved => "solved",
        Outcome::Refused => "refused",
        Outcome::Limit => "limit",
        Outcome::Broken => "**broken**",
    }
}

/// All records as Markdown tables, one per group.
pub fn markdown(report: &Report) -> String {
    let counts = &report.counts;
    let mut text = format!(
        "{} cases: {} solved to their certificates, {} refused with reason, {} known limits, {} broken.\n",
        report.records.len(),
        counts.solved,
        counts.refused,
        counts.limits,
        counts.broken
    );
    let mut group = "";
    for record in &report.records {
        if record.group != group {
            group = record.group;
            // Writing to a string cannot fail.
            let _ = write!(
                text,
                "\n### {group}\n\n| case | outcome | steps: products (TFETI; direct) | largest residual | Δ forces | \
                 Δ subgradient | contraction | condition | remark |\n|{}\n",
                "---|".repeat(9)
            );
        }
        text += &line(record);
    }
    text
}

fn line(record: &Record) -> String {
    let number = |value: Option<f64>| value.map_or_else(|| "–".into(), |value| format!("{value:.1e}"));
    let work: Vec<String> = record.paths.iter().take(2).map(work).collect();
    let cells = [
        escaped(&record.name),
        word(record.outcome).into(),
        if work.is_empty() { evaluations(record) } else { work.join("; ") },
        number(record.largest_residual()),
        number(record.force_difference),
        number(record.subgradient_difference),
        record.contraction.map_or_else(|| "–".into(), |value| format!("{value:.3}")),
        number(record.condition),
        escaped(&record.remark),
    ];
    format!("| {} |\n", cells.join(" | "))
}

/// Text for a cell of a Markdown table.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn evaluations(record: &Record) -> String {
    record.evaluations.map_or_else(|| "–".into(), |count| format!("{count} evaluations"))
}

fn work(path: &Path) -> String {
    if path.residuals.is_none() {
        return "–".into();
    }
    if path.products > 0 { format!("{}: {}", path.steps, path.products) } else { path.steps.to_string() }
}
