//! The controls of a scene.

use crate::shape::{HeightShape, LatticeShape};
use serde::{Deserialize, Serialize};

/// What the controls of a scene move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "a scene has one of them")]
pub enum ShapeScene {
    /// Heights of a surface over the base of a block.
    Heights(HeightShape),
    /// Control points of a lattice in space.
    Lattice(LatticeShape),
}

impl ShapeScene {
    /// Number of controls.
    pub fn control_count(&self) -> usize {
        match self {
            Self::Heights(heights) => heights.control_points.iter().product(),
            Self::Lattice(lattice) => lattice.control_count(),
        }
    }

    /// The controls at the start: heights, or no displacement, mm.
    pub fn start(&self) -> Vec<f64> {
        match self {
            Self::Heights(heights) => vec![heights.start_height; self.control_count()],
            Self::Lattice(_) => vec![0.0; self.control_count()],
        }
    }
}
