//! Measures of the contact pressures, and what is told of them.

use crate::cost::wanted_pressure::WantedPressure;

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
        /// w, MPa.
        wanted: WantedPressure,
    },
    /// Σ A max(1 − σ/σ₀, 0), mm²: the area that lacks contact pressure. A node counts with its whole area where it is
    /// open, with none of it from σ = σ₀ on. The least open area is the largest smoothed contact area Σ A min(σ/σ₀, 1).
    OpenArea {
        /// σ₀ > 0, MPa.
        pressure: f64,
    },
}

impl PressureMeasure {
    /// Its name in scene files and reports.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Norm { .. } => "pressure-norm",
            Self::Peak => "peak-pressure",
            Self::Deviation { .. } => "pressure-deviation",
            Self::OpenArea { .. } => "open-area",
        }
    }

    /// The unit of its values, such as `MPa^{4}·mm^{2}`.
    pub(super) fn unit(&self) -> String {
        match self {
            Self::Norm { exponent, weight: NodeWeight::Area } => format!("MPa^{{{exponent}}}·mm^{{2}}"),
            Self::Norm { exponent, weight: NodeWeight::Nodes } => format!("MPa^{{{exponent}}}"),
            Self::Peak => "MPa".into(),
            Self::Deviation { .. } => "MPa^{2}".into(),
            Self::OpenArea { .. } => "mm^{2}".into(),
        }
    }
}

/// A sum of powers of pressures as a pressure.
#[derive(Debug, Clone, PartialEq)]
pub struct PressureRoot {
    /// What it is, such as `(Σσ^4)^(1/4)`.
    pub name: String,
    /// The root in MPa.
    pub value: f64,
}
