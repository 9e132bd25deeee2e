//! Subgradients of the contact problem: independent implementation, Taylor tests, error bounds.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

#[path = "../common/mod.rs"]
mod common;
mod error_estimate;
#[path = "../common/field_check.rs"]
mod field_check;
mod field_quantities;
mod load_cases;
mod objectives;
mod prescribed;
mod reference_cases;
mod subgradient_properties;
mod tangents;
