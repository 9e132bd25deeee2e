//! Volume meshes with physical groups as Gmsh files, text and binary: MSH formats 4.1 and 2.2 are read, 4.1 is written.
//!
//! ```text
//! $MeshFormat      version, text or binary, size of a number; the int 1 in binary files, which tells the byte order
//! $PhysicalNames   dimension and tag of a physical group → name; text in binary files too
//! $Entities        points, curves, surfaces, volumes: tag → tags of physical groups
//! $Nodes           blocks: tags, then coordinates, with parameters on the entity if the flag of the block is 1
//! $Elements        blocks: entity and type, then tag and nodes of each element
//! $NodeData        written, not read
//! ```
//! Version 2.2 has no entities: an element names one physical group, and one that is in several stands there once for
//! each of them. [`GmshMesh::merged`] makes one of these.
//!
//! Format: *Gmsh reference manual*, "MSH file format", gmsh.info. Elements name their entity only, and the entity
//! names the physical groups, at most 32 here. A group without a name is called by its tag. Other sections are
//! skipped, also those of a view that Gmsh appended with a format of its own. A file of version 4.1 without names of
//! groups is read without `$Entities` too; it has no groups then.
//!
//! [`write()`] gives a file from which [`read`] makes the same mesh. It keeps order and tags of nodes, cells and
//! facets, and names, tags and members of physical groups. Tags of entities are new, lines of groups become points,
//! empty groups are names only, and geometry is lost. Numbers are not rounded.
//!
//! The crate mshio 0.4.2 does not serve: it skips `$PhysicalNames` and does not check that tags exist.

mod check;
mod contents;
mod elements;
mod error;
mod groups;
mod layout;
mod merge;
mod mesh;
mod read;
mod sections;
mod source;
mod version_2;
mod write;

pub use elements::{CellKind, FacetKind};
pub use error::{GmshError, Place};
pub use merge::Repeated;
pub use mesh::{GmshCell, GmshFacet, GmshMesh, NodeData};
pub use read::{read, read_surfaces};
pub use write::{write, write_with_data};
