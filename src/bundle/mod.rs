//! The bundle-trust method: it minimises a nonsmooth, possibly nonconvex Θ over a polyhedron with few evaluations.
//!
//! ```text
//! 1  cuts → convexified cutting-plane model m of Θ at the center x̂                      proposers/cuts/model.rs
//! 2  min m(d) + u‖d‖²/2 over x̂ + d ∈ U → trial point y, predicted decrease, certificate         proposers/cuts
//! 3  decrease small? lower u; else stop if the active cuts are near, else restart locally       small_decrease.rs, second_look.rs
//!    a rival proposes instead: the curved model, an exploration        proposers/curved, proposers/exploration
//!    Θ = h∘c: the composite model proposes before all others, and may prove x̂ stationary                 composite
//! 4  evaluate Θ and one subgradient at y → new cut; failure: shorten the step                          oracle.rs
//! 5  enough decrease: y becomes the center (serious step), else its cut improves the model     acceptance.rs
//! 6  next weight u = 1/t from the observed curvature, within a finite floor and ceiling  proposers/cuts/weight.rs
//! ```
//! References: \[SchrammZowe1992\] for model, trust parameter t and the tests SS/NS; \[Kiwiel1990\] for the weight.

mod builder;
mod composite;
mod config;
mod coordinates;
pub(crate) mod cut;
mod demand;
mod evidence;
mod finish;
mod kept_cuts;
mod limits;
mod noise;
pub(crate) mod norm;
mod oracle;
mod pairs;
mod proof;
mod proposers;
mod record;
mod resolution;
mod run;
mod scales;
mod seen;
mod start;
mod state;
mod trial;
mod verdict;

pub use builder::BundleTrust;
pub use composite::OuterCut;
pub use config::{AccuracyPolicy, BundleTrustConfig, Convexity, VariableScaling};
pub use cut::Cut;
pub use norm::ScaledNorm;
pub use run::Run;
