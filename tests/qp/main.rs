//! The quadratic subproblem: random programs, recorded runs, an independent solver.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod qp_properties;
mod qps;
mod reference;
