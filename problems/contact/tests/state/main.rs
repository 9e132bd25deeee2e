//! States of the contact problem: closed forms, two solvers, structure, fields and their files.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod closed_forms;
mod clusters;
#[path = "../common/mod.rs"]
mod common;
mod cone_programs;
mod dual_qp;
mod feet;
mod fields;
mod flat_and_tall_bricks;
mod formulas;
mod friction_problem;
mod friction_too_weak;
mod interference;
mod interruption;
mod nearly_incompressible;
mod paths_agree;
mod prescribed;
mod rank;
mod resultants;
mod scene_structure;
mod several_processes;
mod shapes;
mod shared_factors;
mod successive_approximations;
