//! Total FETI: the contact problem in the forces between torn pieces.
//!
//! ```text
//! torn        tear the bodies into subdomains; every row of B glues, supports, or meets the obstacle:     B u − g = w
//!             K u + Bᵀλ = f per subdomain:    u = K⁺(f − Bᵀλ) + R a,    solvable if Rᵀ(f − Bᵀλ) = 0
//! dual        eliminate u:    w = d − F λ + Gᵀ a,    G λ = e,    F = B K⁺ Bᵀ,  G = Rᵀ Bᵀ,  d = B K⁺ f − g,  e = Rᵀ f
//!             w_E = 0 on the rows that glue and support,    λ = Π(λ + c w) on the contact rows
//! newton      solve that nonsmooth equation for (λ, a): linearise Π at an iterate, solve for the active set, project by P
//! paper       or: bound |λ_T| by Ψ, minimise over λ (a QP), Ψ ← 𝓕 λ_N
//! derivative  transpose the linearised equation for j = ∂J/∂λ: adjoint q, p; element sums give ∂J/∂(positions of the nodes)
//!             or solve it for changes of the shape: tangents ∂λ, ∂w, all columns in lockstep
//! solver      controls ─ factors ─ (d, F, G, e) ─ method ─▶ (λ, a) ─ forces, certificates, TornState ─ derivative
//! ```
//! method.md (4.1), (4.2). Each folder uses only those above it.

mod derivative;
mod dual;
mod newton;
mod paper;
mod questions;
mod solver;
mod state;
mod torn;

pub(crate) use derivative::MAX_COLUMNS;
pub use dual::{DualOperator, Precision};
pub use newton::Recycling;
pub use paper::{AugmentedLagrangianCounts, AugmentedLagrangianSettings, solve_by_successive_approximations};
pub use solver::{DualMethod, TotalFeti};
pub use state::TornState;
pub use torn::{PreconditionerKind, TornModel, TornOptions, TornShelf};
