//! Measures of the contact pressures, and what is told of them.

use serde::Serialize;

/// What a contact node counts in a pressure norm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "NodeWeightName", transform = crate::schema::names_only))]
pub enum NodeWeight {
    /// Its area A_i: the sum is ∫σ^p dA, MPa^p mm², which meshes of one scene agree on.
    #[default]
    Area,
    /// 1, as in the paper: the sum Σσ^p, MPa^p, grows with the number of nodes; nodes on edges count like those inside.
    Nodes,
}

/// A function of the contact pressures.
#[derive(Debug, Clone, PartialEq)]
pub enum PressureMeasure {
    /// Σ m_i σ_i^p with the weights m_i of the nodes.
    Norm {
        /// The exponent p > 1.
        exponent: f64,
        /// What a node counts.
        weight: NodeWeight,
    },
    /// max σ, MPa; nonsmooth on its own, with one subgradient at the first node of largest pressure.
    Peak,
    /// Σ A (σ − w)² / Σ A, MPa²: the mean squared deviation from a wanted pressure.
    Deviation {
        /// w per contact node, MPa, in the order of
        /// [`ContactBoundary::points`](crate::equilibrium::ContactBoundary::points).
        wanted: Vec<f64>,
    },
    /// Σ A max(1 − σ/σ₀, 0), mm²: the area that lacks contact pressure. A node counts with its whole area where it is
    /// open, with none of it from σ = σ₀ on. The least open area is the largest smoothed contact area Σ A min(σ/σ₀, 1).
    OpenArea {
        /// σ₀ > 0, MPa.
        pressure: f64,
    },
}

/// Contact areas of a state, mm².
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ContactAreas {
    /// The area of the closed nodes: Σ A over nodes that stick or slip.
    pub closed: f64,
    /// The smoothed contact area Σ A min(σ/σ₀, 1).
    pub smoothed: f64,
    /// The area of all contact nodes.
    pub whole: f64,
}

/// A sum of powers of pressures as a pressure.
#[derive(Debug, Clone, PartialEq)]
pub struct PressureRoot {
    /// What it is, such as `(Σσ^4)^(1/4)`.
    pub name: String,
    /// The root in MPa.
    pub value: f64,
}
