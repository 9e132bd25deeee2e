//! Unstructured grids with data as files of the Visualization Toolkit: VTU for one grid, PVD for a series of grids.
//!
//! ```text
//! VTU   XML, arrays inline as base64 of (length in bytes as UInt64, values), all little endian, not compressed
//! PVD   XML, a list of (time, part, file)
//! ```
//! The first array of numbers and the first one of vectors on points or cells are the active ones: what viewers show at
//! first. Formats: *VTK File Formats*, docs.vtk.org; hexahedra, quadrilaterals and the order of tensor components (XX,
//! YY, ZZ, XY, YZ, XZ) as defined there. Floating-point values are written as they are, without rounding.
//!
//! Units are VTK's own key of an array, `UNITS_LABEL`. There are no arrays of text: meshio 5.3.5 refuses files that
//! have one.

mod collection;
mod grid;
mod unstructured;
mod xml;

pub use collection::{Entry, collection};
pub use grid::{Array, Cell, Note, NoteValue, UnstructuredGrid, Values, VtkError};
pub use unstructured::unstructured;
