//! One small record per evaluation, and the counts of a run.

use serde::{Deserialize, Serialize};

/// The outcome of an evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum StepKind {
    /// The evaluation at the start of the run.
    Start,
    /// The trial point became the center.
    Serious,
    /// The trial point became a cut only.
    Null,
    /// The oracle certified that the point is no descent; a cut only.
    NoDescent,
    /// The center was evaluated again, more accurately.
    Refinement,
    /// The oracle failed; the step is shortened.
    Failed,
}

impl std::fmt::Display for StepKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Start => "start",
            Self::Serious => "serious",
            Self::Null => "null",
            Self::NoDescent => "no descent",
            Self::Refinement => "refined",
            Self::Failed => "failed",
        })
    }
}

/// Who proposed the point of an evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Origin {
    /// Nobody: the point is the start, or the center once more.
    Given,
    /// The cutting-plane model proposed the point.
    Cuts,
    /// The curved model proposed the point.
    CurvedModel,
    /// The composite model proposed the point.
    CompositeModel,
    /// Nobody: the point lies next to the center, for the confirmation of an end.
    Confirmation,
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Given => "given",
            Self::Cuts => "cuts",
            Self::CurvedModel => "curved model",
            Self::CompositeModel => "composite",
            Self::Confirmation => "confirmation",
        })
    }
}

/// One evaluation of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IterationRecord {
    /// Number of the evaluation, from 1, failed ones included.
    pub evaluation: usize,
    /// The outcome of the evaluation.
    pub kind: StepKind,
    /// Who proposed the point.
    pub origin: Origin,
    /// Θ at the trial point; none if the oracle failed.
    pub value: Option<f64>,
    /// Θ at the center after the step.
    pub center_value: f64,
    /// Decrease that the model predicted, ≥ 0, in units of Θ.
    pub predicted_decrease: f64,
    /// Norm of the aggregate subgradient, constraints included.
    pub aggregate_norm: f64,
    /// Aggregate error, ≥ 0.
    pub aggregate_error: f64,
    /// The weight u of the quadratic term of the subproblem.
    pub weight: f64,
    /// Length of the step in scaled variables.
    pub step_length: f64,
    /// Largest relative violation of the admissible set at the trial point.
    pub violation: f64,
    /// Cuts in the bundle.
    pub cuts: usize,
    /// Curvature added to make the model convex; 0 while Θ looks convex.
    pub convexification: f64,
    /// Relative accuracy asked of the oracle.
    pub accuracy: f64,
    /// Text of the failure, if the oracle failed.
    pub failure: Option<String>,
    /// Whether the oracle returned a Jacobian.
    #[serde(default)]
    pub jacobian: bool,
    /// A defect that did not fail the evaluation, such as a Jacobian that could not be had.
    #[serde(default)]
    pub note: Option<String>,
    /// Work that the evaluation took, in the oracle's unit; 0 if it failed, or where none is counted.
    #[serde(default)]
    pub work: usize,
    /// Seconds since the start of the run when the evaluation was done.
    pub seconds: f64,
}

/// The note of a record about the Jacobian of an evaluation.
#[derive(Debug, PartialEq, Eq, Default)]
pub(crate) enum Noted {
    /// The oracle said nothing about a Jacobian.
    #[default]
    Nothing,
    /// The evaluation computed a Jacobian.
    Jacobian,
    /// The reason why it could not be had.
    NoJacobian(String),
}

impl IterationRecord {
    /// Notes what an evaluation said about its Jacobian.
    pub(crate) fn note(&mut self, noted: Noted) {
        self.jacobian = noted == Noted::Jacobian;
        self.note = match noted {
            Noted::NoJacobian(reason) => Some(format!("no Jacobian: {reason}")),
            Noted::Nothing | Noted::Jacobian => None,
        };
    }
}

/// Counts of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Counts {
    /// Evaluations, failed ones included.
    pub evaluations: usize,
    /// Steps of the engine, those without evaluation included.
    pub iterations: usize,
    /// Number of serious steps.
    pub serious: usize,
    /// Null steps, certified no-descent answers included.
    pub null: usize,
    /// Evaluations of the center repeated with a tighter accuracy.
    pub refined: usize,
    /// Number of evaluations without an answer.
    pub failed: usize,
    /// Evaluations by who proposed their point.
    pub trials: TrialCounts,
    /// Local restarts of the bundle.
    pub restarts: usize,
    /// Jacobians of a composite objective's outputs that the oracle returned.
    #[serde(default)]
    pub jacobians: usize,
    /// Number of subproblems solved.
    pub qp_solves: usize,
    /// Subproblems that needed the fallback solver.
    pub qp_fallbacks: usize,
}

impl Counts {
    /// Counts an evaluation by what became of it and by who proposed its point.
    pub(crate) fn add(&mut self, kind: StepKind, origin: Origin) {
        match kind {
            StepKind::Start => {}
            StepKind::Serious => self.serious += 1,
            StepKind::Null | StepKind::NoDescent => self.null += 1,
            StepKind::Refinement => self.refined += 1,
            StepKind::Failed => self.failed += 1,
        }
        self.trials.add(origin);
    }
}

/// Evaluations of trial points, failed ones included, by who proposed them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct TrialCounts {
    /// Number of trial points of the cutting-plane model.
    pub cuts: usize,
    /// Number of trial points of the curved model.
    pub curved_model: usize,
    /// Number of trial points of the composite model.
    pub composite_model: usize,
    /// Points next to the center, for the confirmation of an end.
    #[serde(default)]
    pub confirmation: usize,
}

impl TrialCounts {
    pub(crate) fn add(&mut self, origin: Origin) {
        match origin {
            Origin::Given => {}
            Origin::Cuts => self.cuts += 1,
            Origin::CurvedModel => self.curved_model += 1,
            Origin::CompositeModel => self.composite_model += 1,
            Origin::Confirmation => self.confirmation += 1,
        }
    }
}
