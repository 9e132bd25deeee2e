//! The linear map from controls to the positions of the nodes of all bodies.
//!
//! ```text
//! x(α) = x₀ + N α,     sensitivities of α = Nᵀ (sensitivities of x),     velocities x′ = N α′
//! ```
//! Nodes are counted through all bodies, in the order of the scene, and so are controls; middles of edges of curved
//! faces follow the nodes of all bodies.

use crate::linear::csr::Csr;
use std::ops::Range;
use std::sync::Arc;

/// Positions of the nodes of all bodies, mm.
pub type Positions = Vec<Arc<Vec<[f64; 3]>>>;

/// x₀ and N of one body, with controls of its own: of its nodes, then of the middles of edges of curved faces.
#[derive(Debug, Clone)]
pub(crate) struct BodyMap {
    /// Positions for controls 0, mm.
    pub base: Vec<[f64; 3]>,
    /// How many of them, the last ones, are middles of edges.
    pub middles: usize,
    pub controls: usize,
    /// Rows of N as (control, value), three per node; none where no control moves the body.
    pub rows: Vec<Vec<(usize, f64)>>,
}

impl BodyMap {
    /// A row of N: how a component of the position of a node depends on the controls.
    pub(crate) fn row(&self, node: u32, axis: usize) -> &[(usize, f64)] {
        self.rows.get(3 * node as usize + axis).map_or(&[], Vec::as_slice)
    }
}

/// x₀ and N of all bodies.
#[derive(Debug, Clone)]
pub struct ShapeMap {
    base: Positions,
    /// First node of every body, then their number.
    starts: Vec<usize>,
    /// First middle of every body, then the number of points.
    first_middles: Vec<usize>,
    /// Whether any control moves a node of the body.
    shaped: Vec<bool>,
    /// N by rows: 3·node + component.
    matrix: Csr,
}

impl ShapeMap {
    /// The map of some bodies.
    pub(crate) fn new(bodies: Vec<BodyMap>) -> Self {
        let (mut starts, mut base, mut shaped) = (vec![0], Vec::new(), Vec::new());
        let (mut nodes, mut middles, mut first_middles) = (Vec::new(), Vec::new(), vec![0]);
        let mut controls = 0;
        for mut body in bodies {
            let count = body.base.len() - body.middles;
            starts.push(starts[starts.len() - 1] + count);
            first_middles.push(first_middles[first_middles.len() - 1] + body.middles);
            shaped.push(body.rows.iter().any(|row| !row.is_empty()));
            body.rows.resize(3 * body.base.len(), Vec::new());
            let moved = |row: Vec<(usize, f64)>| row.into_iter().map(|(own, value)| (controls + own, value)).collect();
            let mut rows = body.rows.into_iter().map(moved);
            nodes.extend(rows.by_ref().take(3 * count));
            middles.extend(rows);
            base.push(Arc::new(body.base));
            controls += body.controls;
        }
        let last = starts[starts.len() - 1];
        first_middles.iter_mut().for_each(|first| *first += last);
        nodes.extend(middles);
        Self { base, starts, first_middles, shaped, matrix: Csr::from_rows(controls, nodes) }
    }

    /// Number of controls.
    pub fn control_count(&self) -> usize {
        self.matrix.column_count()
    }

    /// The nodes of a body among those of all bodies.
    pub fn nodes(&self, body: usize) -> Range<usize> {
        self.starts[body]..self.starts[body + 1]
    }

    /// Number of nodes of all bodies.
    pub fn node_count(&self) -> usize {
        self.starts[self.starts.len() - 1]
    }

    /// Number of points of all bodies: nodes, then middles of edges.
    pub fn point_count(&self) -> usize {
        self.first_middles[self.first_middles.len() - 1]
    }

    /// The number of a node, or of a middle after the nodes, of a body among the points of all bodies.
    pub fn number(&self, body: usize, node: u32) -> usize {
        let (own, count) = (node as usize, self.nodes(body).len());
        if own < count { self.starts[body] + own } else { self.first_middles[body] + own - count }
    }

    /// Positions of all nodes, mm.
    pub fn positions(&self, controls: &[f64]) -> Positions {
        let nodes = |(body, points): (usize, Arc<Vec<[f64; 3]>>)| first_of(&points, self.nodes(body).len());
        self.points(controls).into_iter().enumerate().map(nodes).collect()
    }

    /// Positions of all points, mm: per body its nodes, then the middles of edges of its curved faces.
    pub(crate) fn points(&self, controls: &[f64]) -> Positions {
        let mut moved = vec![0.0; self.matrix.row_count()];
        self.matrix.multiply(controls, &mut moved);
        let moved = moved.as_chunks::<3>().0;
        let of_body = |(number, base): (usize, &Arc<Vec<[f64; 3]>>)| {
            if !self.shaped[number] {
                return Arc::clone(base);
            }
            let sum = |(node, base): (usize, &[f64; 3])| {
                let moved = moved[self.number(number, node as u32)];
                std::array::from_fn(|axis| base[axis] + moved[axis])
            };
            Arc::new(base.iter().enumerate().map(sum).collect())
        };
        self.base.iter().enumerate().map(of_body).collect()
    }

    /// Whether any control moves a node of a body.
    pub fn shapes(&self, body: usize) -> bool {
        self.shaped[body]
    }

    /// The bodies that controls shape.
    pub fn shaped_bodies(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.shaped.len()).filter(|&body| self.shaped[body])
    }

    /// Whether a node of a body moves with any control.
    pub fn moves(&self, body: usize, node: u32) -> bool {
        (0..3).any(|axis| self.row(body, node, axis).next().is_some())
    }

    /// Whether any node of a body moves along an axis with any control.
    pub fn moves_along(&self, body: usize, axis: usize) -> bool {
        self.shaped[body] && self.nodes(body).any(|node| self.matrix.row(3 * node + axis).next().is_some())
    }

    /// The sensitivities of the controls from those of the positions of all points, or of all nodes.
    pub fn pull_back(&self, sensitivities: &[[f64; 3]]) -> Vec<f64> {
        let mut controls = vec![0.0; self.control_count()];
        for (row, sensitivity) in sensitivities.as_flattened().iter().enumerate() {
            self.matrix.row(row).for_each(|(control, value)| controls[control] += value * sensitivity);
        }
        controls
    }

    /// The velocities of the nodes for some changes of the controls.
    pub fn velocities(&self, changes: &[Vec<f64>]) -> Velocities<'_> {
        let mut by_control = vec![Vec::new(); self.control_count()];
        for (column, change) in changes.iter().enumerate() {
            for (control, value) in change.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                by_control[control].push((column, *value));
            }
        }
        Velocities { map: self, by_control, count: changes.len() }
    }

    /// A row of N: how a component of the position of a node of a body depends on the controls.
    pub fn row(&self, body: usize, node: u32, axis: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.matrix.row(3 * self.number(body, node) + axis)
    }
}

/// The first positions of a body: those of its nodes among those of all points.
pub(crate) fn first_of(points: &Arc<Vec<[f64; 3]>>, count: usize) -> Arc<Vec<[f64; 3]>> {
    if points.len() == count { Arc::clone(points) } else { Arc::new(points[..count].to_vec()) }
}

/// Fields of velocities of the nodes, one per change of the controls.
#[derive(Debug)]
pub struct Velocities<'a> {
    map: &'a ShapeMap,
    /// Changes of every control: (change, value).
    by_control: Vec<Vec<(usize, f64)>>,
    count: usize,
}

impl Velocities<'_> {
    /// Number of fields.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Whether a node of a body moves with any control.
    pub fn moves(&self, body: usize, node: u32) -> bool {
        self.map.moves(body, node)
    }

    /// The velocity of a node of a body in one of the fields.
    pub fn at(&self, body: usize, node: u32, column: usize) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let terms = self.map.row(body, node, axis).flat_map(|(control, value)| {
                self.by_control[control].iter().filter(|(own, _)| *own == column).map(move |(_, change)| value * change)
            });
            terms.fold(0.0, |sum, term| sum + term)
        })
    }

    /// The fields that move some of these nodes of a body, with the velocities of the nodes, three entries each.
    pub fn of_nodes(&self, body: usize, nodes: &[u32]) -> Vec<(usize, Vec<f64>)> {
        let first = self.map.starts[body];
        self.of_numbers(nodes.iter().map(|&node| first + node as usize))
    }

    /// As [`of_nodes`](Self::of_nodes), for nodes by their numbers among those of all bodies.
    pub(crate) fn of_numbers(&self, nodes: impl ExactSizeIterator<Item = usize>) -> Vec<(usize, Vec<f64>)> {
        let (mut fields, count): (Vec<Option<Vec<f64>>>, usize) = (vec![None; self.count], nodes.len());
        for (place, node) in nodes.enumerate() {
            for axis in 0..3 {
                for (control, value) in self.map.matrix.row(3 * node + axis) {
                    for &(column, change) in &self.by_control[control] {
                        let field = fields[column].get_or_insert_with(|| vec![0.0; 3 * count]);
                        field[3 * place + axis] += value * change;
                    }
                }
            }
        }
        fields.into_iter().enumerate().filter_map(|(column, field)| Some((column, field?))).collect()
    }
}
