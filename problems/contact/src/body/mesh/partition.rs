//! Division of a mesh into pieces that hang together by faces.
//!
//! ```text
//! cells are halved across their longest extent, again and again, until there are as many pieces as wanted;
//! cells change sides of a cut as long as that leaves fewer faces in it (Fiduccia and Mattheyses);
//! a piece that falls apart becomes several; a part that is too small joins the neighbour with which it shares most faces
//! ```
//! Total FETI needs pieces that hang together by faces: a piece that hangs on an edge has rigid motions beyond its six.

use crate::body::mesh::Mesh;
use crate::body::mesh::skin::connected;
use crate::linear::ordering::longest_axis;
use std::collections::{BTreeMap, BinaryHeap, HashMap, HashSet};
use std::ops::RangeInclusive;

/// Share of the mean size of a piece below which a part joins a neighbour.
const SMALL: f64 = 0.25;
/// By which share of the cells of a cut its sides may differ from their sizes.
const UNEQUAL: f64 = 0.03;
/// Passes of moves across a cut.
const PASSES: usize = 8;
/// Moves that leave more faces in a cut than the best one before, after which a pass ends: a share of the cells.
const PATIENCE: f64 = 0.05;

impl Mesh {
    /// The piece of every cell for about so many pieces, numbered along the division: neighbours in number are
    /// neighbours in the body.
    pub fn partitioned(&self, count: usize) -> Vec<u32> {
        let centres: Vec<[f64; 3]> = (0..self.cell_count()).map(|cell| self.centre(cell, self.nodes())).collect();
        let neighbours = self.neighbours();
        let mut pieces = Vec::new();
        let mut cells: Vec<u32> = (0..self.cell_count() as u32).collect();
        Division { centres: &centres, neighbours: &neighbours }.halve(
            &mut cells,
            count.clamp(1, self.cell_count()),
            &mut pieces,
        );
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

/// Cells with their centres and the cells across their faces.
struct Division<'a> {
    centres: &'a [[f64; 3]],
    neighbours: &'a [Vec<u32>],
}

impl Division<'_> {
    /// Halves cells until every part is a piece.
    fn halve(&self, cells: &mut [u32], count: usize, pieces: &mut Vec<Vec<u32>>) {
        if count <= 1 || cells.len() <= 1 {
            pieces.push(cells.to_vec());
            return;
        }
        let centres = self.centres;
        let axis = longest_axis(cells.iter().map(|&cell| centres[cell as usize]));
        let along = |cell: u32| centres[cell as usize][axis];
        cells.sort_unstable_by(|&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
        let left = count / 2;
        let mut cut = Cut::new(self.neighbours, cells, cells.len() * left / count);
        cut.refine();
        let size = cut.first;
        // Stable, so that each side keeps its order.
        cells.sort_by_key(|cell| cut.is_second[cell]);
        let (first, second) = cells.split_at_mut(size);
        self.halve(first, left, pieces);
        self.halve(second, count - left, pieces);
    }
}

/// Two sides of some cells.
struct Cut<'a> {
    neighbours: &'a [Vec<u32>],
    /// The side of every cell.
    is_second: HashMap<u32, bool>,
    /// Cells of the first side.
    first: usize,
    /// Fewest and most of them.
    allowed: RangeInclusive<usize>,
}

impl<'a> Cut<'a> {
    /// The first `first` cells on one side, the others on the other one.
    fn new(neighbours: &'a [Vec<u32>], cells: &[u32], first: usize) -> Self {
        let is_second = cells.iter().zip(0..).map(|(&cell, place)| (cell, place >= first)).collect();
        let room = (UNEQUAL * first.min(cells.len() - first) as f64) as usize;
        Self { neighbours, is_second, first, allowed: first - room..=first + room }
    }

    /// Faces that leave the cut, less those that enter it, when a cell changes sides.
    fn gain(&self, cell: u32) -> i64 {
        let own = self.is_second[&cell];
        let sides = self.neighbours[cell as usize].iter().filter_map(|other| self.is_second.get(other));
        sides.map(|side| if *side == own { -1 } else { 1 }).sum()
    }

    fn change(&mut self, cell: u32) {
        if let Some(side) = self.is_second.get_mut(&cell) {
            *side = !*side;
            self.first = if *side { self.first - 1 } else { self.first + 1 };
        }
    }

    /// Passes of moves until one brings nothing.
    fn refine(&mut self) {
        (0..PASSES).take_while(|_| self.pass() > 0).for_each(drop);
    }

    /// One pass of moves, each cell once, in the order of their gains; returns by how many faces the cut is smaller.
    fn pass(&mut self) -> i64 {
        let touches = |cell: u32| {
            let own = self.is_second[&cell];
            self.neighbours[cell as usize]
                .iter()
                .any(|other| self.is_second.get(other).is_some_and(|side| *side != own))
        };
        let near: Vec<u32> = self.is_second.keys().copied().filter(|&cell| touches(cell)).collect();
        let mut moves: BinaryHeap<(i64, u32)> = near.iter().map(|&cell| (self.gain(cell), cell)).collect();
        let patience = (PATIENCE * self.is_second.len() as f64) as usize;
        let (mut moved, mut seen) = (Vec::new(), HashSet::new());
        let (mut sum, mut best, mut kept) = (0, 0, 0);
        while let Some((gain, cell)) = moves.pop() {
            if seen.contains(&cell) || self.gain(cell) != gain {
                continue;
            }
            let first = if self.is_second[&cell] { self.first + 1 } else { self.first - 1 };
            if !self.allowed.contains(&first) {
                continue;
            }
            self.change(cell);
            seen.insert(cell);
            moved.push(cell);
            sum += gain;
            if sum > best {
                (best, kept) = (sum, moved.len());
            } else if moved.len() > kept + patience {
                break;
            }
            for &other in self.neighbours[cell as usize].iter().filter(|&other| self.is_second.contains_key(other)) {
                moves.push((self.gain(other), other));
            }
        }
        moved.drain(kept..).rev().for_each(|cell| self.change(cell));
        best
    }
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
