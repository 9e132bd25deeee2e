//! A block of bricks between two surfaces as a mesh.
//!
//! ```text
//! x₁ = i·a/n₁,  x₂ = j·b/n₂,  x₃ = lower_ij + (upper_ij − lower_ij)·k/n₃       node (i·(n₂ + 1) + j)·(n₃ + 1) + k   method.md section 2
//! ```

use crate::body::mesh::{CellFace, CellKind, Grid, Mesh};
use crate::error::SceneError;
use serde::{Deserialize, Serialize};

/// A face of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BlockFace {
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

impl BlockFace {
    /// All faces of a block.
    pub const ALL: [Self; 6] = [Self::X1Min, Self::X1Max, Self::X2Min, Self::X2Max, Self::Bottom, Self::Top];

    /// Its name in scenes and meshes.
    pub fn name(self) -> &'static str {
        match self {
            Self::X1Min => "x1-min",
            Self::X1Max => "x1-max",
            Self::X2Min => "x2-min",
            Self::X2Max => "x2-max",
            Self::Bottom => "bottom",
            Self::Top => "top",
        }
    }

    /// The axis normal to the face, whether it is the far end of it, and the face of a brick that lies there.
    fn side(self) -> (usize, bool, u8) {
        match self {
            Self::X1Min => (0, false, 5),
            Self::X1Max => (0, true, 3),
            Self::X2Min => (1, false, 2),
            Self::X2Max => (1, true, 4),
            Self::Bottom => (2, false, 0),
            Self::Top => (2, true, 1),
        }
    }
}

impl From<BlockFace> for String {
    fn from(face: BlockFace) -> Self {
        face.name().into()
    }
}

/// Corners (i, j, k) of a brick in the order of [`CellKind::Hex8`], seen from its first one.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// The mesh of a block with six named faces, divided into `subdomains` boxes of bricks per axis, which divide their
/// numbers; heights of both surfaces per column of nodes, mm.
///
/// # Errors
/// As [`Mesh::new`].
pub fn block(grid: &Grid, subdomains: [usize; 3], lower: &[f64], upper: &[f64]) -> Result<Mesh, SceneError> {
    let position = |[i, j, k]: [usize; 3]| {
        let (column, share) = (grid.column(i, j), k as f64 / grid.cells[2] as f64);
        let [x1, x2] = grid.position(i, j);
        [x1, x2, lower[column] + (upper[column] - lower[column]) * share]
    };
    let nodes = points(grid.nodes()).map(position).collect();
    let bricks = || points(grid.cells);
    let node =
        |brick: [usize; 3], corner: [usize; 3]| grid.node(std::array::from_fn(|axis| brick[axis] + corner[axis]));
    let corners = |brick| (CellKind::Hex8, CORNERS.map(|corner| node(brick, corner)));
    let boxes: [usize; 3] = std::array::from_fn(|axis| grid.cells[axis] / subdomains[axis]);
    let piece = |brick: [usize; 3]| index(subdomains, std::array::from_fn(|axis| brick[axis] / boxes[axis])) as u32;
    let mut mesh = Mesh::new(nodes, bricks().map(corners))?.with_pieces(bricks().map(piece).collect())?;
    for name in BlockFace::ALL {
        let (axis, far, face) = name.side();
        let level = if far { grid.cells[axis] - 1 } else { 0 };
        let on_side = bricks().enumerate().filter(|(_, brick)| brick[axis] == level);
        let faces = on_side.map(|(cell, _)| CellFace { cell: cell as u32, face }).collect();
        mesh = mesh.with_face(name, faces)?;
    }
    Ok(mesh)
}

/// The points (i, j, k) of a box in the order of their indices (i·n₂ + j)·n₃ + k.
fn points(counts: [usize; 3]) -> impl Iterator<Item = [usize; 3]> + use<> {
    let [_, n2, n3] = counts;
    (0..counts.iter().product()).map(move |index: usize| [index / (n2 * n3), index / n3 % n2, index % n3])
}

fn index([_, n2, n3]: [usize; 3], [i, j, k]: [usize; 3]) -> usize {
    (i * n2 + j) * n3 + k
}
