//! Trilinear isotropic elasticity on bricks.

pub mod hex8;
pub mod traction;

mod material;

pub use material::Material;
