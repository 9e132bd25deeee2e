//! A mesh of a Gmsh file.

use crate::gmsh::elements::{CellKind, FacetKind};
use std::collections::BTreeMap;

/// A volume mesh with its surface elements and physical groups. Ids of nodes are places in [`GmshMesh::nodes`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GmshMesh {
    /// Positions of the nodes that volume elements use, or in a mesh without these the surface elements, in the order
    /// of the file.
    pub nodes: Vec<[f64; 3]>,
    /// Gmsh's tags of these nodes; each is positive and appears once.
    pub node_tags: Vec<u64>,
    /// Volume elements in the order of the file.
    pub cells: Vec<GmshCell>,
    /// Surface elements in the order of the file, without those on nodes that no volume element uses. Their normals
    /// point to either side.
    pub facets: Vec<GmshFacet>,
    /// Physical groups of dimension 3: name → places in `cells`, ascending.
    pub volumes: BTreeMap<String, Vec<usize>>,
    /// Physical groups of dimension 2: name → places in `facets`, ascending.
    pub surfaces: BTreeMap<String, Vec<usize>>,
    /// Physical groups of dimension 0 and 1: name → ids of nodes, ascending. A group of points and a group of lines
    /// that have one name are one group.
    pub node_groups: BTreeMap<String, Vec<usize>>,
    /// Tags of physical groups by dimension (0 for those of nodes) and name: positive, each once per dimension. A group
    /// without one gets a free tag when it is written.
    pub group_tags: BTreeMap<(usize, String), u32>,
}

/// A volume element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GmshCell {
    /// Shape and order.
    pub kind: CellKind,
    /// Ids of its nodes in Gmsh's order.
    pub nodes: Vec<usize>,
    /// Gmsh's tag; it is positive and appears once among all elements.
    pub tag: u64,
}

/// A surface element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GmshFacet {
    /// Shape and order.
    pub kind: FacetKind,
    /// Ids of its nodes as in the file.
    pub nodes: Vec<usize>,
    /// Gmsh's tag; it is positive and appears once among all elements.
    pub tag: u64,
}

/// Values at all nodes of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeData {
    /// Name of the field.
    pub name: String,
    /// Numbers per node: 1 (scalar), 3 (vector) or 9 (tensor, row by row).
    pub components: usize,
    /// The numbers of the first node, those of the second one, …
    pub values: Vec<f64>,
}
