//! Meshes of hexahedra and tetrahedra: nodes, cells, named faces, pieces. A block of bricks is one way to make a mesh.

mod block;
mod grid;
mod kind;
#[expect(clippy::module_inception, reason = "the type that the folder is named for")]
mod mesh;
mod partition;
mod skin;

pub use block::{BlockFace, block};
pub use grid::Grid;
pub use kind::CellKind;
pub(crate) use mesh::narrow;
pub use mesh::{Cell, CellFace, Mesh, WHOLE, bounding_box, smallest_extent};
pub use skin::SharedFace;
