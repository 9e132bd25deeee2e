//! How much is measured.

use crate::scaling::{Case, SceneName};
use clap::ValueEnum;
use scene_file::default_subdomains;
use serde::Serialize;

/// Size of the study; meshes are bricks per edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent {
    /// Meshes of the study of the discretisation.
    pub meshes: &'static [usize],
    /// Mesh of the study of the contact solvers.
    pub algebra_mesh: usize,
    /// Exponents e of the tolerances 10^(−e).
    pub exponents: &'static [i32],
    /// Mesh of the Taylor tables.
    pub taylor_mesh: usize,
    /// Kinks constructed per scene.
    pub kinks: usize,
    /// Meshes of the optimization, coarse to fine; all but coarse-to-fine work on the last.
    pub levels: &'static [usize],
    /// Evaluations per optimization, on each mesh of coarse-to-fine as well.
    pub evaluations: usize,
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
    /// A few seconds: smallest meshes, to see that everything works.
    pub const SMOKE: Self = Self {
        meshes: &[4, 6, 8],
        algebra_mesh: 4,
        exponents: &[2, 6, 10],
        taylor_mesh: 4,
        kinks: 1,
        levels: &[4, 6],
        evaluations: 6,
    };
    /// The extent that takes about two minutes.
    pub const QUICK: Self = Self {
        meshes: &[4, 6, 8, 12, 16, 24],
        algebra_mesh: 8,
        exponents: &[2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12],
        taylor_mesh: 6,
        kinks: 4,
        levels: &[6, 12],
        evaluations: 60,
    };
    /// All meshes up to 35 bricks per edge, optimization up to 24.
    pub const FULL: Self =
        Self { meshes: &[4, 6, 8, 12, 16, 24, 35], algebra_mesh: 12, kinks: 12, levels: &[6, 12, 24], ..Self::QUICK };
}
