//! The bundle-trust method: it minimises a nonsmooth, possibly nonconvex Θ over a polyhedron with few evaluations.
//!
//! ```text
//! 1  proposers in turn: a trial point y, or the end with its proof                                    run.rs, proposers/list.rs
//!    Θ = h∘c: the composite model                                                                     composite
//!    cuts → model m of Θ at the center x̂;  min m(d) + u‖d‖²/2 over x̂ + d ∈ U; curved model             proposers/cuts, proposers/curved
//!    decrease small: lower u, restart locally, evaluate next to x̂                                     proposers/cuts/stationarity.rs
//! 2  may the run end? evidence from the multipliers, one verdict                                      evidence.rs, verdict.rs
//! 3  evaluate Θ and one subgradient at y → new cut; failure: shorten the step                         oracle.rs
//! 4  enough decrease: y becomes the center (serious step), else its cut improves the model            trial.rs
//! 5  next weight u = 1/t from the observed curvature, within a floor and a ceiling                    proposers/cuts/weight.rs
//! ```
//! References: \[SchrammZowe1992\] for model, trust parameter t and the tests SS/NS; \[Kiwiel1990\] for the weight.

mod builder;
mod composite;
mod config;
mod constrained;
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
mod step_trust;
mod trial;
mod verdict;

pub use builder::BundleTrust;
pub use composite::OuterCut;
pub use config::{AccuracyPolicy, BundleTrustConfig, Convexity, VariableScaling};
pub use cut::Cut;
pub use norm::ScaledNorm;
pub use run::Run;
