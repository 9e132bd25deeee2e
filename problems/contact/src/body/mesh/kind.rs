//! The kinds of cells: numbers of nodes, faces, edges.

use serde::{Deserialize, Serialize};

/// The kind of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum CellKind {
    /// Trilinear hexahedron; nodes in the order of Gmsh and VTK.
    Hex8,
    /// Tetrahedron of second order; nodes in the order of Gmsh: vertices, then the middles of the edges (0,1), (1,2),
    /// (0,2), (0,3), (2,3), (1,3).
    Tet10,
}

/// Faces of a hexahedron, counterclockwise seen from outside.
const HEX8: [&[usize]; 6] = [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
/// Faces of a tetrahedron, counterclockwise seen from outside: vertices, then the middles between them.
const TET10: [&[usize]; 4] = [&[0, 2, 1, 6, 5, 4], &[0, 1, 3, 4, 9, 7], &[1, 2, 3, 5, 8, 9], &[0, 3, 2, 7, 8, 6]];

impl CellKind {
    /// Number of nodes.
    pub fn node_count(self) -> usize {
        match self {
            Self::Hex8 => 8,
            Self::Tet10 => 10,
        }
    }

    /// Its faces as local nodes: the corners counterclockwise seen from outside, then the middles of the edges.
    pub fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Hex8 => &HEX8,
            Self::Tet10 => &TET10,
        }
    }

    /// Corners of a face among its nodes.
    pub fn corner_count(self) -> usize {
        match self {
            Self::Hex8 => 4,
            Self::Tet10 => 3,
        }
    }

    /// Its name in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hex8 => "hex8",
            Self::Tet10 => "tet10",
        }
    }
}
