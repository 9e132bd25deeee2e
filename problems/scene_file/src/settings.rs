//! Solver, optimizer and outputs of a scene file.

use crate::ContinuationMesh;
use contact::contact_shape::SolverKind;
use contact::tfeti::PreconditionerKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The contact solver.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SolverSection {
    /// Total FETI with direct condensation where that is needed, or one method alone: Newton on total FETI, direct
    /// condensation, successive approximations on total FETI.
    pub kind: SolverKind,
    /// Preconditioner of the dual operator of total FETI.
    pub preconditioner: PreconditionerKind,
    /// Clusters into which the subdomains of all bodies are joined for many processes; at least as many as processes.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000), extend("x-unit" = "1"))]
    pub clusters: Option<usize>,
}

/// The optimizer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct OptimizerSection {
    /// With the Jacobian of what objective and limits depend on, or with one subgradient per shape. Default composite
    /// for objectives of pressures or of the shape alone, and for smooth ones with load cases or limits; else bundle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<MethodName>,
    /// Largest number of evaluations of objective and subgradient, on every mesh.
    #[schemars(range(min = 1, max = 1_000_000), extend("x-unit" = "1"))]
    pub max_evaluations: usize,
    /// Predicted decrease, relative to the objective, at which the run ends. Default 1e-7, or 1e-5 beside a limit of
    /// the volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "1", "exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub tolerance: Option<f64>,
    /// Longest time of one run; the evaluation under way is finished. Default no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e9), extend("x-unit" = "s", "exclusiveMinimum" = 0.0))]
    pub time_limit: Option<f64>,
    /// Length of the first step; a fifth of it on later meshes of a continuation. Default half of the mean gap at the
    /// start, between a thousandth and half of the smallest extent of the body.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e9), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
    pub first_step: Option<f64>,
    /// Largest number of cuts kept. Default controls + 15, at most 500.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 3, max = 10_000), extend("x-unit" = "1"))]
    pub bundle_size: Option<usize>,
    /// Accuracy asked of the contact solver: the tightest, or as the predicted decrease demands, which is refused with
    /// objectives that can reach 0.
    pub accuracy: AccuracyName,
    /// Growing meshes of a coarse-to-fine optimization: bricks along the axis of blocks that has most, or Gmsh files in
    /// place of the only mesh. Empty for one run on the mesh of the scene.
    #[schemars(extend("x-unit" = "1"))]
    pub continuation: Vec<ContinuationMesh>,
    /// Number of starts: that of the scene, one that follows what lies opposite where all controls are heights, then
    /// smooth random changes, always the same.
    #[schemars(range(min = 1, max = 1000), extend("x-unit" = "1"))]
    pub starts: usize,
    /// Every start is optimized once, with all controls, in place of the attempts that a lattice asks for
    /// (docs/commands.md). Default false.
    pub single: bool,
}

impl Default for OptimizerSection {
    fn default() -> Self {
        Self {
            method: None,
            max_evaluations: 150,
            tolerance: None,
            time_limit: None,
            first_step: None,
            bundle_size: None,
            accuracy: AccuracyName::Tightest,
            continuation: vec![],
            starts: 1,
            single: false,
        }
    }
}

/// What proposes trial points.
// The one name of two switches: `composite_model` of the engine, and what the contact solver will be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MethodName {
    /// The composite model, with the Jacobian of all pressures, beside those of the bundle.
    Composite,
    /// The bundle alone, with one subgradient per shape.
    Bundle,
}

/// How accurately the objective is asked for.
// The tag of `AccuracyPolicy`, whose numbers a file leaves at their usual values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "explained where the optimizer documents its accuracy")]
pub enum AccuracyName {
    #[default]
    Tightest,
    OnDemand,
}

/// The outputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct OutputSection {
    /// Folder for the files of a run, relative to where the program is started. Default none: nothing is written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub folder: Option<String>,
    /// Whether pictures are drawn into the folder, as SVG.
    pub pictures: bool,
    /// Whether fields are written for ParaView.
    pub vtk: bool,
    /// Whether a report is written as a self-contained HTML page.
    pub report: bool,
}

impl Default for OutputSection {
    fn default() -> Self {
        Self { folder: None, pictures: true, vtk: true, report: true }
    }
}
