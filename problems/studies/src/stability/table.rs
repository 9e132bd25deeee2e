//! Records as a page.

use crate::markdown::{or_dash, section};
use crate::stability::record::{CaseOutcome, Path, Record, StabilityReport};

/// One line per finished case.
pub fn progress(record: &Record) -> String {
    format!("{:9} {}: {} {}", outcome_name(record.outcome), record.group, record.name, record.remark)
}

fn outcome_name(outcome: CaseOutcome) -> &'static str {
    match outcome {
        CaseOutcome::Solved => "solved",
        CaseOutcome::Refused => "refused",
        CaseOutcome::Limit => "limit",
        CaseOutcome::Broken => "**broken**",
    }
}

/// All records as Markdown tables, one per group.
pub fn markdown(report: &StabilityReport) -> String {
    let counts = &report.counts;
    let mut text = format!(
        "{} cases: {} solved to their certificates, {} refused with reason, {} known limits, {} broken.\n",
        report.records.len(),
        counts.solved,
        counts.refused,
        counts.limits,
        counts.broken
    );
    let head = "case | outcome | steps: products (TFETI; direct) | largest residual | Δ forces | Δ subgradient | \
                contraction | condition | remark";
    let groups = report.records.chunk_by(|one, next| one.group == next.group);
    text.extend(groups.map(|group| section(group[0].group, head, group.iter().map(line))));
    text
}

fn line(record: &Record) -> Vec<String> {
    let number = |value| or_dash(value, |value: f64| format!("{value:.1e}"));
    let work: Vec<String> = record.paths.iter().take(2).map(work).collect();
    vec![
        escaped(&record.name),
        outcome_name(record.outcome).into(),
        if work.is_empty() { "–".into() } else { work.join("; ") },
        number(record.largest_residual()),
        number(record.force_difference),
        number(record.subgradient_difference),
        or_dash(record.contraction, |value| format!("{value:.3}")),
        number(record.condition),
        escaped(&record.remark),
    ]
}

/// Text for a cell of a Markdown table.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn work(path: &Path) -> String {
    if path.residuals.is_none() {
        return "–".into();
    }
    if path.products > 0 { format!("{}: {}", path.steps, path.products) } else { path.steps.to_string() }
}
