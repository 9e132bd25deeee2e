//! Element types by Gmsh's numbers.

/// Kind of a volume element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CellKind {
    /// Hexahedron with 8 nodes.
    Hex8,
    /// Tetrahedron with 4 nodes.
    Tet4,
    /// Tetrahedron with 10 nodes: corners, then midpoints of the edges 01, 12, 02, 03, 23, 13.
    Tet10,
}

/// Kind of a surface element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FacetKind {
    /// Quadrilateral with 4 nodes.
    Quad4,
    /// Triangle with 3 nodes.
    Tri3,
    /// Triangle with 6 nodes: corners, then midpoints of the edges 01, 12, 02.
    Tri6,
}

/// Kind of an element that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ElementKind {
    Cell(CellKind),
    Facet(FacetKind),
    Line,
    Point,
}

/// What is read: Gmsh's number of the type, kind, dimension, number of nodes.
const READ: [(i32, ElementKind, usize, usize); 12] = [
    (5, ElementKind::Cell(CellKind::Hex8), 3, 8),
    (4, ElementKind::Cell(CellKind::Tet4), 3, 4),
    (11, ElementKind::Cell(CellKind::Tet10), 3, 10),
    (3, ElementKind::Facet(FacetKind::Quad4), 2, 4),
    (2, ElementKind::Facet(FacetKind::Tri3), 2, 3),
    (9, ElementKind::Facet(FacetKind::Tri6), 2, 6),
    (1, ElementKind::Line, 1, 2),
    (8, ElementKind::Line, 1, 3),
    (26, ElementKind::Line, 1, 4),
    (27, ElementKind::Line, 1, 5),
    (28, ElementKind::Line, 1, 6),
    (15, ElementKind::Point, 0, 1),
];

/// Numbers and names of further types up to order 4, and of those with a variable number of nodes.
const REFUSED: &str = "6 prism6 7 pyramid5 10 quad9 12 hex27 13 prism18 14 pyramid14 16 quad8 17 hex20 18 prism15 \
    19 pyramid13 20 tri9 21 tri10 22 tri12 23 tri15 24 tri15 29 tet20 30 tet35 32 tet22 33 tet28 34 polygon \
    35 polyhedron 36 quad16 37 quad25 39 quad12 40 quad16 79 tet34 90 prism40 91 prism75 92 hex64 93 hex125 99 hex32 \
    100 hex44 118 pyramid30 119 pyramid55 125 pyramid21 126 pyramid29 137 tet16";

/// Kind, dimension and number of nodes of the type `number`, or its name if such elements are not read.
pub(super) fn element_kind(number: i32) -> Result<(ElementKind, usize, usize), &'static str> {
    if let Some((_, kind, dimension, nodes)) = READ.into_iter().find(|read| read.0 == number) {
        return Ok((kind, dimension, nodes));
    }
    let (mut words, number) = (REFUSED.split(' '), number.to_string());
    while let (Some(known), Some(name)) = (words.next(), words.next()) {
        if known == number {
            return Err(name);
        }
    }
    Err("a type of high order or unknown")
}

/// Gmsh's number of a kind that has one number only, and its number of nodes.
pub(super) fn number_and_nodes(kind: ElementKind) -> (i32, usize) {
    READ.iter().find(|read| read.1 == kind).map_or((0, 0), |read| (read.0, read.3))
}

impl CellKind {
    /// Number of nodes.
    pub fn node_count(self) -> usize {
        number_and_nodes(ElementKind::Cell(self)).1
    }
}

impl FacetKind {
    /// Number of nodes.
    pub fn node_count(self) -> usize {
        number_and_nodes(ElementKind::Facet(self)).1
    }
}
