//! Who proposes trial points: the plain cuts, and rivals that may replace the proposal of the cuts.
//!
//! A new proposer takes a folder with a type that implements [`Proposer`](proposer::Proposer), an optional setting in
//! `BundleTrustConfig`, a name in `Origin`, and a line in `list.rs`.

pub(crate) mod aggregate;
pub(crate) mod curved;
pub(crate) mod cuts;
pub(crate) mod exploration;
pub(crate) mod list;
pub(crate) mod pause;
pub(crate) mod proposal;
pub(crate) mod proposer;
pub(crate) mod subproblem;
