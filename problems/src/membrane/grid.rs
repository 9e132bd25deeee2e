//! Differences on a square grid.
//!
//! ```text
//! (A u)_i = 4u_i − Σ u_neighbours ≈ h² (−Δu)(x_i)
//! ```

use contact::error::SceneError;

/// A square with N × N cells; unknowns are the (N − 1)² inner nodes, i·(N − 1) + j with i along x₁.
#[derive(Debug, Clone, PartialEq)]
pub struct MembraneGrid {
    /// Number N ≥ 2 of cells per edge.
    pub cells: usize,
    /// Coordinates of the lower left corner.
    pub origin: [f64; 2],
    /// Length of an edge of the square.
    pub length: f64,
}

impl MembraneGrid {
    /// A grid of at least two cells per edge.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for fewer cells, a length that is not positive, and numbers that are not finite.
    pub fn new(cells: usize, origin: [f64; 2], length: f64) -> Result<Self, SceneError> {
        if cells < 2 {
            return Err(SceneError::out_of_range("cells per edge of the membrane", cells, "at least 2"));
        }
        if !(length > 0.0 && length.is_finite()) {
            return Err(SceneError::out_of_range("edge of the membrane", length, "a finite length > 0"));
        }
        if let Some(x) = origin.into_iter().find(|x| !x.is_finite()) {
            return Err(SceneError::out_of_range("corner of the membrane", x, "finite numbers"));
        }
        Ok(Self { cells, origin, length })
    }

    /// The mesh width h.
    pub fn width(&self) -> f64 {
        self.length / self.cells as f64
    }

    /// Inner nodes per edge.
    pub fn inner(&self) -> usize {
        self.cells - 1
    }

    /// Number of inner nodes, which carry the unknowns.
    pub fn node_count(&self) -> usize {
        self.inner() * self.inner()
    }

    /// Position of the grid point with indices 0 … N.
    pub fn point(&self, indices: [usize; 2]) -> [f64; 2] {
        std::array::from_fn(|axis| self.origin[axis] + indices[axis] as f64 * self.width())
    }

    /// Position of an inner node.
    pub fn node(&self, index: usize) -> [f64; 2] {
        self.point([index / self.inner() + 1, index % self.inner() + 1])
    }

    /// The inner neighbours of an inner node.
    pub fn neighbours(&self, index: usize) -> impl Iterator<Item = usize> + use<> {
        let n = self.inner();
        let (i, j) = (index / n, index % n);
        let candidates = [
            (i > 0, index.wrapping_sub(n)),
            (j > 0, index.wrapping_sub(1)),
            (j + 1 < n, index + 1),
            (i + 1 < n, index + n),
        ];
        candidates.into_iter().filter(|(inside, _)| *inside).map(|(_, neighbour)| neighbour)
    }

    /// A u for inner values, with zero on the boundary.
    pub fn multiply(&self, u: &[f64]) -> Vec<f64> {
        (0..u.len()).map(|i| 4.0 * u[i] - self.neighbours(i).map(|k| u[k]).sum::<f64>()).collect()
    }

    /// Sum of the boundary values next to every inner node.
    pub(super) fn boundary_sums(&self, value: impl Fn([f64; 2]) -> f64) -> Vec<f64> {
        let inside = |k: usize| (1..self.cells).contains(&k);
        (0..self.node_count())
            .map(|index| {
                let (i, j) = (index / self.inner() + 1, index % self.inner() + 1);
                let around = [[i - 1, j], [i, j - 1], [i, j + 1], [i + 1, j]];
                around.into_iter().filter(|k| !inside(k[0]) || !inside(k[1])).map(|k| value(self.point(k))).sum()
            })
            .collect()
    }
}
