//! Contact along true normals on unstructured meshes: patch tests, derivatives, closed forms, rotations, random scenes.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod cases;
mod elements;
#[path = "../common/field_check.rs"]
mod field_check;
mod field_quantities;
mod grid;
mod hertz;
mod lame;
mod law;
mod mindlin;
mod patch;
mod random;
mod rotated;
mod setting;
mod several_contacts;
mod tangents;
mod taylor;
mod volume;
