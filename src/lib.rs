//! Nonsmooth optimization with pluggable state problems.
//!
//! ```text
//! minimise Θ(α) = J(α, S(α))  over  α ∈ U,      ξ = ∇₁J + D*S(α)(∇₂J) ∈ ∂Θ(α)              method.md (1.1), (1.2)
//! ```

pub mod constraints;
pub mod error;
pub mod linalg;
pub mod objective;
pub mod problem;
pub mod qp;
pub mod reduced;

mod accuracy;

pub use accuracy::Accuracy;
pub use constraints::Polyhedron;
pub use error::{InputError, OracleError};
pub use linalg::{Matrix, Vector};
pub use objective::{Answer, Evaluation, FnObjective, NonsmoothObjective, Request};
pub use problem::{Coderivative, Cost, CostGradient, StateSolver};
pub use reduced::ReducedObjective;
