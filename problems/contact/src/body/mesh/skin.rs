//! What is seen from the topology of a mesh: its skin, connected parts, neighbours of cells.

use crate::body::mesh::{CellFace, Mesh};
use std::collections::HashMap;

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

    /// The skin by the corners of its faces, ascending; the fourth one of a triangle is the largest number.
    pub fn skin_by_corners(&self) -> HashMap<[u32; 4], CellFace> {
        self.skin().into_iter().map(|face| (self.face_key(face), face)).collect()
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
