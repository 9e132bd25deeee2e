//! Division of a mesh into pieces that hang together by faces.
//!
//! ```text
//! cells are halved across their longest extent, again and again, until there are as many pieces as wanted;
//! a piece that falls apart becomes several; a part that is too small joins the neighbour with which it shares most faces
//! ```
//! Total FETI needs pieces that hang together by faces: a piece that hangs on an edge has rigid motions beyond its six.

use crate::body::mesh::Mesh;
use crate::body::mesh::skin::connected;
use crate::linear::ordering::longest_axis;
use std::collections::BTreeMap;

/// Share of the mean size of a piece below which a part joins a neighbour.
const SMALL: f64 = 0.25;

impl Mesh {
    /// The piece of every cell for about so many pieces, numbered along the division: neighbours in number are
    /// neighbours in the body.
    pub fn partitioned(&self, count: usize) -> Vec<u32> {
        let centres: Vec<[f64; 3]> = (0..self.cell_count()).map(|cell| self.centre(cell, self.nodes())).collect();
        let neighbours = self.neighbours();
        let mut pieces = Vec::new();
        let mut cells: Vec<u32> = (0..self.cell_count() as u32).collect();
        halve(&centres, &mut cells, count.clamp(1, self.cell_count()), &mut pieces);
        let parts: Vec<Vec<u32>> = pieces.iter().flat_map(|piece| connected(&neighbours, piece)).collect();
        let mut piece_of = vec![0_u32; self.cell_count()];
        for (number, part) in parts.iter().enumerate() {
            part.iter().for_each(|&cell| piece_of[cell as usize] = number as u32);
        }
        let least = (SMALL * self.cell_count() as f64 / count as f64) as usize;
        join_small(&parts, &neighbours, least, &mut piece_of);
        renumber(&mut piece_of);
        piece_of
    }
}

/// Halves cells until every part is a piece.
fn halve(centres: &[[f64; 3]], cells: &mut [u32], count: usize, pieces: &mut Vec<Vec<u32>>) {
    if count <= 1 || cells.len() <= 1 {
        pieces.push(cells.to_vec());
        return;
    }
    let axis = longest_axis(cells.iter().map(|&cell| centres[cell as usize]));
    cells.sort_unstable_by(|&a, &b| centres[a as usize][axis].total_cmp(&centres[b as usize][axis]).then(a.cmp(&b)));
    let left = count / 2;
    let (first, second) = cells.split_at_mut(cells.len() * left / count);
    halve(centres, first, left, pieces);
    halve(centres, second, count - left, pieces);
}

/// Lets parts with fewer cells than `least` join the piece with which they share most faces, smallest parts first.
fn join_small(parts: &[Vec<u32>], neighbours: &[Vec<u32>], least: usize, piece_of: &mut [u32]) {
    let mut sizes: Vec<usize> = parts.iter().map(Vec::len).collect();
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by_key(|&part| (parts[part].len(), part));
    for part in order {
        if sizes[part] == 0 || sizes[part] >= least || parts[part].len() >= least {
            continue;
        }
        let mut shared: BTreeMap<u32, usize> = BTreeMap::new();
        let own = piece_of[parts[part][0] as usize];
        for &cell in &parts[part] {
            for &other in &neighbours[cell as usize] {
                if piece_of[other as usize] != own {
                    *shared.entry(piece_of[other as usize]).or_default() += 1;
                }
            }
        }
        if let Some((&other, _)) = shared.iter().max_by_key(|(piece, count)| (**count, std::cmp::Reverse(**piece))) {
            sizes[other as usize] += sizes[own as usize];
            sizes[own as usize] = 0;
            piece_of.iter_mut().filter(|piece| **piece == own).for_each(|piece| *piece = other);
        }
    }
}

/// Numbers the pieces from 0 on without gap, in their order.
fn renumber(piece_of: &mut [u32]) {
    let mut numbers: Vec<u32> = piece_of.to_vec();
    numbers.sort_unstable();
    numbers.dedup();
    for piece in piece_of {
        *piece = numbers.binary_search(piece).unwrap_or(0) as u32;
    }
}
