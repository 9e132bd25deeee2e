//! Proportions of the cells of a body, of which the condition of its matrices depends.

use crate::body::mesh::{CellFace, CellKind, Mesh};

/// Proportions of cells from which they are extreme: total FETI may take hundreds of products and more, above all for
/// plates and for cells that are long in the plan.
const EXTREME: f64 = 30.0;

/// Proportions of the cells of a body at the start.
#[derive(Debug, Clone, Copy)]
pub struct CellShapes {
    /// Median of the longest edge over the shortest one of a cell.
    aspect: f64,
    /// Median over the cells of the contact face of the height over the longest edge of the facet, or of its shortest
    /// edge over the height, whichever is larger.
    along_normal: f64,
}

impl CellShapes {
    pub(crate) fn new(mesh: &Mesh, positions: &[[f64; 3]], contact: &[CellFace]) -> Self {
        let aspects = (0..mesh.cell_count()).map(|cell| {
            let nodes = mesh.cell(cell);
            let lengths = edges(nodes.kind).iter().map(|[a, b]| distance(positions, nodes.nodes[*a], nodes.nodes[*b]));
            let [shortest, longest] = extremes(lengths);
            longest / shortest
        });
        let ratios = contact.iter().map(|&face| {
            let (nodes, corners) = mesh.face_with_corners(face);
            let sides = (0..corners).map(|side| distance(positions, nodes[side], nodes[(side + 1) % corners]));
            let [shortest, longest] = extremes(sides);
            let height = height(mesh, positions, face);
            (height / longest).max(shortest / height)
        });
        Self { aspect: median(aspects.collect()), along_normal: median(ratios.collect()) }
    }

    /// The proportions of the edges: the longest over the shortest one.
    pub fn aspect(&self) -> f64 {
        self.aspect
    }

    /// The proportions of the edges, where they are extreme.
    pub fn extreme_aspect(&self) -> Option<f64> {
        (self.aspect >= EXTREME).then_some(self.aspect)
    }

    /// The proportions of cells that are plates on the contact face or rods across it, where they are extreme.
    pub fn flat_or_tall(&self) -> Option<f64> {
        (self.along_normal >= EXTREME).then_some(self.along_normal)
    }
}

/// The edges of a cell between its corners.
fn edges(kind: CellKind) -> &'static [[usize; 2]] {
    match kind {
        CellKind::Hex8 => {
            &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
        }
        CellKind::Tet10 => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
    }
}

/// Mean distance of the other corners of the cell from the plane of a face.
fn height(mesh: &Mesh, positions: &[[f64; 3]], face: CellFace) -> f64 {
    let (nodes, corners) = mesh.face_with_corners(face);
    let at = |node: u32| nalgebra::Vector3::from(positions[node as usize]);
    let centre = nodes[..corners].iter().map(|&node| at(node)).sum::<nalgebra::Vector3<f64>>() / corners as f64;
    let normal = match corners {
        3 => (at(nodes[1]) - at(nodes[0])).cross(&(at(nodes[2]) - at(nodes[0]))),
        _ => (at(nodes[2]) - at(nodes[0])).cross(&(at(nodes[3]) - at(nodes[1]))),
    };
    let cell = mesh.cell(face.cell as usize);
    let vertices = &cell.nodes[..if cell.kind == CellKind::Hex8 { 8 } else { 4 }];
    let others: Vec<u32> = vertices.iter().copied().filter(|node| !nodes.contains(node)).collect();
    let sum: f64 = others.iter().map(|&node| (at(node) - centre).dot(&normal).abs()).sum();
    sum / (others.len() as f64 * normal.norm())
}

fn distance(positions: &[[f64; 3]], a: u32, b: u32) -> f64 {
    let (a, b) = (positions[a as usize], positions[b as usize]);
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

fn extremes(lengths: impl Iterator<Item = f64>) -> [f64; 2] {
    lengths.fold([f64::INFINITY, 0.0], |[least, most], length| [least.min(length), most.max(length)])
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 1.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
