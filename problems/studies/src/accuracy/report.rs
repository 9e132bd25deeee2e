//! All that was measured.

use crate::accuracy::algebra::AlgebraStudy;
use crate::accuracy::discretisation::MeshStudy;
use crate::accuracy::manufactured::ManufacturedErrors;
use crate::accuracy::optimization::OptimizationStudy;
use crate::accuracy::subgradient::SubgradientStudy;
use serde::Serialize;

/// The study; parts that were not asked for are empty.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct AccuracyReport {
    pub machine_threads: usize,
    /// Seconds of the whole study.
    pub seconds: f64,
    /// Errors for a manufactured smooth solution.
    pub smooth: Vec<ManufacturedErrors>,
    /// Errors of the discretisation per scene.
    pub discretisation: Vec<MeshStudy>,
    /// Errors of the contact solvers per scene.
    pub algebra: Vec<AlgebraStudy>,
    /// Taylor tables and kinks.
    pub subgradient: Option<SubgradientStudy>,
    /// Effect of mesh and tolerance on optimizations.
    pub optimization: Vec<OptimizationStudy>,
}
