//! Tests of the mortar coupling as a whole.

mod derivatives;
mod geometry;
mod properties;
mod smoothness;
mod surface;
