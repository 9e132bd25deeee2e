//! Limits of a scene file: bounds on what a shape leads to.

use crate::quantity::{Details, Lookup, QuantityName};
use contact::cost::{Limit, LimitSide};
use contact::error::SceneError;
use contact::names::find;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Bounds that the shape found has to keep; at least one of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LimitSection {
    /// What is limited.
    pub quantity: QuantityName,
    /// Its largest value, in its unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e18, max = 1e18), extend("x-unit" = "of the quantity"))]
    pub at_most: Option<f64>,
    /// Its least value, in its unit; with the same number as at_most, a volume or a mass is kept. For displacements
    /// along an axis: a bound of the smallest one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e18, max = 1e18), extend("x-unit" = "of the quantity"))]
    pub at_least: Option<f64>,
    /// The name of the case in which it holds. Default all cases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    /// What the quantity needs.
    #[serde(flatten)]
    pub details: Details,
}

impl LimitSection {
    /// What of it two limits must not have in common.
    fn key(&self) -> Self {
        Self { at_most: None, at_least: None, ..self.clone() }
    }
}

/// The limits of a file, for cases with these names.
///
/// # Errors
/// [`SceneError::OutOfRange`] for two limits of a quantity, for one without bounds, for those that contradict each
/// other, for a case that does not exist, and as [`Details::quantity`].
pub(crate) fn limits(sections: &[LimitSection], cases: &[&str], lookup: &Lookup<'_>) -> Result<Vec<Limit>, SceneError> {
    let mut limits = Vec::new();
    for (index, section) in sections.iter().enumerate() {
        let field = |name: &str| format!("limit[{index}].{name}");
        let quantity = |least: bool| section.details.quantity(section.quantity, (&field, least), lookup);
        let stated = quantity(false)?;
        stated.check_differentiable(&field("quantity"))?;
        if sections[..index].iter().any(|other| other.key() == section.key()) {
            return Err(SceneError::out_of_range(
                field("quantity"),
                stated.name(),
                "one limit of a quantity in a case",
            ));
        }
        if let Some(case) = &section.case {
            find(&field("case"), case, cases.iter().copied())?;
            let allowed = "none with a quantity of the shape, which all cases share";
            SceneError::require(!stated.is_of_shape(), field("case"), format!("\"{case}\""), allowed)?;
        }
        let limit = |side, bound| {
            let quantity = quantity(side == LimitSide::AtLeast)?;
            Ok::<_, SceneError>(Limit { case: section.case.clone(), ..Limit::new(quantity, side, bound) })
        };
        match (section.at_least, section.at_most) {
            (None, None) => return Err(SceneError::out_of_range(field("at_most"), "missing", "at_most or at_least")),
            (Some(least), Some(most)) if least == most => {
                let allowed =
                    "less than at_most: a function of the contact state has kinks, and cannot be kept at a value";
                SceneError::require(stated.is_of_shape(), field("at_least"), least, allowed)?;
                limits.push(limit(LimitSide::Equal, most)?);
            }
            (Some(least), Some(most)) if least > most => {
                return Err(SceneError::out_of_range(field("at_least"), least, format!("at most at_most = {most}")));
            }
            (least, most) => {
                limits.extend(least.map(|bound| limit(LimitSide::AtLeast, bound)).transpose()?);
                limits.extend(most.map(|bound| limit(LimitSide::AtMost, bound)).transpose()?);
            }
        }
        for (name, bound) in [("at_least", section.at_least), ("at_most", section.at_most)] {
            if let Some(bound) = bound.filter(|bound| !(stated.is_signed() || *bound > 0.0)) {
                return Err(SceneError::out_of_range(field(name), bound, "a finite number > 0"));
            }
        }
    }
    Ok(limits)
}
