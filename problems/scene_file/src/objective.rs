//! The objective of a scene file: its fields, and what they mean once a mesh is known.

use crate::grid_file;
use crate::region::{RegionSection, region};
use crate::wanted_pressure::WantedPressure;
use contact::cost::{FieldMeasure, Measure, NodeWeight, PressureMeasure};
use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use contact::load_cases::Over;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Exponent of the paper's norm.
const DEFAULT_EXPONENT: f64 = 4.0;
/// Exponent of the stress norm.
const DEFAULT_STRESS_EXPONENT: f64 = 8.0;

/// The objective.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ObjectiveSection {
    /// Of the contact pressures: integral or sum of powers, largest value, mean squared deviation from a wanted
    /// pressure, area that lacks pressure. Of the displacements: p-norm of the von Mises stress in a region, its
    /// largest value, largest displacement, compliance. Of the shape: the volume of the shaped bodies.
    pub measure: MeasureName,
    /// With several cases: the largest of their measures, each times the weight of its case, or the sum.
    pub over: Over,
    /// Exponent p of the pressure norm and of the stress norm. Default 4 for the pressure norm, 8 for the stress norm.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 64.0), extend("x-unit" = "1", "exclusiveMinimum" = 1.0))]
    pub exponent: Option<f64>,
    /// For `pressure-norm`, what a contact node counts: its area, so that the objective is the integral of the power
    /// over the contact boundary, or 1 each, which gives the paper's sum. Default "area".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weight: Option<NodeWeight>,
    /// For `open-area`: the pressure from which a contact node counts with its whole area. Default none: required
    /// there.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e15), extend("x-unit" = "MPa", "exclusiveMinimum" = 0.0))]
    pub pressure: Option<f64>,
    /// For `pressure-deviation`, and required there: the wanted pressure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wanted: Option<WantedSection>,
    /// For `stress-norm` and `stress`: the cells whose centres lie in this box at the start, faces included, and which
    /// belong to the volume; all cells without it. For `displacement`: the nodes of these cells, or of the face.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub region: Option<RegionSection>,
    /// For `displacement`: the component whose largest value counts, with its sign. Default the length of the
    /// displacement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub component: Option<AxisName>,
    /// For `stress`: leaves out the cells that have a node held by a support, where stresses concentrate. Default
    /// false.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without_held: Option<bool>,
}

/// A component of displacements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names are the meaning")]
pub enum AxisName {
    U1,
    U2,
    U3,
}

impl AxisName {
    /// Its axis, from 0.
    pub(crate) fn axis(self) -> usize {
        match self {
            Self::U1 => 0,
            Self::U2 => 1,
            Self::U3 => 2,
        }
    }
}

/// Which function is minimised.
// The tags of `PressureMeasure` and `FieldMeasure`, whose numbers are fields of their own in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MeasureName {
    /// ∫σ^p dA or Σσ^p.
    #[default]
    PressureNorm,
    /// max σ.
    PeakPressure,
    /// ΣA(σ − w)²/ΣA.
    PressureDeviation,
    /// ΣA max(1 − σ/σ₀, 0).
    OpenArea,
    /// ((1/V₀) Σ V σ_vM^p)^{1/p}.
    StressNorm,
    /// max σ_vM.
    Stress,
    /// max u_i or max |u|.
    Displacement,
    /// f·u.
    Compliance,
    /// V.
    Volume,
}

/// A wanted contact pressure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "form", rename_all = "kebab-case", deny_unknown_fields)]
pub enum WantedSection {
    /// A formula.
    Formula {
        /// The pressure in MPa over x1, x2, x3 in mm at the start, such as "120*exp(-(x1/20)^2) + 5": numbers, + - * /
        /// ^, parentheses, functions and PI, as docs/scenes.md lists them. A sign binds less than a power: -x1^2 is
        /// -(x1^2); powers count from the right: 2^3^2 is 2^9.
        pressure: String,
    },
    /// Pressures on a uniform grid over the base of blocks, bilinear in between.
    Grid {
        /// CSV file beside the scene file: one line per x1, one column per x2, both edges included; MPa. Lines that
        /// begin with # are comments.
        file: String,
    },
}

/// What is minimised, checked as far as no mesh is needed.
#[derive(Debug, Clone, PartialEq)]
pub enum Objective {
    /// A function of the contact pressures.
    Pressure(PressureMeasure),
    /// The deviation from a wanted pressure, which each mesh samples at its contact nodes.
    Deviation(WantedPressure),
    /// A function of the displacements.
    Field(FieldMeasure),
    /// The volume of the shaped bodies.
    Volume,
}

impl Objective {
    /// The objective of a section; a grid that it names is looked up in `folder`.
    pub(crate) fn new(
        section: &ObjectiveSection,
        base: Option<[[f64; 2]; 2]>,
        folder: &Path,
    ) -> Result<Self, SceneError> {
        refuse_foreign_fields(section)?;
        let exponent = |default: f64| section.exponent.unwrap_or(default);
        Ok(match section.measure {
            MeasureName::PressureNorm => Self::Pressure(PressureMeasure::Norm {
                exponent: exponent(DEFAULT_EXPONENT),
                weight: section.weight.unwrap_or_default(),
            }),
            MeasureName::PeakPressure => Self::Pressure(PressureMeasure::Peak),
            MeasureName::PressureDeviation => Self::Deviation(match &section.wanted {
                None => return Err(missing("objective.wanted", "a table with form = \"formula\" or form = \"grid\"")),
                Some(WantedSection::Formula { pressure }) => WantedPressure::formula(pressure)?,
                Some(WantedSection::Grid { file }) => {
                    let [corner, size] = base.ok_or_else(|| {
                        let allowed = "\"formula\" for the body of a mesh, which has no base";
                        SceneError::out_of_range("objective.wanted.form", "grid", allowed)
                    })?;
                    WantedPressure::Grid(grid_file::read(&folder.join(file), size, "MPa")?.at(corner))
                }
            }),
            MeasureName::OpenArea => match section.pressure {
                None => return Err(missing("objective.pressure", "a finite number > 0 (MPa)")),
                Some(pressure) => Self::Pressure(PressureMeasure::OpenArea { pressure }),
            },
            MeasureName::StressNorm => Self::Field(FieldMeasure::StressNorm {
                region: region("objective.region", section.region.as_ref())?,
                exponent: exponent(DEFAULT_STRESS_EXPONENT),
            }),
            MeasureName::Stress => Self::Field(FieldMeasure::PeakStress {
                region: region("objective.region", section.region.as_ref())?,
                without_held: section.without_held.unwrap_or_default(),
            }),
            MeasureName::Displacement => Self::Field(FieldMeasure::Displacement {
                region: region("objective.region", section.region.as_ref())?,
                component: section.component.map(AxisName::axis),
                least: false,
            }),
            MeasureName::Volume => Self::Volume,
            MeasureName::Compliance => Self::Field(FieldMeasure::Compliance),
        })
    }

    /// The measure on the mesh of a problem.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a formula that is not finite at a contact node, with the place.
    pub(crate) fn measure(&self, problem: &ContactProblem) -> Result<Measure, SceneError> {
        Ok(match self {
            Self::Pressure(measure) => Measure::Pressure(measure.clone()),
            Self::Deviation(wanted) => {
                Measure::Pressure(PressureMeasure::Deviation { wanted: wanted.at(&contact_places(problem))? })
            }
            Self::Field(measure) => Measure::Field(measure.clone()),
            Self::Volume => Measure::Volume,
        })
    }

    /// Whether it has kinks that the composite model does not know: maxima over points of the bodies.
    pub fn has_unknown_kinks(&self) -> bool {
        matches!(self, Self::Field(measure) if !measure.is_smooth())
    }

    /// Whether it is a function of the displacements.
    pub fn is_of_displacements(&self) -> bool {
        matches!(self, Self::Field(_))
    }

    /// Whether its value can come near 0 or change its sign while the load stays: deviation, open area and compliance.
    pub(crate) fn can_vanish(&self) -> bool {
        match self {
            Self::Volume => false,
            Self::Deviation(_) => true,
            Self::Pressure(measure) => match measure {
                PressureMeasure::Deviation { .. } | PressureMeasure::OpenArea { .. } => true,
                PressureMeasure::Norm { .. } | PressureMeasure::Peak => false,
            },
            Self::Field(measure) => match measure {
                FieldMeasure::Compliance | FieldMeasure::Displacement { .. } => true,
                FieldMeasure::StressNorm { .. } | FieldMeasure::PeakStress { .. } => false,
            },
        }
    }
}

/// Places of the contact nodes at the start, mm.
fn contact_places(problem: &ContactProblem) -> Vec<[f64; 3]> {
    let positions = problem.start_positions();
    problem.boundary.contact_points().iter().map(|point| positions[point.body][point.node as usize]).collect()
}

fn missing(field: &str, allowed: &str) -> SceneError {
    SceneError::out_of_range(field, "missing", allowed)
}

/// Refuses fields that belong to another measure than the one of the section.
fn refuse_foreign_fields(section: &ObjectiveSection) -> Result<(), SceneError> {
    use MeasureName::{Displacement, OpenArea, PressureDeviation, PressureNorm, Stress, StressNorm};
    let exponent = section.exponent.map(|exponent| exponent.to_string());
    let pressure = section.pressure.map(|pressure| pressure.to_string());
    let weight = section.weight.map(|weight| match weight {
        NodeWeight::Area => "area".to_owned(),
        NodeWeight::Nodes => "nodes".to_owned(),
    });
    let table = |is_set: bool| is_set.then(|| "a table".to_owned());
    for (field, value, measures, words) in [
        ("exponent", exponent, &[PressureNorm, StressNorm][..], "pressure norm and the stress norm"),
        ("weight", weight, &[PressureNorm], "pressure norm"),
        ("pressure", pressure, &[OpenArea], "open area"),
        ("wanted", table(section.wanted.is_some()), &[PressureDeviation], "pressure deviation"),
        ("region", table(section.region.is_some()), &[StressNorm, Stress, Displacement], "stresses and displacements"),
        ("component", section.component.map(|axis| format!("{axis:?}")), &[Displacement], "displacement"),
        ("without_held", section.without_held.map(|held| held.to_string()), &[Stress], "stress"),
    ] {
        if let Some(value) = value.filter(|_| !measures.contains(&section.measure)) {
            let allowed = format!("no {field} with this measure, only with the {words}");
            return Err(SceneError::out_of_range(format!("objective.{field}"), value, allowed));
        }
    }
    Ok(())
}
