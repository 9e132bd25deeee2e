//! An elastic body: bricks, trilinear elasticity on them, and the element sums of the adjoint with respect to heights.

pub mod elasticity;
pub mod local_pattern;
pub mod mesh;
pub(crate) mod shape_force;
pub(crate) mod shape_load;
pub(crate) mod shape_sensitivity;
