//! The controls of a shape: lattices in space and over blocks as linear maps to node positions; the admissible set.

mod admissible;
mod bending;
mod bspline;
mod control_rows;
mod coordinates;
mod lattice;
mod lattice_map;
mod map;
mod refinement;
mod surface;

pub use admissible::AdmissibleSet;
pub use bending::bending_rows;
pub(crate) use bending::{bending_line, lattice_bending_rows};
pub(crate) use bspline::Basis;
pub use coordinates::Coordinates;
pub use lattice::{Directions, LatticeShape, NodeBound, ShapedFace};
pub(crate) use lattice_map::mean_rows;
pub(crate) use map::{BodyMap, first_of};
pub use map::{Positions, ShapeMap, Velocities};
pub use refinement::{CoarseNet, coarse_net};
pub use surface::SplineSurface;
