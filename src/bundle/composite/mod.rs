//! The composite model as a proposer: trial points from h exact and c linear, as long as that pays.
//!
//! ```text
//! predicted = h(c) − h(c + G d),   ratio = (Θ(x) − Θ(x + d))/predicted:   u falls if it is at least 0.5, rises after a rejected step
//! predicted small at small u:      confirmed: stationary by w ∈ ∂h and G at x alone                       radius 0
//! ```
//! One linearization is pessimistic where a constraint becomes active inside c, so that ratios above 1 are common. A
//! rejected step is corrected from the model at its end. Where the correction fails too, the subproblem takes the
//! curvature of the outputs that earlier Jacobians show. After repeated failures, and as soon as a step fails on kinks
//! of c, the model pauses, and the cuts go on.

#[cfg(feature = "interior-point")]
mod absolute_values;
mod base;
#[cfg(feature = "interior-point")]
mod cones;
mod curvature;
mod elastic;
mod escape;
mod kinks;
mod model;
mod proof;
mod proposer;
#[cfg(feature = "interior-point")]
mod scaled_program;
mod steps;
mod subproblem;
mod trust;
mod weight_fit;

pub use model::OuterCut;
pub(crate) use proof::PointProof;
pub(crate) use proposer::Composite;
