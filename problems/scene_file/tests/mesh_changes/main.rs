//! Meshes mean one thing: whatever the order, the numbers, the version and the repetitions of a file, the state is the
//! same; a file that means something else is refused with the reason. The studies try 20 000 changes.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod property;

#[test]
fn a_change_of_a_mesh_leaves_the_state_or_is_refused_with_its_reason() {
    property::check(3_000);
}
