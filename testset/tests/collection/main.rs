//! The collection of published problems: table, optimal values, subgradients.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod common;
mod constrained;
mod optimum;
mod subgradients;
mod table;
