//! Load cases: one shape under several loadings, each with an equilibrium of its own.
//!
//! ```text
//! Θ(α) = max_k w_k J(α, S_k(α))      or      Σ_k w_k J(α, S_k(α)),      S_k: the equilibrium of case k
//! outputs c = (c_1; …; c_K),  G = (G_1; …; G_K)
//! ```
//! Cases share the shape and its controls. They are independent states under one loading each, not a history: none
//! begins where another has ended.

mod bound;
mod case;
mod cost;
mod map;
mod states;
mod threads;

pub use bound::{Bound, Told};
pub use case::{CaseFailed, LoadCase, Over, WeightedCase};
pub use cost::{CaseCost, CasesCost};
pub use map::LoadCases;
pub use states::CaseStates;
