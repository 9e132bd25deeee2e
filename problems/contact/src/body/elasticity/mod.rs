//! Trilinear isotropic elasticity on bricks.

pub mod brick;
pub mod hex8;
pub mod stress;
pub(crate) mod traction;

mod material;
mod mean_dilatation;
pub(crate) mod von_mises;

pub use material::{Formulation, Material};
