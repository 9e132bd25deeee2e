//! The plan of a block: bricks in columns over a uniform grid.

/// Numbers of bricks and the size of the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Bricks along x₁, x₂, x₃.
    pub cells: [usize; 3],
    /// Least x₁ and x₂ of the base, mm.
    pub corner: [f64; 2],
    /// Lengths a, b of the base along x₁, x₂, mm.
    pub size: [f64; 2],
}

impl Grid {
    /// Nodes along the three axes.
    pub fn nodes(&self) -> [usize; 3] {
        self.cells.map(|cells| cells + 1)
    }

    /// Number of nodes of the block.
    pub fn node_count(&self) -> usize {
        self.nodes().iter().product()
    }

    /// Index of node (i, j, k).
    pub fn node(&self, [i, j, k]: [usize; 3]) -> usize {
        let [_, n2, n3] = self.nodes();
        (i * n2 + j) * n3 + k
    }

    /// Place (i/n₁, j/n₂, k/n₃) of a node by its index.
    pub fn share(&self, node: usize) -> [f64; 3] {
        let [_, n2, n3] = self.nodes();
        let index = [node / (n2 * n3), node / n3 % n2, node % n3];
        std::array::from_fn(|axis| index[axis] as f64 / self.cells[axis] as f64)
    }

    /// Number of vertical columns of nodes, the points of a surface.
    pub fn column_count(&self) -> usize {
        (self.cells[0] + 1) * (self.cells[1] + 1)
    }

    /// Index of the column of nodes (i, j).
    pub fn column(&self, i: usize, j: usize) -> usize {
        i * (self.cells[1] + 1) + j
    }

    /// Position (x₁, x₂) of column (i, j), mm.
    pub fn position(&self, i: usize, j: usize) -> [f64; 2] {
        self.moved([self.size[0] * i as f64 / self.cells[0] as f64, self.size[1] * j as f64 / self.cells[1] as f64])
    }

    /// A place (x₁, x₂) on the base, counted from its corner, mm.
    pub fn moved(&self, [x1, x2]: [f64; 2]) -> [f64; 2] {
        [self.corner[0] + x1, self.corner[1] + x2]
    }

    /// All columns (i, j) in index order.
    pub fn columns(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let rows = self.cells[1] + 1;
        (0..self.column_count()).map(move |column| (column / rows, column % rows))
    }

    /// Positions (x₁, x₂) of all columns in index order, mm.
    pub fn places(&self) -> impl Iterator<Item = [f64; 2]> + use<> {
        let grid = *self;
        self.columns().map(move |(i, j)| grid.position(i, j))
    }
}
