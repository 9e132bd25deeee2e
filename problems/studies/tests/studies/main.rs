//! The studies on small cases.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod accuracy;
mod manufactured;
mod pages_run;
mod scaling;
mod stability;
