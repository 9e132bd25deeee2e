//! Multifrontal Cholesky factorisation: every supernode is eliminated from a dense front, and hands what it changes of
//! later rows to its parent.
//!
//! ```text
//! front of a supernode s, rows p below it:     F = [F_ss ·; F_ps F_pp],   F: entries of A + updates of the children
//! F_ss = L_ss L_ssᵀ,   L_ps = F_ps L_ss⁻ᵀ,     update = F_pp − L_ps L_psᵀ
//! border rows B, never eliminated:             [A Bᵀ; B 0]  →  update of the roots = −B A⁻¹ Bᵀ
//! ```
//! Subtrees are factored on several threads, and so are tiles of large fronts. Subtrees, tiles and the order of all
//! sums are those of the matrix, so that the bits of a factor do not depend on the number of threads.

use crate::linear::border::Border;
use crate::linear::fronts::Fronts;
use crate::linear::parallel;
use crate::linear::triangle::{TILE, Triangle};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as matmul_triangular};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use std::ops::Range;

/// What is below is the work of one thread.
const SEQUENTIAL: Par = Par::Seq;
/// Operations of a subtree, or of a front, from which its parts are worth several threads.
const WORTH_THREADS: f64 = 2e7;
/// Entries of a front from which its assembly is worth several threads.
const ENTRIES_WORTH_THREADS: f64 = 1e6;
/// Rows that are solved at once.
const ROWS: usize = 768;

/// A front that is not positive definite.
#[derive(Debug)]
pub(super) struct NotPositiveDefinite;

/// What a front changes of later rows: over the rows below the front, then the border.
struct Update {
    supernode: usize,
    values: Triangle,
}

/// The data of one factorisation.
pub(super) struct Elimination<'a> {
    pub(super) fronts: &'a Fronts,
    pub(super) matrix: &'a [f64],
    pub(super) border: &'a Border,
}

impl Elimination<'_> {
    /// Writes the values of L; returns −B A⁻¹ Bᵀ.
    pub(super) fn factorize(&self, values: &mut [f64]) -> Result<Triangle, NotPositiveDefinite> {
        let mut updates = self.siblings(&self.fronts.roots, values)?;
        if updates.len() == 1 && updates[0].values.size() == self.border.count() {
            return Ok(updates.swap_remove(0).values);
        }
        let mut whole = Triangle::zero(self.border.count());
        for update in updates {
            let rows = self.border.of(update.supernode);
            for (place, &column) in rows.iter().enumerate() {
                let target = whole.column_mut(column as usize);
                let values = rows[place..].iter().zip(update.values.column(place));
                values.for_each(|(&row, value)| target[(row - column) as usize] += value);
            }
        }
        Ok(whole)
    }

    /// The updates of neighbouring subtrees, given by their roots; `values`: those of their columns.
    fn siblings(&self, roots: &[u32], values: &mut [f64]) -> Result<Vec<Update>, NotPositiveDefinite> {
        let work = |roots: &[u32]| roots.iter().map(|&root| self.fronts.work[root as usize]).sum::<f64>();
        match roots {
            [] => Ok(Vec::new()),
            [root] => Ok(vec![self.subtree(*root as usize, values)?]),
            _ => {
                let (first, second) = roots.split_at(self.halfway(roots));
                let (own, others) = values.split_at_mut(first.iter().map(|&root| self.fronts.size(root)).sum());
                let is_worth_it = work(first).min(work(second)) > WORTH_THREADS;
                let (found, rest) =
                    parallel::join(is_worth_it, || self.siblings(first, own), || self.siblings(second, others));
                let mut found = found?;
                found.extend(rest?);
                Ok(found)
            }
        }
    }

    /// The number of first roots with about half of the work of all, at least 1 and less than all.
    fn halfway(&self, roots: &[u32]) -> usize {
        let work = |root: &u32| self.fronts.work[*root as usize];
        let half = 0.5 * roots.iter().map(work).sum::<f64>();
        let mut sum = 0.0;
        let before = roots.iter().take_while(|root| {
            sum += work(root);
            sum <= half
        });
        before.count().clamp(1, roots.len() - 1)
    }

    /// The update of a subtree.
    fn subtree(&self, root: usize, values: &mut [f64]) -> Result<Update, NotPositiveDefinite> {
        if self.fronts.work[root] > WORTH_THREADS {
            let panel = values.len() - self.fronts.panel_size(root);
            let (below, panel) = values.split_at_mut(panel);
            let updates = self.siblings(&self.fronts.children[root], below)?;
            return self.front(root, updates, panel);
        }
        let mut open: Vec<Update> = Vec::new();
        let mut rest = values;
        for supernode in self.fronts.first[root]..=root {
            let (panel, others) = rest.split_at_mut(self.fronts.panel_size(supernode));
            let updates = open.split_off(open.len() - self.fronts.children[supernode].len());
            open.push(self.front(supernode, updates, panel)?);
            rest = others;
        }
        Ok(open.pop().expect("invariant: a subtree has its root"))
    }

    /// Eliminates one supernode, given the updates of its children.
    fn front(&self, supernode: usize, updates: Vec<Update>, panel: &mut [f64]) -> Result<Update, NotPositiveDefinite> {
        let (width, inner) = (self.fronts.width(supernode), self.fronts.height(supernode));
        let border = self.border.of(supernode);
        let height = inner + border.len();
        let mut own = Vec::new();
        let front: &mut [f64] = if border.is_empty() {
            &mut *panel
        } else {
            own = vec![0.0; height * width];
            &mut own
        };
        let mut update = Update { supernode, values: Triangle::zero(height - width) };
        let places: Vec<Vec<u32>> = updates.iter().map(|child| self.places(child.supernode, supernode)).collect();
        let children: Vec<Child<'_>> =
            updates.iter().zip(&places).map(|(update, places)| Child { values: &update.values, places }).collect();
        let is_large = (height * height) as f64 > ENTRIES_WORTH_THREADS;
        parts(is_large, front.chunks_mut(TILE * height).collect(), &|index, columns| {
            let first = index * TILE;
            self.assemble(supernode, first, columns, height);
            for child in &children {
                child.add_to(first..first + columns.len() / height, columns, height, 0);
            }
        });
        parts(is_large, update.values.tiles(), &|index, columns| {
            let (first, rows) = (width + index * TILE, height - width - index * TILE);
            for child in &children {
                child.add_to(first..first + columns.len() / rows, columns, rows, first);
            }
        });
        drop(updates);
        eliminate(MatMut::from_column_major_slice_mut(front, height, width), &mut update.values)?;
        if !border.is_empty() {
            for (target, column) in panel.chunks_exact_mut(inner).zip(own.chunks_exact(height)) {
                target.copy_from_slice(&column[..inner]);
            }
        }
        Ok(update)
    }

    /// The entries of A and of the border in some columns of a front.
    fn assemble(&self, supernode: usize, first: usize, front: &mut [f64], height: usize) {
        front.fill(0.0);
        let inner = self.fronts.height(supernode);
        let rows = self.border.of(supernode);
        for (column, target) in self.fronts.columns(supernode).skip(first).zip(front.chunks_exact_mut(height)) {
            for &(row, place) in self.fronts.entries(column) {
                target[row as usize] += self.matrix[place as usize];
            }
            for (row, value) in self.border.column(column) {
                let place = rows.binary_search(row).expect("invariant: a front has the border of its columns");
                target[inner + place] += value;
            }
        }
    }

    /// Where the rows of the update of a child are among those of the front of its parent.
    fn places(&self, child: usize, parent: usize) -> Vec<u32> {
        let columns = self.fronts.columns(parent);
        let (begin, width, inner) = (columns.start, columns.len(), self.fronts.height(parent));
        let (own, mut next) = (self.fronts.pattern(parent), 0);
        let place = |&row: &usize| {
            if row < columns.end {
                return (row - begin) as u32;
            }
            while own[next] != row {
                next += 1;
            }
            (width + next) as u32
        };
        let mut places: Vec<u32> = self.fronts.pattern(child).iter().map(place).collect();
        let (own, mut next) = (self.border.of(parent), 0);
        places.extend(self.border.of(child).iter().map(|row| {
            while own[next] != *row {
                next += 1;
            }
            (inner + next) as u32
        }));
        places
    }
}

/// What a child changes of a front.
struct Child<'a> {
    values: &'a Triangle,
    /// Its rows among those of the front, ascending.
    places: &'a [u32],
}

impl Child<'_> {
    /// Adds its part of some columns of the front; `target` holds them, as many rows each, from row `from` on.
    fn add_to(&self, columns: Range<usize>, target: &mut [f64], rows: usize, from: usize) {
        let place = |column: usize| self.places.partition_point(|&place| (place as usize) < column);
        for own in place(columns.start)..place(columns.end) {
            let target = &mut target[(self.places[own] as usize - columns.start) * rows..][..rows];
            for (&row, value) in self.places[own..].iter().zip(self.values.column(own)) {
                target[row as usize - from] += value;
            }
        }
    }
}

/// Does work on every part, given its number; on several threads where that is worth it.
fn parts(is_worth_it: bool, parts: Vec<&mut [f64]>, work: &(dyn Fn(usize, &mut [f64]) + Sync)) {
    if is_worth_it {
        parallel::for_parts(parts, work);
    } else {
        parts.into_iter().enumerate().for_each(|(index, part)| work(index, part));
    }
}

/// Eliminates the columns of a front; `update`: F_pp.
fn eliminate(front: MatMut<'_, f64>, update: &mut Triangle) -> Result<(), NotPositiveDefinite> {
    let (width, size) = (front.ncols(), update.size());
    let (mut own, mut below) = front.split_at_row_mut(width);
    let scratch = llt::factor::cholesky_in_place_scratch::<f64>(width, SEQUENTIAL, Default::default());
    let mut memory = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut memory);
    llt::factor::cholesky_in_place(own.as_mut(), Default::default(), SEQUENTIAL, stack, Default::default())
        .map_err(|_| NotPositiveDefinite)?;
    if size == 0 {
        return Ok(());
    }
    let is_large = (size * size) as f64 * width as f64 > WORTH_THREADS;
    solve_rows(own.as_ref(), below.as_mut(), is_large);
    let below = below.as_ref();
    let tile = |index: usize, tile: &mut [f64]| {
        let (first, height) = (index * TILE, size - index * TILE);
        let count = tile.len() / height;
        let (mut square, rest) = MatMut::from_column_major_slice_mut(tile, height, count).split_at_row_mut(count);
        let rows = below.subrows(first, height);
        let (own, others) = rows.split_at_row(count);
        let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
        let target = square.as_mut();
        matmul_triangular(target, lower, Accum::Add, own, full, own.transpose(), full, -1.0, SEQUENTIAL);
        matmul(rest, Accum::Add, others, own.transpose(), -1.0, SEQUENTIAL);
    };
    parts(is_large, update.tiles(), &tile);
    Ok(())
}

/// X ← X L⁻ᵀ, some rows at once.
fn solve_rows(lower: MatRef<'_, f64>, rows: MatMut<'_, f64>, on_threads: bool) {
    let count = rows.nrows();
    if count <= ROWS {
        return solve_lower_triangular_in_place(lower, rows.transpose_mut(), SEQUENTIAL);
    }
    let (first, second) = rows.split_at_row_mut(count.div_ceil(ROWS) / 2 * ROWS);
    parallel::join(on_threads, || solve_rows(lower, first, on_threads), || solve_rows(lower, second, on_threads));
}
