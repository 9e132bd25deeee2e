//! Convex quadratic programs with an epigraph variable: data, certificate, and solvers.
//!
//! ```text
//! min over (d, v)   v + ½ dᵀ H d
//! s.t.              g_jᵀ d − e_j ≤ v            (cuts, multipliers π_j ≥ 0, Σ π_j = 1)
//!                   row_lower ≤ A d ≤ row_upper (multipliers μ, signed: > 0 upper side, < 0 lower side)
//!                   lower ≤ d ≤ upper           (multipliers ν, signed likewise)
//! KKT:              H d + Σ π_j g_j + Aᵀ μ + ν = 0
//! ```
//! [`EpigraphQpSolver`] is a warm-started dual active-set method. What it cannot finish it tries again in other scales
//! of the cuts; what it cannot finish then goes to an interior-point method (feature `interior-point`, on by default),
//! whose answer it refines. Every answer carries its [`kkt_residual`], computed from the data alone. [`project`] is the
//! Euclidean projection onto a polyhedron, a special case.

mod active_set;
mod answer;
mod certificate;
mod coordinates;
mod correction;
#[cfg(feature = "interior-point")]
mod dense;
mod equality_step;
mod exchange;
mod factor;
mod gram;
#[cfg(test)]
mod gram_tests;
mod independent_rows;
#[cfg(feature = "interior-point")]
pub(crate) mod interior_point;
pub(crate) mod kernels;
mod least_violation;
#[cfg(feature = "interior-point")]
mod outer_products;
#[cfg(feature = "interior-point")]
mod polish;
mod pricing;
#[cfg(feature = "interior-point")]
pub(crate) mod primal_dual;
mod problem;
#[cfg(feature = "interior-point")]
pub(crate) mod program;
mod projection;
mod sides;
mod solver;
mod triangular;
mod working_set;

pub use certificate::kkt_residual;
pub(crate) use correction::corrected;
pub(crate) use gram::Gram;
pub(crate) use independent_rows::IndependentRows;
pub use problem::{EpigraphQp, Metric, QpCounts, QpError, QpMethod, QpSolution};
pub use projection::project;
pub(crate) use projection::{is_only_point, nearest};
pub use solver::EpigraphQpSolver;
