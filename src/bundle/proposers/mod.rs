//! Who proposes trial points: the composite model, where an objective brings its structure, and the plain cuts with the
//! curved model.
//!
//! A new proposer takes a folder with a type that implements [`Proposer`](proposer::Proposer), a name in `Origin`, and
//! a line in `list.rs`.

pub(crate) mod aggregate;
pub(crate) mod curved;
pub(crate) mod cuts;
pub(crate) mod list;
pub(crate) mod pause;
pub(crate) mod proposal;
pub(crate) mod proposer;
pub(crate) mod subproblem;
