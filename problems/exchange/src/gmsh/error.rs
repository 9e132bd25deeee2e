//! Why a Gmsh file is not read or written.

use std::fmt;
use thiserror::Error;

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Line of a text file, counted from 1.
    Line(usize),
    /// Byte of a binary file, counted from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(formatter, "line {line}"),
            Place::Byte(byte) => write!(formatter, "byte {byte}"),
        }
    }
}

/// Why a Gmsh file is not read or written.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum GmshError {
    /// A value that is not allowed: another version, an unknown entity, a count that disagrees, …
    #[error("{place}: {what} is {found}; allowed: {allowed}")]
    Value {
        /// Where it stands.
        place: Place,
        /// Name of the quantity.
        what: &'static str,
        /// Value found.
        found: String,
        /// Description of the allowed values.
        allowed: String,
    },
    /// Elements of a type that is not read.
    #[error(
        "{place}: {}elements of type {number} ({name}); allowed: hex8, tet4, tet10, their faces quad4, tri3 and tri6, \
         lines and points",
        entity.map_or_else(String::new, |entity| format!("entity {entity} has "))
    )]
    ElementType {
        /// Where the type stands.
        place: Place,
        /// Tag of the entity, where elements have it in common.
        entity: Option<i32>,
        /// Gmsh's number of the type.
        number: i32,
        /// Name of the type.
        name: &'static str,
    },
    /// The file ends too early.
    #[error("{place}: the file ends there; {what} must follow")]
    Truncated {
        /// Where the file ends.
        place: Place,
        /// What is missing.
        what: &'static str,
    },
    /// Something that every mesh has is missing.
    #[error("{place}: the file ends without {what}")]
    Missing {
        /// Where the file ends.
        place: Place,
        /// What is missing.
        what: &'static str,
    },
    /// An element uses a node that the file does not have.
    #[error("element {element}: node {node} is unknown; allowed: nodes of $Nodes")]
    UnknownNode {
        /// Tag of the element.
        element: u64,
        /// Tag of the node.
        node: u64,
    },
    /// An element of a physical group lies apart from the volume.
    #[error(
        "element {element} of the physical group \"{group}\": no volume element uses node {node}; allowed: nodes of \
         volume elements"
    )]
    Detached {
        /// Tag of the element.
        element: u64,
        /// Name of the physical group.
        group: String,
        /// Tag of the node.
        node: u64,
    },
    /// Two physical groups have one name.
    #[error(
        "the physical groups {} and {} of dimension {dimension} are both called \"{name}\"; allowed: one name for \
         each group",
        tags[0],
        tags[1]
    )]
    Name {
        /// Dimension of the groups.
        dimension: usize,
        /// Tags of the groups.
        tags: [u32; 2],
        /// The name.
        name: String,
    },
    /// Mesh or data do not make a file.
    #[error("{what} {index} is {found}; allowed: {allowed}")]
    Mesh {
        /// Name of the quantity.
        what: &'static str,
        /// Its place in the mesh, counted from 0, or its tag or name.
        index: String,
        /// Value found.
        found: String,
        /// Description of the allowed values.
        allowed: String,
    },
}
