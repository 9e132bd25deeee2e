//! One prediction.
//!
//! ```text
//! T = n (t_factor + P t_product + t_derivative)                             own subdomains, n of them
//!   + coarse: factor of all coarse units, dense matrices of those at the contact boundary, solves            on every rank
//!   + P (2 exchanges with neighbours)  + P (gathers of contact rows, resultants and sums)
//! ```
//! A cube of bodies is torn into ranks that are cubes of n subdomains; for a given case the interfaces are counted on
//! its tearing. A coarse unit has six unknowns: a subdomain, or with clusters all subdomains of a rank. Every rank
//! waits for the slowest; an imbalance is not modelled.

use crate::scaling::model::machine::Machine;
use serde::Serialize;

/// What connects the ranks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Network {
    /// Seconds of a message without content.
    pub latency: f64,
    /// Bytes per second of one rank.
    pub bandwidth: f64,
}

/// Number and size of the parts into which the bodies are divided.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Workload {
    /// Number of MPI processes.
    pub ranks: f64,
    /// Number of subdomains per rank.
    pub subdomains: f64,
    /// Products with clusters over those without; none for plain total FETI.
    pub clusters: Option<f64>,
    /// Mean number of dofs of other ranks that a rank needs, if counted on the tearing; none for cubes among cubes.
    pub ghosts: Option<f64>,
}

/// Seconds, bytes and messages of one rank, for a state to 1e-8 and its subgradient.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Prediction {
    /// Division of the bodies that is predicted.
    pub run: Workload,
    /// Torn degrees of freedom of all ranks.
    pub dofs: f64,
    /// Work on own subdomains, s.
    pub own: f64,
    /// Factors of the coarse problem, s.
    pub coarse_factors: f64,
    /// Time for the solves with the coarse matrix, s.
    pub coarse_solves: f64,
    /// Exchanges with neighbours, s.
    pub neighbours: f64,
    /// Gathers among all ranks, s.
    pub gathers: f64,
    /// Bytes that a rank sends per product.
    pub bytes: f64,
    /// Messages to neighbours and gathers per product.
    pub messages: f64,
    /// Memory of a rank, bytes.
    pub memory: f64,
}

/// Unknowns of a coarse unit.
const AMPLITUDES: f64 = 6.0;
/// Bricks per edge of a subdomain.
pub const RATIO: f64 = 7.0;
/// Neighbours of a cube among cubes.
const NEIGHBOURS: f64 = 26.0;
/// Active sets of a state, each with a dense matrix of its own: the mean of cold and warm states at 35/5.
const ACTIVE_SETS: f64 = 10.0;
/// Coarse solves per product: for the rigid part of the residual, of the direction, and of its image.
const COARSE_SOLVES: f64 = 3.0;
/// Gathers of inner products per product.
const SUM_GATHERS: f64 = 4.0;
/// Inner products per product: directions of a state, each with its rigid part.
const SUMS: f64 = 60.0;
/// Dual vectors that a solve keeps.
const DUAL_VECTORS: f64 = 140.0;
/// Dense matrices of the contact units that are in memory at once.
const DENSE_MATRICES: f64 = 6.0;
/// Entries of the coarse matrix per subdomain: six columns of some fourteen neighbours.
const COARSE_COLUMNS: f64 = 525.0;
/// Bytes of the MPI library in every process: Open MPI 4.1, 37 MB resident where a run without it has 16 MB.
const LIBRARY_BYTES: f64 = 2.1e7;
/// Bytes of a number.
const NUMBER: f64 = 8.0;

/// Values of a coarse factor of so many units: blocks of six where a mesh of bricks has blocks of three (the law of
/// `contact::WorkEstimate`).
fn coarse_values(units: f64) -> f64 {
    4.0 * 268_000.0 * (3.0 * units / 1536.0).powf(1.48)
}

/// Dofs on the faces that a cube of subdomains has in common with others, in the mean over all cubes.
fn cube_ghosts(ranks: f64, subdomains: f64) -> f64 {
    let face = 3.0 * (RATIO * subdomains.cbrt() + 1.0).powi(2);
    6.0 * (1.0 - ranks.cbrt().recip()) * face
}

impl Prediction {
    /// The prediction for a run.
    pub fn new(machine: &Machine, network: &Network, run: Workload) -> Self {
        let Workload { ranks, subdomains, clusters, ghosts } = run;
        let all = ranks * subdomains;
        let factor = clusters.unwrap_or(1.0);
        let (products, adjoint) = (factor * machine.products, factor * machine.adjoint_products);
        let units = if clusters.is_some() { ranks } else { all };
        let contact = AMPLITUDES * units.powf(2.0 / 3.0);
        let own = machine.factor + products * machine.product + adjoint * machine.adjoint_product + machine.derivative;
        let bodies = all.cbrt() * RATIO;
        let contact_rows = 3.0 * (bodies + 1.0).powi(2);
        let exchanged = NUMBER * ghosts.unwrap_or_else(|| cube_ghosts(ranks, subdomains));
        let messages = NEIGHBOURS.min(ranks - 1.0);
        let exchange = messages * network.latency + exchanged / network.bandwidth;
        let branches = 2.0 * subdomains.log2().max(1.0);
        let gathered = [
            (2.0, NUMBER * contact_rows),
            (COARSE_SOLVES, NUMBER * AMPLITUDES * units),
            (SUM_GATHERS, NUMBER * ranks * branches * SUMS / SUM_GATHERS),
        ];
        let gather = |(count, bytes): &(f64, f64)| {
            if ranks > 1.0 { count * (ranks.log2() * network.latency + bytes / network.bandwidth) } else { 0.0 }
        };
        let sent: f64 = gathered.iter().map(|(count, bytes)| count * bytes / ranks).sum();
        let total = products + adjoint;
        // Per shape: columns of the coarse matrix, modes at the dofs of neighbours.
        let once = NUMBER * subdomains * COARSE_COLUMNS + AMPLITUDES * exchanged;
        let [coarse_factors, coarse_solves] = coarse_seconds(machine, units, contact, total);
        Self {
            run,
            dofs: all * machine.subdomain_dofs,
            own: subdomains * own,
            coarse_factors,
            coarse_solves,
            neighbours: total * 2.0 * exchange,
            gathers: total * gathered.iter().map(gather).sum::<f64>(),
            bytes: if ranks > 1.0 { 2.0 * exchanged + sent + once / total } else { 0.0 },
            messages: if ranks > 1.0 {
                2.0 * messages + gathered.iter().map(|(count, _)| count).sum::<f64>()
            } else {
                0.0
            },
            memory: machine.base_bytes
                + if ranks > 1.0 { LIBRARY_BYTES } else { 0.0 }
                + subdomains * machine.bytes
                + NUMBER * (1.3 * coarse_values(units) + DENSE_MATRICES * contact * contact)
                + NUMBER * DUAL_VECTORS * contact_rows * (1.0 - 1.0 / ranks),
        }
    }

    /// Seconds of state and subgradient: the sum of all parts.
    pub fn seconds(&self) -> f64 {
        self.own + self.coarse_factors + self.coarse_solves + self.neighbours + self.gathers
    }

    /// The part beside the own work that takes most of the time, as text.
    pub fn limit(&self) -> &'static str {
        let parts = [
            (self.coarse_factors, "coarse factors"),
            (self.coarse_solves, "coarse solves"),
            (self.neighbours, "neighbours"),
            (self.gathers, "gathers"),
        ];
        parts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or("", |(_, name)| name)
    }
}

/// Seconds of factors and of solves of so many coarse units, `contact` unknowns of them at the contact boundary.
fn coarse_seconds(machine: &Machine, units: f64, contact: f64, products: f64) -> [f64; 2] {
    let values = coarse_values(units);
    let factor = 2.0 * values * values / (AMPLITUDES * units) / machine.sparse_rate;
    let dense = ACTIVE_SETS * 2.0 / 3.0 * contact.powi(3) / machine.dense_rate;
    // Solves read their factor once; so does a product, whose factors hold one and a half times those of a subdomain.
    let read = 1.5 * 268_000.0 * (machine.subdomain_dofs / 1536.0).powf(1.48) / machine.product;
    [factor + dense, products * COARSE_SOLVES * (values + contact * contact) / read]
}

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: Machine = Machine {
        factor: 9e-3,
        product: 5e-4,
        adjoint_product: 5e-4,
        derivative: 4e-4,
        products: 28.0,
        adjoint_products: 22.0,
        sparse_rate: 1e10,
        dense_rate: 2e10,
        bytes: 5e6,
        base_bytes: 3e7,
        subdomain_dofs: 1536.0,
    };
    const NETWORK: Network = Network { latency: 2e-6, bandwidth: 1e10 };

    fn predicted(ranks: f64, subdomains: f64, clusters: Option<f64>) -> Prediction {
        Prediction::new(&MACHINE, &NETWORK, Workload { ranks, subdomains, clusters, ghosts: None })
    }

    #[test]
    fn a_single_rank_sends_nothing_and_work_is_shared() {
        let (one, two) = (predicted(1.0, 128.0, None), predicted(2.0, 64.0, None));
        assert_eq!((one.neighbours, one.gathers, one.bytes, one.messages), (0.0, 0.0, 0.0, 0.0));
        assert!((one.own - 2.0 * two.own).abs() < 1e-12 * one.own && one.coarse_factors == two.coarse_factors);
        assert!(two.memory < 0.6 * one.memory && two.bytes > 0.0);
    }

    #[test]
    fn the_coarse_problem_of_subdomains_limits_many_ranks_and_that_of_clusters_later() {
        let (plain, clusters) = (predicted(4096.0, 125.0, None), predicted(4096.0, 125.0, Some(1.0)));
        assert_eq!(plain.limit(), "coarse factors");
        assert!(plain.seconds() > 10.0 * plain.own && clusters.seconds() < 0.1 * plain.seconds());
        assert!(plain.memory > clusters.memory);
    }
}
