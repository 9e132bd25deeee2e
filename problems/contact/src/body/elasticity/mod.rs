//! Isotropic linear elasticity on hexahedra and tetrahedra.
//!
//! ```text
//! nodes of a cell ─ shape functions at integration points (hex8, tet10 → gauss) ─┬─ stiffness and its derivative by positions
//!                                                                                ├─ mean dilatation
//! nodes of a face ─ facet: loads and areas                                       └─ stress, von Mises stress
//! ```

pub(crate) mod cell;
pub(crate) mod facet;
pub(crate) mod gauss;
pub mod hex8;
mod material;
mod mean_dilatation;
pub(crate) mod packed;
pub mod stiffness;
pub mod stress;
#[cfg(test)]
mod tests;
pub mod tet10;

pub use cell::{CellNodes, StressedCell};
pub use gauss::GaussPoint;
pub use material::{Formulation, Material};
