//! Nonlinear constraints of a run: what has been seen of them, and the admissible set with their linearizations.
//!
//! ```text
//! v(x) = max_j c_j(x)⁺/σ_j                 violation, σ_j = ‖∇c_j‖* at the first point where it does not vanish
//! P(x) = Θ(x) + ρ v(x)                     merit: decides between serious and null step; ρ exceeds Σ σ_j μ_j of all subproblems
//! s  = min over d  max_i t_i(d)⁺ + κ‖d‖²/2,   x̂ + d ∈ U              what the linearizations t_i allow the violation to become
//! set of the subproblems:  U ∩ { t_i(d) ≤ s }
//! ```
//! A linearization of a nonsmooth constraint is a cut of it; where the constraint is not convex, of c_j + γ‖x − x̂‖².
//! All proposers see the constraints as rows of the admissible set, so that a subproblem gives their multipliers, and a
//! proof of stationarity holds with them.
//! References: \[Kiwiel1990\] for cuts, \[ByrdNocedalWaltz2008\] for the relaxation and the choice of ρ.

mod memory;
mod tangent;
mod working_set;

pub(crate) use memory::Constraints;
pub(crate) use tangent::Tangent;
pub(crate) use working_set::{ROOM, WorkingSet};
