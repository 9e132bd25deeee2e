//! Triangles as STL files, which are read too; B-spline surfaces, and bodies below them, as STEP files; matrices as
//! Matrix Market files; grids with data as VTU files; volume meshes as Gmsh files, which are read too, and as input of
//! CalculiX.
//!
//! ```text
//! triangles        ─ stl
//! B-spline heights ─ step                   exact: x₁, x₂ of the control points are Greville abscissae (step)
//! entries          ─ matrix_market
//! points, cells    ─ vtk                    arrays with units, numbers without rounding
//! mesh, loads      ─ calculix               nodes, elements, sets, materials, supports
//! mesh, groups     ─ gmsh                   read and written, text and binary
//! ```
//! The package knows numbers only: no mechanics, no command line. Lengths are in mm. The same input gives the same
//! bytes.

pub mod calculix;
mod error;
pub mod gmsh;
pub mod matrix_market;
pub mod step;
mod stl;
pub mod vtk;

pub use error::ExchangeError;
pub use stl::{Triangle, Triangulation, read_stl, stl};
