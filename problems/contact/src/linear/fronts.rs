//! The fronts of a matrix: its supernodes as a tree, and where its entries are in them.

use crate::linear::symmetric::LowerPattern;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};
use std::ops::Range;

/// The supernodes of a symbolic factor in postorder: those of a subtree follow each other, its root is the last.
#[derive(Debug)]
pub(super) struct Fronts {
    analysis: SymbolicCholesky<usize>,
    /// Children of every supernode, ascending.
    pub(super) children: Vec<Vec<u32>>,
    /// Supernodes without a parent, ascending.
    pub(super) roots: Vec<u32>,
    /// The first supernode in the subtree of each.
    pub(super) first: Vec<usize>,
    /// Operations of the subtree of each, about.
    pub(super) work: Vec<f64>,
    /// Where the entries of A begin, per column of L.
    starts: Vec<usize>,
    /// Row in the front, place among the values of A.
    entries: Vec<(u32, u32)>,
}

/// An elimination order whose supernodes are no postorder.
pub(super) struct NoPostorder {
    /// An order of equal fill that is a postorder: `order[new] = old`.
    pub(super) order: Vec<usize>,
}

impl Fronts {
    /// The fronts of a pattern whose elimination order is `order[new] = old`.
    pub(super) fn new(
        analysis: SymbolicCholesky<usize>,
        pattern: &LowerPattern,
        order: &[usize],
    ) -> Result<Self, NoPostorder> {
        let symbolic = supernodal(&analysis);
        let count = symbolic.n_supernodes();
        let mut owner = vec![0_u32; order.len()];
        let columns = |index: usize| symbolic.supernode_begin()[index]..symbolic.supernode_end()[index];
        (0..count).for_each(|index| owner[columns(index)].fill(index as u32));
        let (mut children, mut roots) = (vec![Vec::new(); count], Vec::new());
        for index in 0..count {
            match symbolic.supernode(index).pattern().first() {
                Some(&row) => children[owner[row] as usize].push(index as u32),
                None => roots.push(index as u32),
            }
        }
        let (mut first, mut work, mut is_postorder) = ((0..count).collect::<Vec<usize>>(), vec![0.0; count], true);
        for index in 0..count {
            let mut next = index;
            for &child in children[index].iter().rev() {
                is_postorder &= child as usize + 1 == next;
                next = first[child as usize];
                work[index] += work[child as usize];
            }
            first[index] = next;
            let (width, below) = (columns(index).len() as f64, symbolic.supernode(index).pattern().len() as f64);
            work[index] += width * (width * width / 3.0 + width * below + below * below);
        }
        if !is_postorder {
            return Err(NoPostorder { order: postorder(&children, &roots, columns, order) });
        }
        let (starts, entries) = entries(symbolic, pattern, order, &owner);
        Ok(Self { analysis, children, roots, first, work, starts, entries })
    }

    /// The supernodes and the layout of the values of L: panel by panel, by columns, the block on the diagonal first.
    pub(super) fn symbolic(&self) -> &SymbolicSupernodalCholesky<usize> {
        supernodal(&self.analysis)
    }

    /// The analysis, which has the elimination order as well.
    pub(super) fn analysis(&self) -> &SymbolicCholesky<usize> {
        &self.analysis
    }

    /// The columns of a supernode.
    pub(super) fn columns(&self, supernode: usize) -> Range<usize> {
        self.symbolic().supernode_begin()[supernode]..self.symbolic().supernode_end()[supernode]
    }

    /// Number of columns of L.
    pub(super) fn column_count(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn width(&self, supernode: usize) -> usize {
        self.columns(supernode).len()
    }

    /// Rows of the panel of a supernode.
    pub(super) fn height(&self, supernode: usize) -> usize {
        self.width(supernode) + self.pattern(supernode).len()
    }

    /// The rows below a supernode, ascending.
    pub(super) fn pattern(&self, supernode: usize) -> &[usize] {
        self.symbolic().supernode(supernode).pattern()
    }

    /// Number of values of the panel of a supernode.
    pub(super) fn panel_size(&self, supernode: usize) -> usize {
        self.width(supernode) * self.height(supernode)
    }

    /// Number of values of all panels of the subtree of a supernode.
    pub(super) fn size(&self, root: u32) -> usize {
        let starts = self.symbolic().col_ptr_for_val();
        starts[root as usize + 1] - starts[self.first[root as usize]]
    }

    /// The entries of A in a column of L: row in the front, place among the values of A.
    pub(super) fn entries(&self, column: usize) -> &[(u32, u32)] {
        &self.entries[self.starts[column]..self.starts[column + 1]]
    }
}

fn supernodal(analysis: &SymbolicCholesky<usize>) -> &SymbolicSupernodalCholesky<usize> {
    match analysis.raw() {
        SymbolicCholeskyRaw::Supernodal(symbolic) => symbolic,
        SymbolicCholeskyRaw::Simplicial(_) => unreachable!("invariant: factors are forced to be supernodal"),
    }
}

/// The old indices of the columns of all supernodes in postorder.
fn postorder(
    children: &[Vec<u32>],
    roots: &[u32],
    columns: impl Fn(usize) -> Range<usize>,
    order: &[usize],
) -> Vec<usize> {
    let mut found = Vec::with_capacity(order.len());
    let mut open: Vec<(u32, bool)> = roots.iter().rev().map(|&root| (root, false)).collect();
    while let Some((index, seen)) = open.pop() {
        if seen {
            found.extend(columns(index as usize).map(|column| order[column]));
        } else {
            open.push((index, true));
            open.extend(children[index as usize].iter().rev().map(|&child| (child, false)));
        }
    }
    found
}

/// Where the entries of a matrix are in the fronts, by columns of L.
fn entries(
    symbolic: &SymbolicSupernodalCholesky<usize>,
    pattern: &LowerPattern,
    order: &[usize],
    owner: &[u32],
) -> (Vec<usize>, Vec<(u32, u32)>) {
    let mut places = vec![0_usize; order.len()];
    order.iter().enumerate().for_each(|(new, &old)| places[old] = new);
    let each = |work: &mut dyn FnMut(usize, usize, usize)| {
        for column in 0..order.len() {
            for place in pattern.starts()[column]..pattern.starts()[column + 1] {
                let (a, b) = (places[column], places[pattern.rows()[place]]);
                work(a.min(b), a.max(b), place);
            }
        }
    };
    let mut starts = vec![0_usize; order.len() + 1];
    each(&mut |column, _, _| starts[column + 1] += 1);
    (0..order.len()).for_each(|column| starts[column + 1] += starts[column]);
    let (mut next, mut entries) = (starts.clone(), vec![(0, 0); pattern.entry_count()]);
    each(&mut |column, row, place| {
        let supernode = owner[column] as usize;
        let (begin, end) = (symbolic.supernode_begin()[supernode], symbolic.supernode_end()[supernode]);
        let below = || symbolic.supernode(supernode).pattern().binary_search(&row);
        let own =
            if row < end { row - begin } else { end - begin + below().expect("invariant: L has the entries of A") };
        entries[next[column]] = (own as u32, place as u32);
        next[column] += 1;
    });
    (starts, entries)
}
