//! The contact nodes and the layout of their multipliers.
//!
//! A *packed* contact vector holds, node by node, the normal row and the tangential rows that exist: none without
//! friction, and none for a tangential dof that supports hold on all bodies (method.md section 3).

use crate::body::mesh::Grid;
use crate::equilibrium::ContactStatus;
use crate::scene::Scene;
use nonsmooth::Vector;

/// A node of the contact surface with its area and its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPoint {
    /// Column of nodes (i, j) of the grid.
    pub position: [usize; 2],
    /// Tributary area A of the projected grid, mm².
    pub area: f64,
    /// Position of its normal row in a packed contact vector.
    pub start: usize,
    /// Tangential directions (0 for x₁, 1 for x₂) that have a row, in order.
    pub tangents: Vec<usize>,
    /// Whether any tangential dof is free, with or without a row.
    pub can_slide: bool,
}

impl ContactPoint {
    /// Number of rows of this node.
    pub fn row_count(&self) -> usize {
        1 + self.tangents.len()
    }

    /// (packed row, contact dof) of the rows of this node, whose position among the nodes is `index`.
    pub fn rows_of(&self, index: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let components = std::iter::once(2).chain(self.tangents.iter().copied());
        components.enumerate().map(move |(offset, component)| (self.start + offset, 3 * index + component))
    }

    /// Its rows in a packed contact vector.
    pub fn rows(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.row_count()
    }
}

/// All contact nodes of a scene.
#[derive(Debug, Clone)]
pub struct ContactBoundary {
    /// The nodes, in the order of the grid's columns.
    pub points: Vec<ContactPoint>,
    /// Length of a packed contact vector.
    pub row_count: usize,
    /// Friction coefficient 𝓕 of all nodes.
    pub friction: f64,
}

impl ContactBoundary {
    /// The contact boundary of a scene: the top of the lower body.
    pub fn new(scene: &Scene, grid: &Grid) -> Self {
        let mut row_count = 0;
        let points = grid
            .columns()
            .map(|(i, j)| {
                let mut held = scene.lower.held(grid, [i, j, grid.cells[2]]);
                if let Some(upper) = &scene.upper {
                    let above = upper.body.held(grid, [i, j, 0]);
                    held = std::array::from_fn(|axis| held[axis] && above[axis]);
                }
                let free: Vec<usize> = (0..2).filter(|&axis| !held[axis]).collect();
                let can_slide = !free.is_empty();
                let tangents = if scene.friction > 0.0 { free } else { Vec::new() };
                let (position, area) = ([i, j], grid.tributary_area(i, j));
                let point = ContactPoint { position, area, start: row_count, tangents, can_slide };
                row_count += point.row_count();
                point
            })
            .collect();
        Self { points, row_count, friction: scene.friction }
    }

    /// Whether the scene has friction, and with it tangential multipliers.
    pub fn has_friction(&self) -> bool {
        self.friction > 0.0
    }

    /// Area of the closed nodes, Σ A over the nodes that stick or slip, mm²; one status per node, in the order of
    /// [`ContactBoundary::points`].
    pub fn closed_area(&self, status: &[ContactStatus]) -> f64 {
        let nodes = self.points.iter().zip(status).filter(|(_, status)| **status != ContactStatus::Open);
        nodes.map(|(point, _)| point.area).fold(0.0, |sum, area| sum + area)
    }

    /// σ = λ_N/A per contact node, MPa, of normal forces in N.
    pub fn pressures(&self, normal: &[f64]) -> Vector {
        Vector::from_iterator(
            self.points.len(),
            normal.iter().zip(&self.points).map(|(force, point)| force / point.area),
        )
    }

    /// Length of the dual of a contact state: normal forces, then (with friction) two tangential forces per node.
    pub fn dual_dimension(&self) -> usize {
        self.points.len() * if self.has_friction() { 3 } else { 1 }
    }

    /// From the dual layout [normal; tangential pairs] to a packed contact vector.
    pub fn pack(&self, dual: &[f64]) -> Vec<f64> {
        let mut packed = Vec::with_capacity(self.row_count);
        for (index, point) in self.points.iter().enumerate() {
            packed.push(dual[index]);
            packed.extend(point.tangents.iter().map(|tangent| dual[self.points.len() + 2 * index + tangent]));
        }
        packed
    }
}

#[cfg(test)]
mod tests {
    use crate::body::mesh::Grid;
    use crate::equilibrium::{ContactBoundary, ContactStatus};
    use crate::scene::signorini;

    #[test]
    fn open_nodes_have_no_closed_area() {
        let scene = signorini().expect("the scene of the paper");
        let boundary = ContactBoundary::new(&scene, &Grid { cells: [2, 1, 1], size: scene.size });
        assert_eq!(boundary.points.len(), 6);
        let [a, b] = scene.size;
        let mut status = [ContactStatus::Stick; 6];
        assert!((boundary.closed_area(&status) / (a * b) - 1.0).abs() < 1e-15);
        // A corner has an eighth of the area; the nodes at x1 = a/2 have a half together.
        status[0] = ContactStatus::Open;
        status[3] = ContactStatus::Slip;
        assert!((boundary.closed_area(&status) / (a * b) - 0.875).abs() < 1e-15);
        assert_eq!(boundary.closed_area(&[ContactStatus::Open; 6]), 0.0);
    }
}
