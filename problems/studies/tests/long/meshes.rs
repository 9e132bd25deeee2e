//! The changes of meshes of the package `scene_file`, all 20 000.

#[path = "../../../scene_file/tests/mesh_changes/property/mod.rs"]
mod property;

#[test]
fn twenty_thousand_changes_of_meshes_leave_the_state_or_are_refused_with_their_reason() {
    property::check(20_000);
}
