//! Limits of a scene file: bounds on what a shape leads to.

use crate::Objective;
use contact::error::SceneError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A bound that the shape found has to keep.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LimitSection {
    /// What is limited: the largest contact pressure, which needs an objective of the contact pressures.
    pub quantity: LimitedQuantity,
    /// Its largest value.
    #[schemars(range(max = 1e15), extend("x-unit" = "MPa", "exclusiveMinimum" = 0.0))]
    pub at_most: f64,
}

/// What a limit bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LimitedQuantity {
    /// max σ.
    PeakPressure,
}

/// The limit of the largest contact pressure, MPa, if there is one.
///
/// # Errors
/// [`SceneError::OutOfRange`] for a second limit, and for objectives that take none.
pub(crate) fn peak_limit(limits: &[LimitSection], objective: &Objective) -> Result<Option<f64>, SceneError> {
    let name = |LimitSection { quantity: LimitedQuantity::PeakPressure, .. }: &LimitSection| "peak-pressure";
    let refuse = |index: usize, allowed: &str| {
        Err(SceneError::out_of_range(format!("limit[{index}].quantity"), name(&limits[index]), allowed))
    };
    match limits {
        [] => Ok(None),
        [_, _, ..] => refuse(1, "one limit of a quantity"),
        [_] if !objective.is_of_pressures() => {
            refuse(0, "no limit with this objective.measure, only with objectives of the contact pressures")
        }
        [limit] => Ok(Some(limit.at_most)),
    }
}
