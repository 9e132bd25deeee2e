//! How much is measured.

use crate::scaling::{Case, SceneName};
use clap::ValueEnum;
use scene_file::default_subdomains;
use serde::Serialize;

/// Size of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// A few seconds: smallest meshes, to see that everything works.
    Smoke,
    /// About two minutes.
    Quick,
    /// All meshes up to 35 bricks per edge, optimization up to 24.
    Full,
}

/// A part of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// Error of the discretisation.
    Discretisation,
    /// Error of the contact solvers.
    Algebra,
    /// Error of the subgradient, kinks.
    Subgradient,
    /// Distance from the minimum.
    Optimization,
}

/// The scenes of the study.
pub const SCENES: [SceneName; 2] = [SceneName::Signorini, SceneName::Hertz];

/// N bricks per edge in the subdomains that a scene file has by default.
pub fn case(mesh: usize) -> Case {
    Case { mesh, subdomains: default_subdomains(mesh) }
}

impl Extent {
    /// Meshes of the study of the discretisation.
    pub fn meshes(self) -> &'static [usize] {
        match self {
            Self::Smoke => &[4, 6, 8],
            Self::Quick => &[4, 6, 8, 12, 16, 24],
            Self::Full => &[4, 6, 8, 12, 16, 24, 35],
        }
    }

    /// Mesh of the study of the contact solvers.
    pub fn algebra_mesh(self) -> usize {
        match self {
            Self::Smoke => 4,
            Self::Quick => 8,
            Self::Full => 12,
        }
    }

    /// Exponents e of the tolerances 10^(−e).
    pub fn exponents(self) -> Vec<i32> {
        match self {
            Self::Smoke => vec![2, 6, 10],
            Self::Quick | Self::Full => (2..=12).collect(),
        }
    }

    /// Mesh of the Taylor tables.
    pub fn taylor_mesh(self) -> usize {
        if self == Self::Smoke { 4 } else { 6 }
    }

    /// Kinks constructed per scene.
    pub fn kinks(self) -> usize {
        match self {
            Self::Smoke => 1,
            Self::Quick => 4,
            Self::Full => 12,
        }
    }

    /// Meshes of the optimization, coarse to fine; all but coarse-to-fine work on the last.
    pub fn levels(self) -> &'static [usize] {
        match self {
            Self::Smoke => &[4, 6],
            Self::Quick => &[6, 12],
            Self::Full => &[6, 12, 24],
        }
    }

    /// Evaluations per optimization, on each mesh of coarse-to-fine as well.
    pub fn evaluations(self) -> usize {
        match self {
            Self::Smoke => 6,
            Self::Quick | Self::Full => 60,
        }
    }
}
