//! Where the meshes of bodies come from: blocks of bricks between two surfaces of heights, or meshes.

use crate::body::mesh::{Grid, Mesh, block};
use crate::error::SceneError;
use crate::scene::CounterSurface;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Where the mesh of a body comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Geometry {
    /// A block of bricks.
    Block(Block),
    /// A mesh.
    Mesh(MeshGeometry),
}

/// A block of bricks over a rectangle, between two surfaces of heights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// Least x₁ and x₂ of the base, mm.
    pub corner: [f64; 2],
    /// Lengths a, b of the base, mm.
    pub size: [f64; 2],
    /// Bricks along x₁, x₂, x₃.
    pub bricks: [usize; 3],
    /// Subdomains along x₁, x₂, x₃.
    pub subdomains: [usize; 3],
    /// Heights of its bottom face, where no control moves them.
    pub bottom: CounterSurface,
    /// Heights of its top face, where no control moves them.
    pub top: CounterSurface,
}

/// A mesh with the number of its pieces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeshGeometry {
    /// Nodes, cells and names; lengths in mm.
    pub mesh: Arc<Mesh>,
    /// Pieces that total FETI divides it into, about; none: by the number of cells.
    pub pieces: Option<usize>,
}

/// Cells of a piece, about, where the scene does not say how many pieces there are: larger ones take too long to
/// factor, smaller ones make the coarse problem large.
const CELLS_PER_PIECE: [usize; 2] = [512, 400];

impl MeshGeometry {
    /// Pieces, about.
    pub fn piece_count(&self) -> usize {
        let cells = if self.is_second_order() { CELLS_PER_PIECE[1] } else { CELLS_PER_PIECE[0] };
        self.pieces.unwrap_or_else(|| self.mesh.cell_count().div_ceil(cells))
    }

    /// Whether most cells are of second order.
    pub(crate) fn is_second_order(&self) -> bool {
        2 * self.mesh.cells().filter(|cell| cell.nodes.len() > 8).count() > self.mesh.cell_count()
    }
}

impl Block {
    /// A block from the plane x₃ = 0 to the plane x₃ = `height`, with a corner in the origin.
    pub fn new(size: [f64; 2], height: f64, bricks: [usize; 3], subdomains: [usize; 3]) -> Self {
        let plane = |height: f64| CounterSurface::Plane { height };
        Self { corner: [0.0; 2], size, bricks, subdomains, bottom: plane(0.0), top: plane(height) }
    }

    /// The plan of its bricks.
    pub fn grid(&self) -> Grid {
        Grid { cells: self.bricks, corner: self.corner, size: self.size }
    }

    /// Heights of the bottom and of the top over the columns of the grid, where no control moves them, mm.
    pub fn heights(&self) -> [Vec<f64>; 2] {
        let heights = |surface: &CounterSurface| self.grid().places().map(|[x1, x2]| surface.height(x1, x2)).collect();
        [heights(&self.bottom), heights(&self.top)]
    }

    /// The mesh where no control moves its faces.
    ///
    /// # Errors
    /// As [`Mesh::new`].
    pub fn mesh(&self) -> Result<Mesh, SceneError> {
        let [bottom, top] = self.heights();
        block(&self.grid(), self.subdomains, &bottom, &top)
    }

    /// Checks numbers and heights; `field` is the body in messages.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] naming the field.
    pub(crate) fn validate(&self, field: &str) -> Result<(), SceneError> {
        for (axis, (&mesh, &subdomains)) in self.bricks.iter().zip(&self.subdomains).enumerate() {
            let place = format!("{field}.bricks[{axis}]");
            SceneError::require((1..=400).contains(&mesh), place, mesh, "1 … 400 bricks per edge")?;
            let divides = subdomains > 0 && mesh.is_multiple_of(subdomains);
            let allowed = format!("a divisor of the {mesh} bricks per edge");
            SceneError::require(divides, format!("{field}.subdomains[{axis}]"), subdomains, allowed)?;
        }
        for (axis, &length) in self.size.iter().enumerate() {
            let valid = length > 0.0 && length.is_finite();
            SceneError::require(valid, format!("{field}.size[{axis}]"), length, "a finite length > 0 mm")?;
        }
        for (axis, &place) in self.corner.iter().enumerate() {
            SceneError::require(place.is_finite(), format!("{field}.corner[{axis}]"), place, "a finite number (mm)")?;
        }
        for (name, surface) in [("bottom", &self.bottom), ("top", &self.top)] {
            let field = format!("{field}.{name}");
            surface.check(&field)?;
            SceneError::require(surface.has_heights(), field, "a surface in space", "a height over x1 and x2")?;
        }
        Ok(())
    }
}
