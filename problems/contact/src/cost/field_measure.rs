//! Measures of the displacements: what a shape or a limit is measured by.

use crate::cost::region::Region;
use crate::error::SceneError;

/// A function of the displacements of the bodies.
#[derive(Debug, Clone, PartialEq)]
pub enum FieldMeasure {
    /// ((1/V₀) Σ V_e σ_vM,e^p)^{1/p}, MPa: a mean of the von Mises stress at the centres of the cells of a region, the
    /// closer to its largest value the larger p is. V₀ is the volume of the region at the start.
    StressNorm {
        /// The cells that count.
        region: Region,
        /// The exponent p > 1.
        exponent: f64,
    },
    /// f·u, the work of all loads on the displacements, N·mm.
    Compliance,
    /// The largest von Mises stress over the integration points of the cells of a region, MPa: a maximum of functions
    /// that are smooth where there is stress.
    PeakStress {
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
        /// The axis, from 0, along which displacements are measured with their sign; none for the length |u|.
        component: Option<usize>,
        /// Whether the smallest displacement is meant; with a component only.
        least: bool,
    },
}

impl FieldMeasure {
    /// Its name in scene files and reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::StressNorm { .. } => "stress-norm",
            Self::Compliance => "compliance",
            Self::PeakStress { .. } => "stress",
            Self::Displacement { .. } => "displacement",
        }
    }

    /// The unit of the value.
    pub fn unit(&self) -> &'static str {
        match self {
            Self::StressNorm { .. } | Self::PeakStress { .. } => "MPa",
            Self::Compliance => "N mm",
            Self::Displacement { .. } => "mm",
        }
    }

    /// Whether it has a gradient wherever the contact state has one; false for maxima and minima over points.
    pub fn is_smooth(&self) -> bool {
        match self {
            Self::StressNorm { .. } | Self::Compliance => true,
            Self::PeakStress { .. } | Self::Displacement { .. } => false,
        }
    }

    /// Checks its numbers; `place`: what messages call the table that has them.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`].
    pub(super) fn check(&self, place: &str) -> Result<(), SceneError> {
        match self {
            Self::StressNorm { exponent, .. } => {
                let valid = *exponent > 1.0 && exponent.is_finite();
                SceneError::require(valid, format!("{place}.exponent"), exponent, "a finite number > 1")
            }
            Self::Displacement { component: Some(axis), .. } => {
                SceneError::require(*axis < 3, format!("{place}.component"), axis, "an axis: 0, 1 or 2")
            }
            Self::Displacement { component: None, least: true, .. } => {
                let allowed = "the largest length |u|; the smallest displacement is that of a component";
                Err(SceneError::out_of_range(format!("{place}.least"), "true", allowed))
            }
            Self::Compliance | Self::PeakStress { .. } | Self::Displacement { .. } => Ok(()),
        }
    }
}
