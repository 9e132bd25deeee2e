//! The linear map from controls to the positions of the nodes of a body.
//!
//! ```text
//! x(α) = x₀ + N α,     sensitivities of α = Nᵀ (sensitivities of x),     velocities x′ = N α′
//! ```

use crate::linear::csr::Csr;

/// x₀ and N.
#[derive(Debug, Clone)]
pub struct ShapeMap {
    base: Vec<[f64; 3]>,
    /// N by rows: 3·node + component.
    matrix: Csr,
}

impl ShapeMap {
    /// The map with given positions for controls 0, mm, and rows of N as (control, value), three per node.
    pub(crate) fn new(base: Vec<[f64; 3]>, controls: usize, rows: impl IntoIterator<Item = Vec<(usize, f64)>>) -> Self {
        let matrix = Csr::from_rows(controls, rows);
        debug_assert_eq!(matrix.row_count(), 3 * base.len());
        Self { base, matrix }
    }

    /// Number of controls.
    pub fn control_count(&self) -> usize {
        self.matrix.column_count()
    }

    /// Positions of all nodes, mm.
    pub fn positions(&self, controls: &[f64]) -> Vec<[f64; 3]> {
        let mut moved = vec![0.0; self.matrix.row_count()];
        self.matrix.multiply(controls, &mut moved);
        let nodes = self.base.iter().zip(moved.as_chunks::<3>().0);
        nodes.map(|(base, moved)| std::array::from_fn(|axis| base[axis] + moved[axis])).collect()
    }

    /// Whether a node moves with any control.
    pub fn moves(&self, node: u32) -> bool {
        (0..3).any(|axis| self.matrix.row(3 * node as usize + axis).next().is_some())
    }

    /// Whether any node moves along an axis with any control.
    pub fn moves_along(&self, axis: usize) -> bool {
        (0..self.base.len()).any(|node| self.matrix.row(3 * node + axis).next().is_some())
    }

    /// The sensitivities of the controls from those of the positions of all nodes.
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
        Velocities { matrix: &self.matrix, by_control, count: changes.len() }
    }

    /// A row of N: how a component of the position of a node depends on the controls.
    pub fn row(&self, node: u32, axis: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.matrix.row(3 * node as usize + axis)
    }
}

/// Fields of velocities of the nodes, one per change of the controls.
#[derive(Debug)]
pub struct Velocities<'a> {
    matrix: &'a Csr,
    /// Changes of every control: (change, value).
    by_control: Vec<Vec<(usize, f64)>>,
    count: usize,
}

impl Velocities<'_> {
    /// Number of fields.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Whether a node moves with any control.
    pub fn moves(&self, node: u32) -> bool {
        (0..3).any(|axis| self.matrix.row(3 * node as usize + axis).next().is_some())
    }

    /// The velocity of a node in one of the fields.
    pub fn at(&self, node: u32, column: usize) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let terms = self.matrix.row(3 * node as usize + axis).flat_map(|(control, value)| {
                self.by_control[control].iter().filter(|(own, _)| *own == column).map(move |(_, change)| value * change)
            });
            terms.fold(0.0, |sum, term| sum + term)
        })
    }

    /// The fields that move some of these nodes, with the velocities of the nodes, three entries each.
    pub fn of_nodes(&self, nodes: &[u32]) -> Vec<(usize, Vec<f64>)> {
        let mut fields: Vec<Option<Vec<f64>>> = vec![None; self.count];
        for (place, &node) in nodes.iter().enumerate() {
            for axis in 0..3 {
                for (control, value) in self.matrix.row(3 * node as usize + axis) {
                    for &(column, change) in &self.by_control[control] {
                        let field = fields[column].get_or_insert_with(|| vec![0.0; 3 * nodes.len()]);
                        field[3 * place + axis] += value * change;
                    }
                }
            }
        }
        fields.into_iter().enumerate().filter_map(|(column, field)| Some((column, field?))).collect()
    }
}
