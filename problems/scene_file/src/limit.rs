//! Limits of a scene file: bounds on what a shape leads to.

use crate::Objective;
use contact::cost::{Limit, LimitSide, LimitedQuantity};
use contact::error::SceneError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Bounds that the shape found has to keep; at least one of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LimitSection {
    /// What is limited: the largest contact pressure (MPa, with objectives of the contact pressures), the volume of the
    /// lower body (mm³), or the volume over that at the start.
    pub quantity: QuantityName,
    /// Its largest value, in its unit. Default none.
    #[serde(default)]
    #[schemars(range(max = 1e15), extend("x-unit" = "of the quantity", "exclusiveMinimum" = 0.0))]
    pub at_most: Option<f64>,
    /// Its least value, in its unit; with the same number as at_most, the quantity is kept. Default none.
    #[serde(default)]
    #[schemars(range(max = 1e15), extend("x-unit" = "of the quantity", "exclusiveMinimum" = 0.0))]
    pub at_least: Option<f64>,
}

/// What a limit bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum QuantityName {
    /// max σ.
    PeakPressure,
    /// V/V₀.
    RelativeVolume,
    /// V.
    Volume,
}

impl From<QuantityName> for LimitedQuantity {
    fn from(name: QuantityName) -> Self {
        match name {
            QuantityName::PeakPressure => Self::PeakPressure,
            QuantityName::RelativeVolume => Self::RelativeVolume,
            QuantityName::Volume => Self::Volume,
        }
    }
}

/// The limits of a file, for a scene that a lattice shapes if `lattice`.
///
/// # Errors
/// [`SceneError::OutOfRange`] for two limits of a quantity, for one without bounds, for those that contradict each
/// other and for those that objective and shape do not take.
pub(crate) fn limits(
    sections: &[LimitSection],
    objective: &Objective,
    lattice: bool,
) -> Result<Vec<Limit>, SceneError> {
    let mut limits = Vec::new();
    for (index, section) in sections.iter().enumerate() {
        let quantity = LimitedQuantity::from(section.quantity);
        let field = |name: &str| format!("limit[{index}].{name}");
        let refuse = |allowed: &str| Err(SceneError::out_of_range(field("quantity"), quantity.name(), allowed));
        if sections[..index].iter().any(|other| other.quantity == section.quantity) {
            return refuse("one limit of a quantity");
        }
        if quantity == LimitedQuantity::PeakPressure && !objective.is_of_pressures() {
            return refuse("no limit with this objective.measure, only with objectives of the contact pressures");
        }
        if quantity.is_of_shape() && !lattice {
            return refuse("admissible.volume for the heights of a block: it is linear in them");
        }
        if let (LimitedQuantity::PeakPressure, Some(least)) = (quantity, section.at_least) {
            return Err(SceneError::out_of_range(field("at_least"), least, "none for the peak pressure"));
        }
        let limit = |side, bound| Limit { quantity, side, bound };
        match (section.at_least, section.at_most) {
            (None, None) => return Err(SceneError::out_of_range(field("at_most"), "missing", "at_most or at_least")),
            (Some(least), Some(most)) if least == most => limits.push(limit(LimitSide::Equal, most)),
            (Some(least), Some(most)) if least > most => {
                return Err(SceneError::out_of_range(field("at_least"), least, format!("at most at_most = {most}")));
            }
            (least, most) => {
                limits.extend(least.map(|bound| limit(LimitSide::AtLeast, bound)));
                limits.extend(most.map(|bound| limit(LimitSide::AtMost, bound)));
            }
        }
    }
    Ok(limits)
}
