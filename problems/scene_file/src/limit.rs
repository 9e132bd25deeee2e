//! Limits of a scene file: bounds on what a shape leads to.

use crate::objective::AxisName;
use crate::region::{RegionSection, region};
use contact::cost::{FieldMeasure, Limit, LimitSide, LimitedQuantity};
use contact::error::SceneError;
use contact::names::find;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Exponent of the stress norm.
const DEFAULT_EXPONENT: f64 = 8.0;

/// Bounds that the shape found has to keep; at least one of them. A limit of the contact state holds in every case, or
/// in one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LimitSection {
    /// What is limited: the largest contact pressure (MPa); the loaded area ∫min(σ/σ₀, 1)dA (mm²); the largest von
    /// Mises stress or its p-norm in a region (MPa); the largest displacement of a region (mm); the compliance (N mm);
    /// the volume of the shaped bodies (mm³), or that volume over the one at the start.
    pub quantity: QuantityName,
    /// Its largest value, in its unit. Default none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e18, max = 1e18), extend("x-unit" = "of the quantity"))]
    pub at_most: Option<f64>,
    /// Its least value, in its unit; with the same number as at_most, a volume is kept. For displacements along a
    /// component: a bound of the smallest one. Default none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1e18, max = 1e18), extend("x-unit" = "of the quantity"))]
    pub at_least: Option<f64>,
    /// The name of the case in which it holds. Default all cases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    /// For `loaded-area`, and required there: the pressure σ₀ from which a contact node counts with its whole area.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e15), extend("x-unit" = "MPa", "exclusiveMinimum" = 0.0))]
    pub pressure: Option<f64>,
    /// For `stress-norm`: the exponent. Default 8.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 64.0), extend("x-unit" = "1", "exclusiveMinimum" = 1.0))]
    pub exponent: Option<f64>,
    /// For `stress`, `stress-norm` and `displacement`: the part of the bodies, as objective.region. Default all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<RegionSection>,
    /// For `displacement`: the component, with its sign. Default the length of the displacement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub component: Option<AxisName>,
    /// For `stress`: leaves out the cells that have a node held by a support, where stresses concentrate. Default
    /// false.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_held: Option<bool>,
}

/// What a limit bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum QuantityName {
    /// max σ.
    PeakPressure,
    /// Σ A min(σ/σ₀, 1).
    LoadedArea,
    /// max σ_vM.
    Stress,
    /// ((1/V₀) Σ V σ_vM^p)^{1/p}.
    StressNorm,
    /// max u_i, min u_i or max |u|.
    Displacement,
    /// f·u.
    Compliance,
    /// V/V₀.
    RelativeVolume,
    /// V.
    Volume,
}

impl LimitSection {
    /// The limited quantity; on its lower side if `least`.
    fn quantity(&self, field: &dyn Fn(&str) -> String, least: bool) -> Result<LimitedQuantity, SceneError> {
        let region = || region(&field("region"), self.region.as_ref());
        Ok(match self.quantity {
            QuantityName::PeakPressure => LimitedQuantity::PeakPressure,
            QuantityName::LoadedArea => match self.pressure {
                None => {
                    return Err(SceneError::out_of_range(field("pressure"), "missing", "a finite number > 0 (MPa)"));
                }
                Some(pressure) => LimitedQuantity::LoadedArea { pressure },
            },
            QuantityName::Stress => LimitedQuantity::Field(FieldMeasure::PeakStress {
                region: region()?,
                without_held: self.without_held.unwrap_or_default(),
            }),
            QuantityName::StressNorm => LimitedQuantity::Field(FieldMeasure::StressNorm {
                region: region()?,
                exponent: self.exponent.unwrap_or(DEFAULT_EXPONENT),
            }),
            QuantityName::Displacement => LimitedQuantity::Field(FieldMeasure::Displacement {
                region: region()?,
                component: self.component.map(AxisName::axis),
                least: least && self.component.is_some(),
            }),
            QuantityName::Compliance => LimitedQuantity::Field(FieldMeasure::Compliance),
            QuantityName::RelativeVolume => LimitedQuantity::RelativeVolume,
            QuantityName::Volume => LimitedQuantity::Volume,
        })
    }

    /// Refuses fields that belong to another quantity.
    fn refuse_foreign_fields(&self, field: &dyn Fn(&str) -> String) -> Result<(), SceneError> {
        use QuantityName::{Displacement, LoadedArea, RelativeVolume, Stress, StressNorm, Volume};
        let number = |number: Option<f64>| number.map(|number| number.to_string());
        let table = self.region.as_ref().map(|_| "a table".to_owned());
        let component = self.component.map(|component| format!("{component:?}"));
        let held = self.without_held.map(|held| held.to_string());
        for (name, value, quantities, words) in [
            ("pressure", number(self.pressure), &[LoadedArea][..], "loaded-area"),
            ("exponent", number(self.exponent), &[StressNorm], "stress-norm"),
            ("region", table, &[Stress, StressNorm, Displacement], "stress, stress-norm and displacement"),
            ("component", component, &[Displacement], "displacement"),
            ("without_held", held, &[Stress], "stress"),
        ] {
            if let Some(value) = value.filter(|_| !quantities.contains(&self.quantity)) {
                let allowed = format!("none with this quantity, only with {words}");
                return Err(SceneError::out_of_range(field(name), value, allowed));
            }
        }
        if let (Some(case), Volume | RelativeVolume) = (&self.case, self.quantity) {
            let allowed = "none with a volume, which all cases share";
            return Err(SceneError::out_of_range(field("case"), format!("\"{case}\""), allowed));
        }
        Ok(())
    }

    /// What of it two limits must not have in common.
    fn key(&self) -> Self {
        Self { at_most: None, at_least: None, ..self.clone() }
    }
}

/// The limits of a file, for cases with these names.
///
/// # Errors
/// [`SceneError::OutOfRange`] for two limits of a quantity, for one without bounds, for those that contradict each
/// other, for a case that does not exist and for fields that belong to another quantity.
pub(crate) fn limits(sections: &[LimitSection], cases: &[&str]) -> Result<Vec<Limit>, SceneError> {
    let mut limits = Vec::new();
    for (index, section) in sections.iter().enumerate() {
        let field = |name: &str| format!("limit[{index}].{name}");
        section.refuse_foreign_fields(&field)?;
        if sections[..index].iter().any(|other| other.key() == section.key()) {
            let name = section.quantity(&field, false)?.name();
            return Err(SceneError::out_of_range(field("quantity"), name, "one limit of a quantity in a case"));
        }
        if let Some(case) = &section.case {
            find(&field("case"), case, cases.iter().copied())?;
        }
        let limit = |side, bound| {
            let quantity = section.quantity(&field, side == LimitSide::AtLeast)?;
            Ok::<_, SceneError>(Limit { case: section.case.clone(), ..Limit::new(quantity, side, bound) })
        };
        match (section.at_least, section.at_most) {
            (None, None) => return Err(SceneError::out_of_range(field("at_most"), "missing", "at_most or at_least")),
            (Some(least), Some(most)) if least == most => {
                let limit = limit(LimitSide::Equal, most)?;
                if !limit.quantity.is_of_shape() {
                    let allowed =
                        "less than at_most: a function of the contact state has kinks, and cannot be kept at a value";
                    return Err(SceneError::out_of_range(field("at_least"), least, allowed));
                }
                limits.push(limit);
            }
            (Some(least), Some(most)) if least > most => {
                return Err(SceneError::out_of_range(field("at_least"), least, format!("at most at_most = {most}")));
            }
            (least, most) => {
                limits.extend(least.map(|bound| limit(LimitSide::AtLeast, bound)).transpose()?);
                limits.extend(most.map(|bound| limit(LimitSide::AtMost, bound)).transpose()?);
            }
        }
        let positive = |bound: &f64| *bound > 0.0;
        let signed = matches!(section.quantity, QuantityName::Displacement | QuantityName::Compliance);
        let bounds = [("at_least", section.at_least), ("at_most", section.at_most)];
        for (name, bound) in bounds.iter().filter_map(|(name, bound)| Some((name, (*bound)?))) {
            if !(signed || positive(&bound)) {
                return Err(SceneError::out_of_range(field(name), bound, "a finite number > 0"));
            }
        }
    }
    Ok(limits)
}
