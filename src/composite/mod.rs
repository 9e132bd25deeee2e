//! Composite objectives Θ = h∘c: a convex function h of outputs c that bring their whole generalized Jacobian.
//!
//! ```text
//! Θ(x) = h(c(x)),   c: Rⁿ → Rᵐ piecewise smooth with G ∈ ∂c(x),   h: Rᵐ → R convex and known,   Gᵀw ∈ ∂Θ(x) for w ∈ ∂h(c)
//! model at x:   d ↦ h(c + G d)                                             exact in h, linear in c
//! ```
//! A cut knows one direction of Θ; the composite model knows all of them at once, and the curvature of h. Where c is
//! smooth, a dozen evaluations do what takes hundreds by cuts, and the run ends confirmed. On kinks of c the cuts take
//! over. Implement [`OuterFunction`] (or take [`Maximum`], [`SumOfPowers`], [`PositiveParts`], [`EuclideanNorm`],
//! [`GroupNorms`], [`FnOuter`], and [`SmoothPlus`] for their sum with a smooth function), and either give outputs and
//! Jacobian as a closure ([`CompositeFunction`](crate::CompositeFunction)) or as outputs of a state
//! ([`OutputJacobian`](crate::OutputJacobian), [`CompositeObjective`](crate::CompositeObjective)). References:
//! \[Fletcher1982\], \[LewisWright2016\] (proximal method for composite minimization), \[Sagastizabal2013\] (composite
//! bundle method).

mod constrained;
mod epigraph;
mod linearization;
mod outer;
mod sum;

pub use crate::nonlinear::OutputPiece;
pub use constrained::WithConstraints;
#[cfg(feature = "interior-point")]
pub(crate) use epigraph::EpigraphTerm;
pub use epigraph::{ConeFunction, Epigraph};
pub use linearization::{InactiveConstraints, Linearization, LinearizationRequest, Linearized};
pub use outer::{
    EuclideanNorm, FnOuter, GroupNorms, Maximum, OuterFunction, OuterPart, PositiveParts, SumOfPowers, weighted_gram,
};
pub use sum::SmoothPlus;
