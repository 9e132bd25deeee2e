//! Quantities in a scene file: what objective, limits and reports name in the same words.

use crate::grid_file;
use crate::region::{RegionSection, check_body, region};
use contact::cost::{NodeWeight, PressureMeasure, Quantity, Region, WantedPressure};
use contact::error::SceneError;
use contact::scene::Scene;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Exponent of the paper's norm.
const DEFAULT_EXPONENT: f64 = 4.0;
/// Exponent of the stress norm.
const DEFAULT_STRESS_EXPONENT: f64 = 8.0;

/// A number that shape and contact states have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum QuantityName {
    /// ∫σ^p dA or Σσ^p, a power mean of the contact pressures.
    #[default]
    PressureNorm,
    /// max σ, MPa: the largest contact pressure.
    PeakPressure,
    /// ΣA(σ − w)²/ΣA, MPa²: the mean squared deviation from a wanted pressure.
    PressureDeviation,
    /// ΣA max(1 − σ/σ₀, 0), mm²: the area that lacks pressure.
    OpenArea,
    /// ΣA min(σ/σ₀, 1), mm²: the area that has pressure.
    LoadedArea,
    /// Σλ/ΣA, MPa: the normal force over the area of the contact face.
    MeanPressure,
    /// Σ A over closed nodes, mm². It jumps as nodes close: for reports only.
    ClosedArea,
    /// Force of a contact on its slave body, N.
    ContactForce,
    /// Moment of that force about a point, N mm.
    ContactMoment,
    /// Σ λ·s, N mm: the work of friction.
    FrictionWork,
    /// max |s|, mm: the largest slip.
    Slip,
    /// Force of the supports of a face on their body, N.
    Reaction,
    /// ((1/V₀) Σ V σ_vM^p)^{1/p}, MPa: a power mean of the von Mises stress.
    StressNorm,
    /// max σ_vM, MPa: the largest von Mises stress.
    Stress,
    /// max u, mm: the largest displacement.
    Displacement,
    /// f·u, N mm: the work of the loads.
    Compliance,
    /// V, mm³: the volume of the shaped bodies.
    Volume,
    /// V/V₀: that volume over the one at the start.
    RelativeVolume,
    /// Σ ρV, kg: the mass of all bodies whose materials have a density.
    Mass,
}

/// What a quantity needs beside its name.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Details {
    /// Exponent p of `pressure-norm` and `stress-norm`. Default 4 for pressures, 8 for stresses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 64.0), extend("x-unit" = "1", "exclusiveMinimum" = 1.0))]
    pub exponent: Option<f64>,
    /// For `pressure-norm`, what a contact node counts: its area, for the integral over the contact boundary, or 1, for
    /// the paper's sum. Default "area".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weight: Option<NodeWeight>,
    /// For `open-area` and `loaded-area`, and required there: the pressure from which a contact node counts with its
    /// whole area.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e15), extend("x-unit" = "MPa", "exclusiveMinimum" = 0.0))]
    pub pressure: Option<f64>,
    /// For `pressure-deviation`, and required there: the wanted pressure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wanted: Option<WantedSection>,
    /// For `stress` and `stress-norm`: the cells in this volume whose centres lie in this box at the start. For
    /// `displacement`: the nodes of these cells, or of the face. For `reaction`, and required there: the face of the
    /// supports. Default all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<RegionSection>,
    /// For `displacement`: a face whose mean displacement is subtracted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_to: Option<BaseSection>,
    /// For `displacement`, `contact-force`, `contact-moment` and `reaction`: the axis along which they are measured,
    /// with their sign. Default the length of the vector.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<AxisName>,
    /// For `stress`: leaves out the cells that have a node held by a support, where stresses concentrate. Default
    /// false.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_held: Option<bool>,
    /// For quantities of a contact: its place in the scene, from 0. Default all contacts; forces and moments are those
    /// of one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e6), extend("x-unit" = "1"))]
    pub contact: Option<usize>,
    /// For `contact-moment`: the point about which it is taken. Default the origin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub about: Option<[f64; 3]>,
}

/// An axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names are the meaning")]
pub enum AxisName {
    X1,
    X2,
    X3,
}

impl AxisName {
    /// Its number, from 0.
    fn number(self) -> usize {
        match self {
            Self::X1 => 0,
            Self::X2 => 1,
            Self::X3 => 2,
        }
    }
}

/// A face of a body.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BaseSection {
    /// The face.
    pub face: String,
    /// Name of the body. Default all bodies with a face of this name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
}

/// A wanted contact pressure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "form", rename_all = "kebab-case", deny_unknown_fields)]
pub enum WantedSection {
    /// A formula.
    Formula {
        /// The pressure in MPa over x1, x2, x3 in mm at the start, such as "120*exp(-(x1/20)^2) + 5": numbers, + - * /
        /// ^, parentheses, functions and PI, as docs/scenes.md lists them.
        pressure: String,
    },
    /// Pressures on a uniform grid over the base of blocks, bilinear in between.
    Grid {
        /// CSV file beside the scene file, as for heights; MPa.
        file: String,
    },
}

/// What the details of a quantity are looked up by.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lookup<'l> {
    /// Least corner and lengths of the base over which a file of numbers is given, where there is one.
    pub base: Option<[[f64; 2]; 2]>,
    /// Where files are.
    pub folder: &'l Path,
}

impl WantedSection {
    fn wanted(&self, field: &dyn Fn(&str) -> String, lookup: &Lookup<'_>) -> Result<WantedPressure, SceneError> {
        match self {
            Self::Formula { pressure } => WantedPressure::formula(&field("wanted.pressure"), pressure),
            Self::Grid { file } => {
                let [corner, size] = lookup.base.ok_or_else(|| {
                    let allowed = "\"formula\" for the body of a mesh, which has no base";
                    SceneError::out_of_range(field("wanted.form"), "grid", allowed)
                })?;
                Ok(WantedPressure::Grid(grid_file::read(&lookup.folder.join(file), size, "MPa")?.at(corner)))
            }
        }
    }
}

impl Details {
    /// The quantity of this name; `field`: what messages call a field; `least`: the smallest displacement is meant.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for details that are missing or belong to another quantity, and as those of formulas,
    /// grids and regions.
    pub(crate) fn quantity(
        &self,
        name: QuantityName,
        (field, least): (&dyn Fn(&str) -> String, bool),
        lookup: &Lookup<'_>,
    ) -> Result<Quantity, SceneError> {
        self.refuse_foreign(name, field)?;
        let missing = |name: &str, allowed: &str| SceneError::out_of_range(field(name), "missing", allowed);
        let region = || region(&field("region"), self.region.as_ref());
        let pressure = || self.pressure.ok_or_else(|| missing("pressure", "a finite number > 0 (MPa)"));
        let (contact, axis) = (self.contact, self.axis.map(AxisName::number));
        Ok(match name {
            QuantityName::PressureNorm => Quantity::Pressure(PressureMeasure::Norm {
                exponent: self.exponent.unwrap_or(DEFAULT_EXPONENT),
                weight: self.weight.unwrap_or_default(),
            }),
            QuantityName::PeakPressure => Quantity::Pressure(PressureMeasure::Peak),
            QuantityName::PressureDeviation => {
                let allowed = "a table with form = \"formula\" or form = \"grid\"";
                let wanted = self.wanted.as_ref().ok_or_else(|| missing("wanted", allowed))?;
                Quantity::Pressure(PressureMeasure::Deviation { wanted: wanted.wanted(field, lookup)? })
            }
            QuantityName::OpenArea => Quantity::Pressure(PressureMeasure::OpenArea { pressure: pressure()? }),
            QuantityName::LoadedArea => Quantity::LoadedArea { pressure: pressure()? },
            QuantityName::MeanPressure => Quantity::MeanPressure { contact },
            QuantityName::ClosedArea => Quantity::ClosedArea { contact },
            QuantityName::ContactForce => Quantity::ContactForce { contact, axis },
            QuantityName::ContactMoment => {
                Quantity::ContactMoment { contact, axis, about: self.about.unwrap_or_default() }
            }
            QuantityName::FrictionWork => Quantity::FrictionWork { contact },
            QuantityName::Slip => Quantity::Slip { contact },
            QuantityName::Reaction => Quantity::Reaction { region: region()?, axis },
            QuantityName::StressNorm => {
                Quantity::StressNorm { region: region()?, exponent: self.exponent.unwrap_or(DEFAULT_STRESS_EXPONENT) }
            }
            QuantityName::Stress => {
                Quantity::Stress { region: region()?, without_held: self.without_held.unwrap_or_default() }
            }
            QuantityName::Displacement => Quantity::Displacement {
                region: region()?,
                relative_to: self.relative_to.clone().map(BaseSection::region),
                axis,
                least: least && axis.is_some(),
            },
            QuantityName::Compliance => Quantity::Compliance,
            QuantityName::Volume => Quantity::Volume,
            QuantityName::RelativeVolume => Quantity::RelativeVolume,
            QuantityName::Mass => Quantity::Mass,
        })
    }

    /// Checks the bodies that it names.
    pub(crate) fn check_bodies(&self, field: &dyn Fn(&str) -> String, scene: &Scene) -> Result<(), SceneError> {
        let base = self.relative_to.as_ref().and_then(|base| base.body.as_ref());
        check_body(&field("region"), self.region.as_ref().and_then(|region| region.body.as_ref()), scene)?;
        check_body(&field("relative_to"), base, scene)
    }

    /// Refuses details that belong to other quantities.
    fn refuse_foreign(&self, quantity: QuantityName, field: &dyn Fn(&str) -> String) -> Result<(), SceneError> {
        use QuantityName::{
            ClosedArea, ContactForce, ContactMoment, Displacement, FrictionWork, LoadedArea, MeanPressure, OpenArea,
            PressureDeviation, PressureNorm, Reaction, Slip, Stress, StressNorm,
        };
        let number = |number: Option<f64>| number.map(|number| number.to_string());
        let table = |is_set: bool| is_set.then(|| "a table".to_owned());
        let of_contacts = [MeanPressure, ClosedArea, ContactForce, ContactMoment, FrictionWork, Slip];
        for (name, value, quantities) in [
            ("exponent", number(self.exponent), &[PressureNorm, StressNorm][..]),
            ("weight", self.weight.map(|weight| format!("{weight:?}").to_lowercase()), &[PressureNorm]),
            ("pressure", number(self.pressure), &[OpenArea, LoadedArea]),
            ("wanted", table(self.wanted.is_some()), &[PressureDeviation]),
            ("region", table(self.region.is_some()), &[Stress, StressNorm, Displacement, Reaction]),
            ("relative_to", table(self.relative_to.is_some()), &[Displacement]),
            (
                "axis",
                self.axis.map(|axis| format!("{axis:?}").to_lowercase()),
                &[Displacement, ContactForce, ContactMoment, Reaction],
            ),
            ("without_held", self.without_held.map(|held| held.to_string()), &[Stress]),
            ("contact", self.contact.map(|contact| contact.to_string()), &of_contacts),
            ("about", table(self.about.is_some()), &[ContactMoment]),
        ] {
            if let Some(value) = value.filter(|_| !quantities.contains(&quantity)) {
                let words: Vec<String> = quantities.iter().map(|quantity| quantity.text()).collect();
                let allowed = format!("none with this quantity, only with {}", words.join(", "));
                return Err(SceneError::out_of_range(field(name), value, allowed));
            }
        }
        Ok(())
    }
}

impl QuantityName {
    /// Its name in a file.
    fn text(self) -> String {
        toml::Value::try_from(self).ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
    }
}

impl BaseSection {
    fn region(self) -> Region {
        Region { body: self.body, face: Some(self.face), ..Region::WHOLE }
    }
}
