//! What a shape can be minimised by, limited in and told about: one list for objectives, limits, reports and studies.

use crate::cost::pressure_measure::PressureMeasure;
use crate::cost::region::Region;
use crate::error::SceneError;

/// A number that shape and contact states of a scene have.
///
/// Forces, moments and displacements are numbers along an axis with their sign, or lengths of vectors without one.
/// Contacts are named by their place in the scene.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Quantity {
    /// A convex function of the contact pressures.
    Pressure(PressureMeasure),
    /// Σ A min(σ/σ₀, 1), mm²: the loaded area.
    LoadedArea {
        /// The pressure σ₀ > 0 from which a node counts with its whole area, MPa.
        pressure: f64,
    },
    /// Σλ_N/ΣA over the contact nodes, MPa: the pressure that a uniform distribution of the normal force would have.
    MeanPressure {
        /// The contact; none for all.
        contact: Option<usize>,
    },
    /// Σ A over the nodes that stick or slip, mm². It jumps as nodes close, so that it can be told only.
    ClosedArea {
        /// The contact; none for all.
        contact: Option<usize>,
    },
    /// Resultant of the forces that a contact exerts on its slave body, N.
    ContactForce {
        /// The contact; none for the only one.
        contact: Option<usize>,
        /// The axis, from 0; none for the length.
        axis: Option<usize>,
    },
    /// Moment of these forces, N·mm.
    ContactMoment {
        /// The contact; none for the only one.
        contact: Option<usize>,
        /// The axis, from 0; none for the length.
        axis: Option<usize>,
        /// The point about which it is taken, mm.
        about: [f64; 3],
    },
    /// Σ λ_T·s over the contact nodes, N·mm: the work of friction on the slip.
    FrictionWork {
        /// The contact; none for all.
        contact: Option<usize>,
    },
    /// The largest |s| over the contact nodes, mm.
    Slip {
        /// The contact; none for all.
        contact: Option<usize>,
    },
    /// Resultant of the forces that the supports of a face exert on its body, N.
    Reaction {
        /// The face, and its body where several have a support of a face of this name.
        region: Region,
        /// The axis, from 0; none for the length.
        axis: Option<usize>,
    },
    /// ((1/V₀) Σ V_e σ_vM,e^p)^{1/p}, MPa: a mean of the von Mises stress at the centres of the cells of a region, the
    /// closer to its largest value the larger p is. V₀ is the volume of the region at the start.
    StressNorm {
        /// The cells that count.
        region: Region,
        /// The exponent p > 1.
        exponent: f64,
    },
    /// The largest von Mises stress over the integration points of the cells of a region, MPa: a maximum of functions
    /// that are smooth where there is stress.
    Stress {
        /// The cells that count.
        region: Region,
        /// Whether cells are left out that have a node held by a support of their body, be it along one direction:
        /// stresses concentrate at supports, and grow there without bound as meshes are refined.
        without_held: bool,
    },
    /// The largest or the smallest displacement over the nodes of a region, mm: a maximum or a minimum of linear
    /// functions of the displacements, or a maximum of lengths.
    Displacement {
        /// The nodes that count.
        region: Region,
        /// The face whose mean displacement is subtracted; none for displacements in space.
        relative_to: Option<Region>,
        /// The axis, from 0, along which displacements are measured with their sign; none for the length |u|.
        axis: Option<usize>,
        /// Whether the smallest displacement is meant; with an axis only.
        least: bool,
    },
    /// f·u, the work of all loads on the displacements, N·mm.
    Compliance,
    /// The volume of the bodies that controls shape, mm³.
    Volume,
    /// That volume over the volume at the start.
    RelativeVolume,
    /// The mass of the bodies whose materials have a density, kg.
    Mass,
}

impl Quantity {
    /// Its name in scene files, reports and tables.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Pressure(measure) => measure.name(),
            Self::LoadedArea { .. } => "loaded-area",
            Self::MeanPressure { .. } => "mean-pressure",
            Self::ClosedArea { .. } => "closed-area",
            Self::ContactForce { .. } => "contact-force",
            Self::ContactMoment { .. } => "contact-moment",
            Self::FrictionWork { .. } => "friction-work",
            Self::Slip { .. } => "slip",
            Self::Reaction { .. } => "reaction",
            Self::StressNorm { .. } => "stress-norm",
            Self::Stress { .. } => "stress",
            Self::Displacement { .. } => "displacement",
            Self::Compliance => "compliance",
            Self::Volume => "volume",
            Self::RelativeVolume => "relative-volume",
            Self::Mass => "mass",
        }
    }

    /// The unit of its values, such as `MPa^{4}·mm^{2}`; empty for ratios. A pressure norm as an objective may have
    /// [another one](crate::cost::PressureCost::unit).
    pub fn unit(&self) -> String {
        match self {
            Self::Pressure(measure) => measure.unit(),
            Self::LoadedArea { .. } | Self::ClosedArea { .. } => "mm^{2}".into(),
            Self::MeanPressure { .. } | Self::StressNorm { .. } | Self::Stress { .. } => "MPa".into(),
            Self::ContactForce { .. } | Self::Reaction { .. } => "N".into(),
            Self::ContactMoment { .. } | Self::FrictionWork { .. } | Self::Compliance => "N mm".into(),
            Self::Slip { .. } | Self::Displacement { .. } => "mm".into(),
            Self::Volume => "mm^{3}".into(),
            Self::RelativeVolume => String::new(),
            Self::Mass => "kg".into(),
        }
    }

    /// Whether the shape alone decides it, without a contact state.
    pub fn is_of_shape(&self) -> bool {
        matches!(self, Self::Volume | Self::RelativeVolume | Self::Mass)
    }

    /// Whether it is the largest contact pressure.
    pub fn is_peak(&self) -> bool {
        *self == Self::Pressure(PressureMeasure::Peak)
    }

    /// Whether it is continuously differentiable where no contact node changes its status.
    pub fn is_smooth(&self) -> bool {
        match self {
            Self::Pressure(measure) => {
                matches!(measure, PressureMeasure::Norm { .. } | PressureMeasure::Deviation { .. })
            }
            Self::LoadedArea { .. } | Self::ClosedArea { .. } | Self::Slip { .. } => false,
            Self::Stress { .. } | Self::Displacement { .. } => false,
            _ => true,
        }
    }

    /// Whether its values may be negative, or zero while the bodies are loaded.
    pub fn can_vanish(&self) -> bool {
        match self {
            Self::Pressure(measure) => {
                matches!(measure, PressureMeasure::Deviation { .. } | PressureMeasure::OpenArea { .. })
            }
            Self::StressNorm { .. } | Self::Stress { .. } | Self::MeanPressure { .. } => false,
            other => !other.is_of_shape(),
        }
    }

    /// Whether bounds of it may have either sign.
    pub fn is_signed(&self) -> bool {
        match self {
            Self::Displacement { .. } | Self::Compliance => true,
            Self::ContactForce { axis, .. } | Self::ContactMoment { axis, .. } | Self::Reaction { axis, .. } => {
                axis.is_some()
            }
            _ => false,
        }
    }

    /// Whether it is a function of the pressures that the composite model takes by their values.
    pub fn is_of_pressures(&self) -> bool {
        matches!(self, Self::Pressure(_))
    }

    /// Refuses what jumps and can be told only; `field`: what messages call the quantity.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`].
    pub fn check_differentiable(&self, field: &str) -> Result<(), SceneError> {
        let allowed = "loaded-area or open-area: the area of closed nodes jumps, and can be reported only";
        SceneError::require(!matches!(self, Self::ClosedArea { .. }), field, self.name(), allowed)
    }
}
