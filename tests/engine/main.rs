//! The engine: what it promises, on small functions and on the collection.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod common;

mod accuracy_cost;
mod certificate;
mod composite;
mod composite_faults;
mod constraints;
mod degenerate_input;
mod evaluation_counts;
mod feasibility;
#[cfg(feature = "interior-point")]
mod fits;
mod generic_use;
mod inexact_oracle;
mod infeasible_starts;
mod interruption;
mod kinks;
mod linear_rows;
mod linear_scaling;
mod many_variables;
mod outer_functions;
mod parts;
mod penalty;
mod plateau;
mod proposers;
mod restart;
mod runs;
mod second_look;
mod sums;
mod terminations;
mod true_terminations;
mod trusses;
