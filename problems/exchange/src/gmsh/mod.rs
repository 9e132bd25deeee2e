//! Volume meshes with physical groups as Gmsh files: MSH format 4.1, text and binary.
//!
//! ```text
//! $MeshFormat      version, text or binary, size of a number; the int 1 in binary files, which tells the byte order
//! $PhysicalNames   dimension and tag of a physical group → name; text in binary files too
//! $Entities        points, curves, surfaces, volumes: tag → tags of physical groups
//! $Nodes           blocks: tags, then coordinates, with parameters on the entity if the flag of the block is 1
//! $Elements        blocks: entity and type, then tag and nodes of each element
//! $NodeData        written, not read
//! ```
//! Format: *Gmsh reference manual*, "MSH file format", gmsh.info. Elements name their entity only, and the entity
//! names the physical groups, at most 32 here. A group without a name is called by its tag. Other sections are
//! skipped. A file without names of groups is read without `$Entities` too; it has no groups then.
//!
//! [`write()`] gives a file from which [`read`] makes the same mesh. It keeps order and tags of nodes, cells and
//! facets, and names and members of groups. Tags of entities and physical groups are new, lines of groups become
//! points, empty groups are names only, and geometry is lost. Numbers are not rounded.
//!
//! The crate mshio 0.4.2 does not serve: it skips `$PhysicalNames` and does not check that tags exist.

mod check;
mod elements;
mod error;
mod groups;
mod layout;
mod mesh;
mod read;
mod sections;
mod source;
mod write;

pub use elements::{CellKind, FacetKind};
pub use error::{GmshError, Place};
pub use mesh::{GmshCell, GmshFacet, GmshMesh, NodeData};
pub use read::read;
pub use write::{write, write_with_data};
