//! Nonsmooth optimization with pluggable state problems.
//!
//! ```text
//! minimise Θ(α) = J(α, S(α))  over  α ∈ U,      ξ = ∇₁J + D*S(α)(∇₂J) ∈ ∂Θ(α)              method.md (1.1), (1.2)
//! ```

/// The version of this crate, for reports.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

pub mod bundle;
pub mod constraints;
pub mod counted;
pub mod error;
pub mod linalg;
pub mod objective;
pub mod problem;
pub mod qp;
pub mod reduced;
pub mod reparametrized;
pub mod report;
pub mod verify;

mod accuracy;

pub use accuracy::Accuracy;
pub use bundle::{
    AccuracyPolicy, BundleTrust, BundleTrustConfig, Convexity, Cut, Run, ScaledNorm, Snapshot, SnapshotError,
    VariableScaling,
};
pub use constraints::Polyhedron;
pub use counted::Counted;
pub use error::{InputError, OptimizeError, OracleError};
pub use linalg::{Matrix, Vector};
pub use objective::{Answer, Evaluation, FnObjective, NonsmoothObjective, Request};
pub use problem::{Coderivative, Cost, CostGradient, StateSolver};
pub use reduced::ReducedObjective;
pub use reparametrized::Reparametrized;
pub use report::{
    Certificate, CertificateCheck, Counts, IterationRecord, Observer, Report, StepKind, StopRule, TablePrinter,
    Termination,
};
