//! The bundle-trust method: minimises a nonsmooth, possibly nonconvex Θ over a polyhedron, few evaluations being the aim.
//!
//! ```text
//! 1  cuts → convexified cutting-plane model m of Θ at the center x̂                                       model.rs
//! 2  min m(d) + u‖d‖²/2 over x̂ + d ∈ U → trial point y, predicted decrease, certificate             subproblem.rs
//! 3  decrease small? lower u; else stop if the active cuts are near, else restart locally         small_decrease.rs
//!    a curved model proposes instead while it predicts clearly better             pieces.rs, curvature.rs, competition.rs
//! 4  evaluate Θ and one subgradient at y → new cut; failure: shorten the step                            oracle.rs
//! 5  enough decrease: y becomes the center (serious step), else the cut improves the model (null step)      run.rs
//! 6  next weight u = 1/t from the observed curvature, within a finite floor and ceiling                   weight.rs
//! ```
//! References: \[SchrammZowe1992\] for model, trust parameter t and the tests SS/NS; \[Kiwiel1990\] for the weight.

mod builder;
mod competition;
mod config;
mod curvature;
mod cut;
mod finish;
mod judge;
mod model;
mod norm;
mod oracle;
mod pieces;
mod run;
mod small_decrease;
mod start;
mod state;
mod subproblem;
mod weight;

pub use builder::BundleTrust;
pub use config::{AccuracyPolicy, BundleTrustConfig, Convexity, VariableScaling};
pub use cut::Cut;
pub use norm::ScaledNorm;
pub use run::Run;
