//! The controls of a shape: height surfaces of blocks and lattices in space as linear maps to node positions; the
//! admissible set.

mod admissible;
mod bending;
mod bspline;
mod heights;
mod lattice;
mod map;
mod pieces;
mod refinement;
mod scene;
mod surface;

pub use admissible::AdmissibleSet;
pub use bending::bending;
pub(crate) use bending::bending_rows;
pub(crate) use heights::height_map;
pub use heights::{HeightShape, ShapeBounds, ShapedFace};
pub use lattice::{Coordinates, Directions, LatticeShape, NodeBound};
pub(crate) use map::{BodyMap, first_of};
pub use map::{Positions, ShapeMap, Velocities};
pub use pieces::Pieces;
pub use scene::ShapeScene;
pub use surface::{HeightMap, SplineKind, SplineSurface};
