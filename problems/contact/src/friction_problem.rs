//! The friction problem of a shape as matrices, for other solvers.
//!
//! ```text
//! K u = f + Hᵀ r,   w = H u + (g, 0, 0) per contact node,
//! 0 ≤ r_N ⊥ w_N ≥ 0,   |r_T| ≤ 𝓕 r_N,   w_T = −κ r_T with κ ≥ 0, and κ = 0 where |r_T| < 𝓕 r_N
//! ```
//! Node by node, r = (λ_N, λ_T) are the contact forces of method.md section 3, and H u is minus the jump, lower body
//! less upper: w_N is the gap under load, w_T minus the slip. The bodies are not torn; dofs that supports hold are
//! eliminated.

use crate::body::local_pattern::LocalPattern;
use crate::body::mesh::Subdomain;
use crate::body::shape_load::nodal_loads;
use crate::equilibrium::ContactProblem;
use crate::error::ContactError;

/// Rows of H per contact node: the normal, then the tangential directions x₁ and x₂.
pub const ROWS: usize = 3;

/// The matrices of a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionProblem {
    /// The unknown displacements: body (0 lower, 1 upper), node of its grid, component.
    pub unknowns: Vec<[usize; 3]>,
    /// K by its lower triangle: (row, column, value in N/mm).
    pub stiffness: Vec<(usize, usize, f64)>,
    /// The loads f, N.
    pub load: Vec<f64>,
    /// H: (row, column, ±1). A row is empty where supports hold its direction on all bodies.
    pub contact: Vec<(usize, usize, f64)>,
    /// g per contact node: the gap before loading, mm.
    pub gaps: Vec<f64>,
    /// 𝓕 per contact node.
    pub friction: Vec<f64>,
    /// Places of the contact nodes on the lower body, mm.
    pub places: Vec<[f64; 3]>,
    /// Tributary areas of the contact nodes, mm²; a pressure is λ_N over the area.
    pub areas: Vec<f64>,
}

impl FrictionProblem {
    /// Number of displacements of all bodies, those that supports hold included.
    pub fn most_unknowns(problem: &ContactProblem) -> usize {
        3 * problem.grid.node_count() * problem.bodies().count()
    }

    /// The matrices of the shape with these controls.
    ///
    /// # Errors
    /// [`ContactError::InvertedElement`].
    pub fn new(problem: &ContactProblem, controls: &[f64]) -> Result<Self, ContactError> {
        let (grid, blocks) = (&problem.grid, problem.blocks(controls)?);
        let pattern = LocalPattern::new(grid.cells, &[]);
        let points = &problem.boundary.points;
        let mut this = Self {
            unknowns: Vec::new(),
            stiffness: Vec::new(),
            load: Vec::new(),
            contact: Vec::new(),
            gaps: problem.gaps(&blocks[0]),
            friction: vec![problem.boundary.friction; points.len()],
            places: Vec::new(),
            areas: points.iter().map(|point| point.area).collect(),
        };
        for (body, (block, scene)) in blocks.iter().zip(problem.bodies()).enumerate() {
            let held = (0..grid.node_count()).flat_map(|node| scene.held(grid, pattern.shape.local_position(node)));
            // Numbers of the free dofs among all unknowns.
            let numbers: Vec<Option<usize>> = held
                .enumerate()
                .map(|(dof, held)| {
                    (!held).then(|| {
                        this.unknowns.push([body, dof / 3, dof % 3]);
                        this.unknowns.len() - 1
                    })
                })
                .collect();
            let values = pattern.assemble(&scene.material, |brick| block.brick(brick));
            let (starts, rows) = (pattern.pattern.starts(), pattern.pattern.rows());
            for column in 0..pattern.pattern.dimension() {
                let Some(second) = numbers[column] else { continue };
                for position in starts[column]..starts[column + 1] {
                    this.stiffness.extend(numbers[rows[position]].map(|first| (first, second, values[position])));
                }
            }
            let loads = nodal_loads(block, &Subdomain::whole(&block.grid), &scene.loads).into_iter().zip(&numbers);
            this.load.extend(loads.filter(|(_, number)| number.is_some()).map(|(force, _)| force));
            let (layer, sign) = if body == 0 { (grid.cells[2], -1.0) } else { (0, 1.0) };
            for (index, point) in points.iter().enumerate() {
                let node = [point.position[0], point.position[1], layer];
                if body == 0 {
                    this.places.push(block.coordinates(node));
                }
                for (row, component) in [2, 0, 1].into_iter().enumerate() {
                    let number = numbers[3 * grid.node(node) + component];
                    this.contact.extend(number.map(|number| (ROWS * index + row, number, sign)));
                }
            }
        }
        Ok(this)
    }
}
