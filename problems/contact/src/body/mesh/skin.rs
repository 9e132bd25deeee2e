//! What is seen from the topology of a mesh: its skin, connected parts, neighbours of cells.

use crate::body::mesh::{CellFace, Mesh};
use std::collections::HashMap;

/// A face with the cells that have it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SharedFace {
    /// The face of the first cell.
    pub first: CellFace,
    /// The face of the cell on the other side; none on the skin.
    pub second: Option<CellFace>,
}

impl Mesh {
    /// Corners of a face, ascending: the key by which cells share it.
    fn face_key(&self, face: CellFace) -> [u32; 4] {
        let mut key = [u32::MAX; 4];
        let corners = self.cell(face.cell as usize).kind.corner_count();
        self.face_nodes(face).take(corners).zip(&mut key).for_each(|(node, key)| *key = node);
        key.sort_unstable();
        key
    }

    /// All faces of all cells, cell by cell.
    fn all_faces(&self) -> impl Iterator<Item = CellFace> + '_ {
        self.cells().enumerate().flat_map(|(cell, found)| {
            (0..found.kind.faces().len()).map(move |face| CellFace { cell: cell as u32, face: face as u8 })
        })
    }

    /// The faces that only one cell has, in the order of the cells.
    pub fn skin(&self) -> Vec<CellFace> {
        let mut counts: HashMap<[u32; 4], u32> = HashMap::new();
        self.all_faces().for_each(|face| *counts.entry(self.face_key(face)).or_default() += 1);
        self.all_faces().filter(|face| counts[&self.face_key(*face)] == 1).collect()
    }

    /// All faces by their corners, ascending; the fourth one of a triangle is the largest number.
    ///
    /// # Errors
    /// Two faces on the same corners whose cells do not lie on different sides of them, with every third cell.
    pub fn faces_by_corners(&self) -> Result<HashMap<[u32; 4], SharedFace>, [CellFace; 2]> {
        let mut found: HashMap<[u32; 4], SharedFace> = HashMap::new();
        for face in self.all_faces() {
            let shared = found.entry(self.face_key(face)).or_insert(SharedFace { first: face, second: None });
            if shared.first == face {
                continue;
            }
            match shared.second {
                None if self.are_opposite(shared.first, face) => shared.second = Some(face),
                Some(second) if self.are_opposite(shared.first, face) => return Err([second, face]),
                _ => return Err([shared.first, face]),
            }
        }
        Ok(found)
    }

    /// Whether the corners of two faces, each counterclockwise seen from outside of its cell, go round in opposite
    /// ways.
    fn are_opposite(&self, one: CellFace, other: CellFace) -> bool {
        let corners = |face: CellFace| {
            let (mut nodes, corners) = self.face_with_corners(face);
            nodes.truncate(corners);
            nodes
        };
        let (one, mut other) = (corners(one), corners(other));
        other.reverse();
        match other.iter().position(|node| *node == one[0]) {
            Some(start) => {
                other.rotate_left(start);
                one == other
            }
            None => false,
        }
    }

    /// Cells on the other side of the faces of every cell.
    pub(crate) fn neighbours(&self) -> Vec<Vec<u32>> {
        let mut first: HashMap<[u32; 4], u32> = HashMap::new();
        let mut neighbours = vec![Vec::new(); self.cell_count()];
        for face in self.all_faces() {
            if let Some(other) = first.insert(self.face_key(face), face.cell).filter(|other| *other != face.cell) {
                neighbours[face.cell as usize].push(other);
                neighbours[other as usize].push(face.cell);
            }
        }
        neighbours
    }

    /// The parts of the mesh that hang together by faces, each as its cells in ascending order; by size, largest first.
    pub fn parts(&self) -> Vec<Vec<u32>> {
        let mut parts = connected(&self.neighbours(), &(0..self.cell_count() as u32).collect::<Vec<_>>());
        parts.sort_by_key(|part| (std::cmp::Reverse(part.len()), part[0]));
        parts
    }
}

/// The parts of some cells that hang together by faces, each ascending.
pub(crate) fn connected(neighbours: &[Vec<u32>], cells: &[u32]) -> Vec<Vec<u32>> {
    let mut open: HashMap<u32, bool> = cells.iter().map(|&cell| (cell, true)).collect();
    let mut parts = Vec::new();
    for &start in cells {
        if open.insert(start, false) != Some(true) {
            continue;
        }
        let (mut part, mut next) = (vec![start], 0);
        while next < part.len() {
            for &other in &neighbours[part[next] as usize] {
                if let Some(open) = open.get_mut(&other).filter(|open| **open) {
                    *open = false;
                    part.push(other);
                }
            }
            next += 1;
        }
        part.sort_unstable();
        parts.push(part);
    }
    parts
}
