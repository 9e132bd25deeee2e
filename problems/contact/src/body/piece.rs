//! A part of a body with its own matrix: nodes, pattern, scatter of cell matrices, elimination order, fixing nodes.
//!
//! A piece is a subdomain of total FETI, or a whole body for direct condensation. Pieces whose cells are numbered alike
//! share pattern and symbolic factor: all subdomains of a block do.

use crate::body::elasticity::Material;
use crate::body::elasticity::packed::lower_start;
use crate::body::mesh::{Mesh, narrow};
use crate::body::{MOTIONS, Solid, rigid_motions};
use crate::error::ContactError;
use crate::linear::FactorizationError;
use crate::linear::cholesky::SymbolicFactor;
use crate::linear::ordering::nested_dissection;
use crate::linear::symmetric::LowerPattern;
use std::collections::HashMap;
use std::sync::Arc;

/// |K R| over |K| |R| that counts as rounding: some 1e-14 in ordinary bodies, more far from the origin.
const RESISTED: f64 = 1e-8;

/// A part of a body.
#[derive(Debug)]
pub struct Piece {
    /// Its cells in the mesh, ascending.
    pub cells: Vec<u32>,
    /// Its nodes, ascending: dofs 3·index + component.
    pub nodes: Vec<u32>,
    /// What it shares with pieces that are numbered alike.
    pub pattern: Arc<PiecePattern>,
}

/// What pieces share whose cells are numbered alike.
#[derive(Debug)]
pub struct PiecePattern {
    /// Lower triangle of the stiffness matrix.
    pub lower: Arc<LowerPattern>,
    /// The nodes of every cell in the piece.
    cells: LocalCells,
    /// Position of the lower entries of every cell in the value array, cell by cell.
    scatter: Vec<u32>,
    /// Three nodes that span a large triangle: enough to hold all rigid motions.
    pub fixing: [usize; 3],
    /// Points and neighbours of the nodes, for elimination orders.
    points: Vec<[f64; 3]>,
    graph: Vec<Vec<u32>>,
}

/// Patterns by the numbering of their cells.
#[derive(Debug, Default)]
pub struct Patterns(HashMap<(LocalCells, [usize; 3]), Arc<PiecePattern>>);

/// The nodes of cells in a piece.
type LocalCells = Vec<Vec<u32>>;

impl Piece {
    /// The piece of some cells of a body, ascending; patterns are shared by way of `known`.
    pub fn new(mesh: &Mesh, cells: Vec<u32>, known: &mut Patterns) -> Self {
        let mut nodes: Vec<u32> = cells.iter().flat_map(|&cell| mesh.cell(cell as usize).nodes).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: &u32| narrow(nodes.binary_search(node).expect("invariant: taken from these cells"));
        let local: LocalCells =
            cells.iter().map(|&cell| mesh.cell(cell as usize).nodes.iter().map(place).collect()).collect();
        let points: Vec<[f64; 3]> = nodes.iter().map(|&node| mesh.nodes()[node as usize]).collect();
        let fixing = fixing_nodes(&points);
        let key = (local.clone(), fixing);
        let build = || Arc::new(PiecePattern::new(local, points, fixing));
        let pattern = Arc::clone(known.0.entry(key).or_insert_with(build));
        Self { cells, nodes, pattern }
    }

    /// Number of dofs, three per node.
    pub fn dof_count(&self) -> usize {
        3 * self.nodes.len()
    }

    /// The place of a node of the mesh among the nodes of the piece.
    pub fn local(&self, node: u32) -> Option<usize> {
        self.nodes.binary_search(&node).ok()
    }

    /// Positions of its nodes.
    pub fn positions<'a>(&'a self, positions: &'a [[f64; 3]]) -> impl Iterator<Item = [f64; 3]> + 'a {
        self.nodes.iter().map(|&node| positions[node as usize])
    }

    /// Values of the stiffness matrix over [`PiecePattern::lower`], for the materials of a body or others in their
    /// place.
    pub fn assemble(
        &self,
        solid: &Solid,
        positions: &[[f64; 3]],
        material: impl Fn(&Material) -> Material,
    ) -> Vec<f64> {
        let mut values = vec![0.0; self.pattern.lower.entry_count()];
        let mut scatter = self.pattern.scatter.iter();
        for &cell in &self.cells {
            let cell = cell as usize;
            let matrix = solid.mesh.cell_nodes(cell, positions).stiffness(&material(solid.material(cell)));
            for (entry, &place) in matrix.iter().zip(scatter.by_ref().take(matrix.len())) {
                values[place as usize] += entry;
            }
        }
        values
    }

    /// Checks that a stiffness matrix of the piece, over [`PiecePattern::lower`], does not resist its rigid motions:
    /// what solvers take for the kernel has to be one.
    ///
    /// # Errors
    /// [`ContactError::ResistsRigidMotions`] with |K R| over |K| |R|, in the largest entries.
    pub(crate) fn check_kernel(
        &self,
        name: &str,
        positions: &[[f64; 3]],
        stiffness: &[f64],
    ) -> Result<(), ContactError> {
        let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let [mut low, mut high] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for position in self.positions(positions) {
            for (axis, x) in position.into_iter().enumerate() {
                (low[axis], high[axis]) = (low[axis].min(x), high[axis].max(x));
            }
        }
        let centre: [f64; 3] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
        let length = (0..3).map(|axis| 0.5 * (high[axis] - low[axis])).fold(0.0, f64::max);
        let motions: Vec<_> = self.positions(positions).map(|point| rigid_motions(point, centre, length)).collect();
        let mut image = vec![0.0; self.dof_count()];
        let mut resisted = 0.0_f64;
        for mode in 0..MOTIONS {
            let motion: Vec<f64> = motions.iter().flat_map(|motions| motions[mode]).collect();
            self.pattern.lower.multiply(stiffness, &motion, &mut image);
            resisted = resisted.max(largest(&image));
        }
        let ratio = resisted / largest(stiffness);
        match ratio <= RESISTED {
            true => Ok(()),
            false => Err(ContactError::ResistsRigidMotions { body: name.to_owned(), ratio, allowed: RESISTED }),
        }
    }

    /// Displacements of all nodes of a cell, by its place among the cells, from those of the piece.
    pub fn cell_values(&self, index: usize, values: &[f64], cell_values: &mut Vec<f64>) {
        cell_values.clear();
        let nodes = &self.pattern.cells[index];
        nodes.iter().for_each(|&place| cell_values.extend_from_slice(&values[3 * place as usize..][..3]));
    }

    /// Adds forces on all nodes of a cell to those of the piece.
    pub fn add_cell_forces(&self, index: usize, forces: &[f64], sum: &mut [f64]) {
        for (&place, force) in self.pattern.cells[index].iter().zip(forces.as_chunks::<3>().0) {
            (0..3).for_each(|axis| sum[3 * place as usize + axis] += force[axis]);
        }
    }

    /// Adds a force on a node of the mesh to the forces on the piece.
    pub fn add_force(&self, node: u32, force: [f64; 3], sum: &mut [f64]) {
        let place = self.local(node).expect("invariant: cells of the piece have this node");
        (0..3).for_each(|axis| sum[3 * place + axis] += force[axis]);
    }

    /// The value of a field over the piece at a node of the mesh.
    pub fn value_at(&self, node: u32, values: &[f64]) -> [f64; 3] {
        let place = self.local(node).expect("invariant: cells of the piece have this node");
        [values[3 * place], values[3 * place + 1], values[3 * place + 2]]
    }
}

impl PiecePattern {
    fn new(cells: LocalCells, points: Vec<[f64; 3]>, fixing: [usize; 3]) -> Self {
        let mut graph = vec![Vec::new(); points.len()];
        for nodes in &cells {
            nodes.iter().for_each(|&node| graph[node as usize].extend_from_slice(nodes));
        }
        fixing.iter().for_each(|&node| graph[node].extend(fixing.map(narrow)));
        for (node, neighbours) in graph.iter_mut().enumerate() {
            neighbours.sort_unstable();
            neighbours.dedup();
            neighbours.retain(|other| *other as usize != node);
        }
        let lower = Arc::new(lower_pattern(&graph));
        let scatter = cells.iter().flat_map(|cell| scatter(cell, &lower)).collect();
        Self { lower, cells, scatter, fixing, points, graph }
    }

    /// Mean of the diagonal of a matrix, given by its values.
    pub(crate) fn mean_diagonal(&self, values: &[f64]) -> f64 {
        let (starts, dimension) = (self.lower.starts(), self.lower.dimension());
        (0..dimension).map(|column| values[starts[column]]).sum::<f64>() / dimension as f64
    }

    /// Elimination order of the dofs by nested dissection, with those of `last` nodes at the end.
    pub fn elimination_order(&self, last: &[usize]) -> Vec<usize> {
        let mut chained;
        let graph = if last.len() > 1 {
            // A chain keeps the last nodes in place in the elimination tree, whatever fill couples them.
            chained = self.graph.clone();
            for pair in last.windows(2) {
                chained[pair[0]].push(narrow(pair[1]));
                chained[pair[1]].push(narrow(pair[0]));
            }
            &chained
        } else {
            &self.graph
        };
        let nodes = nested_dissection(&self.points, graph, last);
        nodes.into_iter().flat_map(|node| 3 * node..3 * node + 3).collect()
    }

    /// Symbolic factor for [`Self::elimination_order`].
    ///
    /// # Errors
    /// [`FactorizationError`] when the analysis fails.
    pub fn symbolic(&self, last: &[usize]) -> Result<Arc<SymbolicFactor>, FactorizationError> {
        Ok(Arc::new(SymbolicFactor::new(Arc::clone(&self.lower), self.elimination_order(last))?))
    }
}

/// The lower triangle over three dofs per node.
fn lower_pattern(graph: &[Vec<u32>]) -> LowerPattern {
    let mut columns = Vec::with_capacity(3 * graph.len());
    for (node, neighbours) in graph.iter().enumerate() {
        let later = neighbours.iter().map(|&other| other as usize).filter(|&other| other > node);
        let rows: Vec<usize> = std::iter::once(node).chain(later).flat_map(|row| 3 * row..3 * row + 3).collect();
        columns.extend((3 * node..3 * node + 3).map(|column| rows[column - 3 * node..].to_vec()));
    }
    LowerPattern::from_columns(columns)
}

/// Positions of the lower entries of the matrix of a cell.
fn scatter(cell: &[u32], lower: &LowerPattern) -> Vec<u32> {
    let dof = |dof: usize| 3 * cell[dof / 3] as usize + dof % 3;
    let size = 3 * cell.len();
    let mut positions = Vec::with_capacity(lower_start(size));
    for row in 0..size {
        for column in 0..=row {
            let (row, column) = (dof(row), dof(column));
            let position = lower.position(row.max(column), row.min(column));
            positions.push(narrow(position.expect("invariant: dofs of a cell are coupled")));
        }
    }
    positions
}

/// Three of some points that span a large triangle. Points that are as far as others up to rounding count as equal, so
/// that pieces of the same form have the same ones.
fn fixing_nodes(points: &[[f64; 3]]) -> [usize; 3] {
    let difference = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|axis| a[axis] - b[axis]) };
    let square = |a: [f64; 3]| a.iter().map(|x| x * x).sum::<f64>();
    let cross = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
    };
    let farthest = |measure: &dyn Fn([f64; 3]) -> f64| {
        let largest = points.iter().map(|point| measure(*point)).fold(0.0, f64::max);
        points.iter().position(|point| measure(*point) >= (1.0 - 1e-9) * largest).unwrap_or(0)
    };
    let count = points.len() as f64;
    let centre: [f64; 3] = std::array::from_fn(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / count);
    let first = farthest(&|point| square(difference(point, centre)));
    let second = farthest(&|point| square(difference(point, points[first])));
    let along = difference(points[second], points[first]);
    let third = farthest(&|point| square(cross(along, difference(point, points[first]))));
    [first, second, third]
}
