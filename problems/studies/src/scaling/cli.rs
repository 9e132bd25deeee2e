//! The command line of the study.

use crate::scaling::cases::{Case, Extent, SceneName, Variant};
use crate::scaling::report::ScalingReport;
use crate::scaling::{measure, table};
use clap::Parser;
use problems::commands::{Failure, arguments, finish, json, notice};
use std::process::ExitCode;

/// Work, time and memory of the contact solvers over growing meshes.
#[derive(Debug, Clone, Parser)]
#[command(name = "scaling", version)]
pub struct ScalingArguments {
    /// s = 2 and 3 only.
    #[arg(long, conflicts_with_all = ["full", "case"])]
    pub quick: bool,
    /// s up to 7; direct condensation up to 35 bricks per edge.
    #[arg(long, conflicts_with = "case")]
    pub full: bool,
    /// Print one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
    /// Which scene.
    #[arg(long, value_enum, default_value_t = SceneName::Signorini)]
    pub scene: SceneName,
    /// One case only: N bricks and S subdomains per edge of each body.
    #[arg(long, value_name = "N/S", value_parser = Case::parse)]
    pub case: Option<Case>,
    /// One solver only.
    #[arg(long, value_enum)]
    pub variant: Option<Variant>,
    /// Clusters of about C³ subdomains, which share six rigid motions; several, with commas, are measured in turn.
    #[arg(long, value_name = "C", value_delimiter = ',', default_value = "1")]
    pub clusters: Vec<usize>,
}

impl ScalingArguments {
    fn extent(&self) -> Extent {
        match (self.quick, self.full) {
            (true, _) => Extent::Quick,
            (_, true) => Extent::Full,
            _ => Extent::Usual,
        }
    }

    /// Clusters that a solver is measured with.
    fn clusters_of(&self, variant: Variant) -> impl Iterator<Item = usize> {
        let torn = variant.preconditioner().is_some();
        self.clusters.iter().copied().filter(move |&clusters| torn || clusters == 1)
    }

    /// What is measured, in order.
    fn plan(&self) -> Vec<(Case, Variant)> {
        if let (Some(case), Some(variant)) = (self.case, self.variant) {
            return vec![(case, variant)];
        }
        let extent = self.extent();
        let cases = self.case.map_or_else(|| extent.cases(), |case| vec![case]);
        let all =
            cases.into_iter().flat_map(|case| case.variants(extent).into_iter().map(move |variant| (case, variant)));
        all.filter(|(_, variant)| self.variant.is_none_or(|only| only == *variant)).collect()
    }
}

/// Runs the binary with the arguments of the process and returns its exit status.
pub fn run() -> ExitCode {
    finish(execute(&arguments()), None)
}

/// Measures what the arguments ask for; cases that fail are listed in the report.
fn execute(arguments: &ScalingArguments) -> Result<String, Failure> {
    let (mut rows, mut failures) = (Vec::new(), Vec::new());
    let plan = arguments.plan().into_iter();
    let plan: Vec<(Case, Variant, usize)> =
        plan.flat_map(|(case, variant)| arguments.clusters_of(variant).map(move |c| (case, variant, c))).collect();
    if plan.is_empty() {
        return Err(Failure::Input("--clusters is allowed with solvers on total FETI only".into()));
    }
    for (case, variant, clusters) in plan {
        match measure::row(arguments.scene, case, variant, clusters) {
            Ok(row) => {
                notice(&table::progress(&row));
                rows.push(row);
            }
            Err(Failure::Input(reason)) => return Err(Failure::Input(reason)),
            Err(failure) => failures.push(format!("{case} {}: {failure}", super::option_name(&variant))),
        }
    }
    let report = ScalingReport::new(rows, failures);
    let text = if arguments.json { json(&report)? } else { table::markdown(&report) };
    if report.failures.is_empty() {
        return Ok(text);
    }
    Err(Failure::Incomplete { text, reason: report.failures.join("; "), status: 1 })
}
