//! What the commands print, write, refuse and resume.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

/// The binary of this package with this name.
fn binary(name: &str) -> Option<&'static str> {
    Some(match name {
        "contact3d" => env!("CARGO_BIN_EXE_contact3d"),
        "hertz3d" => env!("CARGO_BIN_EXE_hertz3d"),
        "signorini3d" => env!("CARGO_BIN_EXE_signorini3d"),
        "toy2d" => env!("CARGO_BIN_EXE_toy2d"),
        _ => return None,
    })
}

mod binaries;
mod cases;
mod certificates;
mod compare;
mod contact3d;
mod curved_faces;
mod examples;
mod export;
mod export_mesh;
mod facts;
mod flat_foot;
mod fuzz;
mod groups_of_meshes;
mod just_touching;
mod limits;
mod lists;
mod long_runs;
mod look;
mod loosely_held;
mod messages;
mod nothing_lost;
mod objectives;
mod pages_run;
mod pictures;
mod pins;
mod processes;
mod quantities;
#[path = "../../contact/tests/state/rank.rs"]
mod rank;
mod recheck;
mod reports;
mod run_folder;
mod signals;
mod stages;
mod study;
mod tall_columns;
mod terminal;
mod tolerance;
mod toy2d;
mod vtk_files;
mod ways;

#[path = "../../examples/own_objective.rs"]
mod own_objective;

/// docs/plug_in_your_problem.md states these numbers.
#[test]
fn an_objective_of_ones_own_falls_as_the_tutorial_says() {
    let report = own_objective::minimize().unwrap();
    let reduction = report.start_value / report.value;
    assert!(report.counts.evaluations <= 30 && reduction > 2.4, "{report}");
}
