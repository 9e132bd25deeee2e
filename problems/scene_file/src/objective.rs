//! The objective of a scene file.

use crate::quantity::{Details, QuantityName};
use contact::load_cases::Over;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The objective.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct ObjectiveSection {
    /// What is minimised. Default "pressure-norm".
    #[serde(default)]
    pub quantity: QuantityName,
    /// With several cases: the largest of their values, each times the weight of its case, or the sum. Default "worst".
    #[serde(default)]
    pub over: Over,
    /// What the quantity needs.
    #[serde(flatten)]
    pub details: Details,
}
