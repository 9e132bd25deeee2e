//! A block of bricks in columns over a uniform grid between a lower and an upper surface.
//!
//! ```text
//! x₁ = i·a/n₁,  x₂ = j·b/n₂,  x₃ = lower_ij + (upper_ij − lower_ij)·k/n₃                              method.md section 2
//! ```

use crate::body::elasticity::brick::Nodes;
use crate::error::ContactError;
use crate::lattice;

/// Topology and plan of a block: numbers of bricks and the size of its base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Bricks along x₁, x₂, x₃.
    pub cells: [usize; 3],
    /// Lengths a, b of the base along x₁, x₂, mm.
    pub size: [f64; 2],
}

/// A face of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "FaceName", transform = crate::schema::names_only))]
pub enum Face {
    /// x₁ = 0.
    X1Min,
    /// x₁ = a.
    X1Max,
    /// x₂ = 0.
    X2Min,
    /// x₂ = b.
    X2Max,
    /// Lower surface.
    Bottom,
    /// Upper surface.
    Top,
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
    pub fn node(&self, node: [usize; 3]) -> usize {
        lattice::index(self.nodes(), node)
    }

    /// Number of bricks of the block.
    pub fn brick_count(&self) -> usize {
        self.cells.iter().product()
    }

    /// Index of brick (i, j, k).
    pub fn brick(&self, brick: [usize; 3]) -> usize {
        lattice::index(self.cells, brick)
    }

    /// All bricks (i, j, k) in index order.
    pub fn bricks(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        lattice::points([0; 3], self.cells)
    }

    /// Indices of the eight nodes of brick (i, j, k), in the order of [`crate::body::elasticity::brick`].
    pub fn brick_nodes(&self, brick: [usize; 3]) -> [usize; 8] {
        lattice::corners(brick).map(|node| self.node(node))
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
        [self.size[0] * i as f64 / self.cells[0] as f64, self.size[1] * j as f64 / self.cells[1] as f64]
    }

    /// All columns (i, j) in index order.
    pub fn columns(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let rows = self.cells[1] + 1;
        (0..self.column_count()).map(move |column| (column / rows, column % rows))
    }

    /// Tributary area of column (i, j) on the projected grid: h₁h₂ inside, half on edges, quarter in corners; mm².
    pub(crate) fn tributary_area(&self, i: usize, j: usize) -> f64 {
        let share = |index: usize, cells: usize| if index == 0 || index == cells { 0.5 } else { 1.0 };
        let cell = self.size[0] / self.cells[0] as f64 * self.size[1] / self.cells[1] as f64;
        cell * share(i, self.cells[0]) * share(j, self.cells[1])
    }

    /// The axis normal to a face, and the index along this axis of the layer of nodes on the face.
    pub fn side(&self, face: Face) -> (usize, usize) {
        match face {
            Face::X1Min => (0, 0),
            Face::X1Max => (0, self.cells[0]),
            Face::X2Min => (1, 0),
            Face::X2Max => (1, self.cells[1]),
            Face::Bottom => (2, 0),
            Face::Top => (2, self.cells[2]),
        }
    }

    /// Whether node (i, j, k) lies on a face.
    pub(crate) fn is_on(&self, face: Face, node: [usize; 3]) -> bool {
        let (axis, level) = self.side(face);
        node[axis] == level
    }
}

/// A grid with its two surfaces: the geometry of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Numbers of bricks and the plan of the block.
    pub grid: Grid,
    /// Height of the lower surface per column of nodes, mm.
    pub lower: Vec<f64>,
    /// Height of the upper surface per column of nodes, mm.
    pub upper: Vec<f64>,
}

impl Block {
    /// Coordinates of node (i, j, k), mm.
    pub fn coordinates(&self, [i, j, k]: [usize; 3]) -> [f64; 3] {
        let column = self.grid.column(i, j);
        let share = k as f64 / self.grid.cells[2] as f64;
        let [x1, x2] = self.grid.position(i, j);
        [x1, x2, self.lower[column] + (self.upper[column] - self.lower[column]) * share]
    }

    /// Coordinates of all nodes in index order, mm.
    pub fn points(&self) -> impl Iterator<Item = [f64; 3]> {
        lattice::points([0; 3], self.grid.nodes()).map(|node| self.coordinates(node))
    }

    /// Coordinates of the eight nodes of brick (i, j, k), in the order of [`crate::body::elasticity::brick`].
    pub fn brick(&self, brick: [usize; 3]) -> Nodes<f64> {
        lattice::corners(brick).map(|node| self.coordinates(node))
    }

    /// Volume of its bricks, mm³: they interpolate the heights of the columns bilinearly, so that it is Σ A · height.
    pub fn volume(&self) -> f64 {
        let height = |(i, j): (usize, usize)| self.upper[self.grid.column(i, j)] - self.lower[self.grid.column(i, j)];
        self.grid.columns().map(|column| self.grid.tributary_area(column.0, column.1) * height(column)).sum()
    }

    /// Refuses a block with an inverted or flat brick. `body` is its number in messages (1 lower, 2 upper).
    ///
    /// Columns are vertical over a uniform grid, so det(∂x/∂ξ) of a brick interpolates h₁h₂·(height of the column)/n₃
    /// between its four columns: it is positive everywhere exactly if all columns have positive height.
    ///
    /// # Errors
    /// [`ContactError::InvertedElement`] naming a brick at the first such column.
    pub fn checked(self, body: usize) -> Result<Self, ContactError> {
        let [n1, n2, n3] = self.grid.cells;
        let base = self.grid.size[0] / n1 as f64 * self.grid.size[1] / n2 as f64;
        for (i, j) in self.grid.columns() {
            let column = self.grid.column(i, j);
            let determinant = base * (self.upper[column] - self.lower[column]) / n3 as f64;
            if !(determinant > 0.0 && determinant.is_finite()) {
                let (i, j) = (i.min(n1 - 1), j.min(n2 - 1));
                return Err(ContactError::InvertedElement { body, i, j, k: 0, determinant });
            }
        }
        Ok(self)
    }
}
