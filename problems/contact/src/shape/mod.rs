//! The shape of the contact boundary: splines, control heights, admissible set.

mod bspline;

mod admissible;
mod pieces;
mod surface;

pub use admissible::{AdmissibleSet, ShapeBounds};
pub use pieces::Pieces;
pub use surface::{HeightMap, SplineKind, SplineSurface};
