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
    /// Threads of the machine.
    pub machine_threads: usize,
    /// Seconds of the whole study.
    pub seconds: f64,
    /// Smooth solution.
    pub smooth: Vec<ManufacturedErrors>,
    /// Meshes.
    pub discretisation: Vec<MeshStudy>,
    /// Contact solvers.
    pub algebra: Vec<AlgebraStudy>,
    /// Taylor tables and kinks.
    pub subgradient: Option<SubgradientStudy>,
    /// Optimizations.
    pub optimization: Vec<OptimizationStudy>,
}
