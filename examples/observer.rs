//! Watching a run: a table while it runs, an observer of one's own, and stopping rules that combine.
//!
//! Θ(x) = maxᵢ |xᵢ − i| over ten variables: minimum 0 at xᵢ = i.

use nonsmooth::{
    BundleTrust, BundleTrustConfig, FnObjective, IterationRecord, Report, StepKind, StopRule, TablePrinter, Vector,
};
use std::io::Write;
use std::ops::ControlFlow;

fn largest_distance(x: &Vector) -> (f64, Vector) {
    let distances = x.iter().enumerate().map(|(i, x)| (i, x - i as f64));
    let (index, distance) =
        distances.fold((0, 0.0_f64), |worst, one| if one.1.abs() >= worst.1.abs() { one } else { worst });
    let mut subgradient = Vector::zeros(x.len());
    subgradient[index] = distance.signum();
    (distance.abs(), subgradient)
}

/// Minimises with a table on a writer; returns the report and the number of serious steps that the observer counted.
pub fn minimize(table: impl Write) -> Result<(Report, usize), Box<dyn std::error::Error>> {
    let mut serious = 0;
    let report = BundleTrust::new(BundleTrustConfig::default())?
        .observer(TablePrinter::new(table))
        .observer(|record: &IterationRecord| {
            serious += usize::from(record.kind == StepKind::Serious);
            ControlFlow::Continue(())
        })
        .stop_when(StopRule::ValueBelow(1e-3))
        .stop_when(StopRule::Evaluations(40) & StopRule::Stalled { evaluations: 10, relative: 1e-2 })
        .minimize(&FnObjective::new(10, largest_distance), Vector::from_element(10, 20.0))?;
    Ok((report, serious))
}

#[allow(dead_code, reason = "a test includes this file and calls `minimize`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (report, serious) = minimize(std::io::stdout())?;
    println!("{serious} serious steps\n{report}");
    Ok(())
}
