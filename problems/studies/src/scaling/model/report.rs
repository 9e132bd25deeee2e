//! The table of predictions.

use crate::markdown::section;
use crate::scaling::cases::{Case, SceneName};
use crate::scaling::model::interface::mean_ghosts;
use crate::scaling::model::prediction::RATIO;
use crate::scaling::model::{Machine, Network, Prediction, Workload};
use contact::equilibrium::ContactProblem;
use problems::commands::Failure;
use serde::Serialize;
use std::sync::Arc;

/// Options of the prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Network that the prediction assumes.
    pub network: Network,
    pub per_rank: usize,
    /// Products of state and adjoint together; none for those of the measurement.
    pub products: Option<f64>,
    /// Products with clusters over those without.
    pub cluster_products: f64,
    /// A case on one, two and four ranks in place of growing bodies.
    pub case: Option<Case>,
}

/// All predictions, and what they rest on.
#[derive(Debug, Clone, Serialize)]
pub struct ModelReport {
    /// Figures of one core of this machine.
    pub machine: Machine,
    /// Network that the prediction assumes.
    pub network: Network,
    /// One entry per number of ranks, without and with clusters.
    pub predictions: Vec<Prediction>,
}

/// Ranks of growing bodies.
const RANKS: [usize; 8] = [1, 8, 64, 128, 512, 1000, 4096, 10_000];
const CASE_RANKS: [usize; 3] = [1, 2, 4];

/// Measures this machine and predicts.
///
/// # Errors
/// [`Failure`] for another scene or another number of bricks per subdomain than it knows, and if a state of the
/// measurement cannot be found.
pub fn report(scene: SceneName, options: &Options) -> Result<ModelReport, Failure> {
    if scene != SceneName::Signorini {
        return Err(Failure::Input("the model knows one body only: --scene signorini".into()));
    }
    if let Some(case) = options.case.filter(|case| case.ratio() as f64 != RATIO) {
        let ratio = case.ratio();
        return Err(Failure::Input(format!(
            "{case} has {ratio} bricks per edge of a subdomain; the model knows {RATIO} only"
        )));
    }
    let (measured, network) = (Machine::measure(scene)?, options.network);
    let factor = options.products.map_or(1.0, |products| products / (measured.products + measured.adjoint_products));
    let (products, adjoint_products) = (factor * measured.products, factor * measured.adjoint_products);
    let machine = Machine { products, adjoint_products, ..measured };
    let runs: Vec<Workload> = match options.case {
        Some(case) => {
            let pieces = (case.subdomains as f64).powi(3);
            let problem = Arc::new(ContactProblem::new(scene.scene(case)?)?);
            let run = |&ranks: &usize| {
                let ghosts = Some(mean_ghosts(&problem, ranks)?);
                Ok(Workload { ranks: ranks as f64, subdomains: pieces / ranks as f64, clusters: None, ghosts })
            };
            CASE_RANKS.iter().map(run).collect::<Result<_, Failure>>()?
        }
        None => {
            let subdomains = options.per_rank as f64;
            let of = |clusters| {
                RANKS.iter().map(move |&ranks| Workload { ranks: ranks as f64, subdomains, clusters, ghosts: None })
            };
            of(None).chain(of(Some(options.cluster_products))).collect()
        }
    };
    let predictions = runs.into_iter().map(|run| Prediction::new(&machine, &network, run)).collect();
    Ok(ModelReport { machine, network, predictions })
}

impl ModelReport {
    /// The report as Markdown.
    pub fn markdown(&self) -> String {
        let Machine { factor, product, adjoint_product, sparse_rate, dense_rate, bytes, .. } = self.machine;
        let machine = format!(
            "One core: {:.2} ms to factor a subdomain, {:.2} and {:.2} ms per product in state and adjoint, {:.1} and {:.1} Gflop/s \
             sparse and dense, {:.2} MB per subdomain. Network: {:.1} µs, {:.1} GB/s.\n",
            1e3 * factor,
            1e3 * product,
            1e3 * adjoint_product,
            1e-9 * sparse_rate,
            1e-9 * dense_rate,
            1e-6 * bytes,
            1e6 * self.network.latency,
            1e-9 * self.network.bandwidth,
        );
        let rows = self.predictions.iter().map(|prediction| {
            let Workload { ranks, subdomains, clusters, .. } = prediction.run;
            let seconds = prediction.seconds();
            vec![
                if clusters.is_some() { "clusters" } else { "plain" }.into(),
                format!("{ranks}"),
                format!("{subdomains:.1}"),
                format!("{:.2e}", prediction.dofs),
                format!("{seconds:.2}"),
                format!("{:.2}", prediction.own),
                format!("{:.2}", prediction.coarse_factors),
                format!("{:.2}", prediction.coarse_solves),
                format!("{:.3}", prediction.neighbours),
                format!("{:.3}", prediction.gathers),
                format!("{:.0} %", 100.0 * self.efficiency(prediction)),
                if ranks > 1.0 { prediction.limit() } else { "–" }.into(),
                format!("{:.2}", 1e-9 * prediction.memory),
                format!("{:.0}", 1e-3 * prediction.bytes),
                format!("{:.0}", prediction.messages),
            ]
        });
        let head = "method | ranks | subdomains per rank | dofs | s | own | coarse factors | coarse solves | neighbours | gathers | efficiency | limit | GB \
                    per rank | kB per product | messages";
        machine + &section("Predictions (state to 1e-8 and subgradient, one thread per rank)", head, rows)
    }

    /// Seconds per own subdomain of a single rank, the first prediction, over those of a run.
    fn efficiency(&self, prediction: &Prediction) -> f64 {
        let per_subdomain = |prediction: &Prediction| prediction.seconds() / prediction.run.subdomains;
        self.predictions.first().map_or(f64::NAN, |first| per_subdomain(first) / per_subdomain(prediction))
    }
}
