//! The shape of the contact boundary: splines, control heights, admissible set.

mod bspline;

mod admissible;
mod surface;

pub use admissible::{AdmissibleSet, ShapeBounds};
pub use surface::{HeightMap, SplineKind, SplineSurface};
