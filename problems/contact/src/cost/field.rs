//! Costs of the displacements: stress norm in a region, compliance; method.md (3.7), (3.8), (5.5) to (5.7).
//!
//! ```text
//! J = ((1/V₀) Σ_e V_e σ_vM,e^p)^{1/p}      or      J = f·u            l = ∂J/∂u: a load in the adjoint problem
//! ```
//! What J depends on the shape at fixed displacements is ∇₁J of the framework: volumes and stresses of cells whose
//! nodes move, and loads that depend on the shape. Only the lower body changes its shape.

use crate::body::Body;
use crate::body::elasticity::CellNodes;
use crate::body::loads::{load_sensitivities, nodal_forces};
use crate::cost::region::{Region, RegionCells};
use crate::equilibrium::{ContactProblem, ContactState, SolvedBody};
use crate::error::SceneError;
use crate::shape::ShapeMap;
use nonsmooth::{Cost, CostGradient, Vector};
use rayon::prelude::*;
use std::sync::Arc;

/// A function of the displacements of the bodies.
#[derive(Debug, Clone, PartialEq)]
pub enum FieldMeasure {
    /// ((1/V₀) Σ V_e σ_vM,e^p)^{1/p}, MPa: a mean of the von Mises stress at the centres of the cells of a region, the
    /// closer to its largest value the larger p is. V₀ is the volume of the region at the start.
    StressNorm {
        /// The cells that count.
        region: Region,
        /// The exponent p > 1.
        exponent: f64,
    },
    /// f·u, the work of all loads on the displacements, N·mm.
    Compliance,
}

/// J(α, u) as a measure of the displacements, for states of a map
/// [with displacements](crate::contact_shape::ContactShape::with_displacements). The value at another state is not a
/// number.
#[derive(Debug, Clone)]
pub struct FieldCost {
    measure: FieldMeasure,
    /// Cells of the region per body; none for the compliance.
    cells: Vec<Vec<usize>>,
    /// The volume V₀ of the region, mm³.
    volume: f64,
    bodies: Arc<[Body]>,
    map: Arc<ShapeMap>,
    /// Entries of a dual before those of the displacements.
    row_count: usize,
}

/// The derivatives of J at a state.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldGradient {
    /// ∂J/∂u, three entries per node of every body, lower first, unit of J per mm.
    pub displacements: Vec<f64>,
    /// ∂J/∂x per node of the lower body at fixed displacements, unit of J per mm; 0 for nodes that no control moves.
    pub positions: Vec<[f64; 3]>,
}

impl FieldCost {
    /// The cost on the bodies of a problem.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless the exponent is finite and > 1, and as [`Region::cells`].
    pub fn new(measure: FieldMeasure, problem: &ContactProblem) -> Result<Self, SceneError> {
        let (mut cells, mut volume) = (Vec::new(), 1.0);
        if let FieldMeasure::StressNorm { region, exponent } = &measure {
            let valid = *exponent > 1.0 && exponent.is_finite();
            SceneError::require(valid, "objective.exponent", exponent, "a finite number > 1")?;
            RegionCells { cells, volume } = region.cells(problem)?;
        }
        let (bodies, map) = (Arc::clone(&problem.bodies), Arc::clone(&problem.map));
        Ok(Self { measure, cells, volume, bodies, map, row_count: problem.boundary.row_count })
    }

    /// The unit of the value.
    pub fn unit(&self) -> &'static str {
        match self.measure {
            FieldMeasure::StressNorm { .. } => "MPa",
            FieldMeasure::Compliance => "N mm",
        }
    }

    /// J of solved bodies, lower first.
    pub fn value_of(&self, bodies: &[SolvedBody]) -> f64 {
        match &self.measure {
            FieldMeasure::StressNorm { exponent, .. } => {
                let stresses =
                    self.map_cells(bodies, |cell, shear_modulus, u| (cell.von_mises(shear_modulus, u), cell.volume()));
                let largest = stresses.iter().flatten().map(|(stress, _)| *stress).fold(0.0, f64::max);
                if largest == 0.0 {
                    return 0.0;
                }
                // Relative to the largest stress, so that no power leaves the range of doubles.
                let terms =
                    stresses.iter().flatten().map(|(stress, volume)| volume * (stress / largest).powf(*exponent));
                largest * (terms.sum::<f64>() / self.volume).powf(1.0 / exponent)
            }
            FieldMeasure::Compliance => {
                let works = bodies.iter().zip(&*self.bodies).map(|(solved, body)| {
                    let forces = nodal_forces(body, &solved.positions).into_iter();
                    let work = |(node, force): (u32, [f64; 3])| dot(force, solved.displacement[node as usize]);
                    forces.map(work).sum::<f64>()
                });
                works.sum()
            }
        }
    }

    /// The derivatives of J at solved bodies, lower first.
    pub fn gradient_of(&self, bodies: &[SolvedBody]) -> FieldGradient {
        let mut gradient = FieldGradient {
            displacements: vec![0.0; 3 * bodies.iter().map(|body| body.mesh.node_count()).sum::<usize>()],
            positions: vec![[0.0; 3]; bodies.first().map_or(0, |body| body.mesh.node_count())],
        };
        match &self.measure {
            FieldMeasure::StressNorm { exponent, .. } => self.add_stress_gradient(bodies, *exponent, &mut gradient),
            FieldMeasure::Compliance => self.add_compliance_gradient(bodies, &mut gradient),
        }
        gradient
    }

    /// What `compute` makes of every cell of the region, per body: given its nodes, shear modulus and displacements.
    fn map_cells<T: Send>(
        &self,
        bodies: &[SolvedBody],
        compute: impl Fn(&CellNodes<f64>, f64, &[f64]) -> T + Sync,
    ) -> Vec<Vec<T>> {
        let parts = self.cells.iter().zip(bodies).zip(&*self.bodies);
        let of_body = |((cells, solved), body): ((&Vec<usize>, &SolvedBody), &Body)| {
            let of_cell = |&cell: &usize| {
                let u = body.mesh.cell_values(cell, &solved.displacement);
                compute(&body.mesh.cell_nodes(cell, &solved.positions), body.solid.material(cell).shear_modulus(), &u)
            };
            cells.par_iter().map(of_cell).collect()
        };
        parts.map(of_body).collect()
    }

    /// With r = σ/σ_max, s = Σ V r^p/V₀: dJ = s^{1/p−1}/V₀ Σ (V r^{p−1} dσ + σ_max/p r^p dV).
    fn add_stress_gradient(&self, bodies: &[SolvedBody], exponent: f64, gradient: &mut FieldGradient) {
        let cells = self.map_cells(bodies, CellNodes::stressed);
        let largest = cells.iter().flatten().map(|cell| cell.stress).fold(0.0, f64::max);
        if largest == 0.0 {
            return;
        }
        let terms = cells.iter().flatten().map(|cell| cell.volume * (cell.stress / largest).powf(exponent));
        let sum = terms.sum::<f64>() / self.volume;
        let factor = sum.powf(1.0 / exponent - 1.0) / self.volume;
        let mut first = 0;
        for (number, (places, cells)) in self.cells.iter().zip(&cells).enumerate() {
            let mesh = &bodies[number].mesh;
            for (place, cell) in places.iter().zip(cells) {
                let relative = (cell.stress / largest).powf(exponent - 1.0);
                let by_stress = factor * cell.volume * relative;
                let by_volume = factor * relative * cell.stress / exponent;
                for (local, &node) in mesh.cell(*place).nodes.iter().enumerate() {
                    for axis in 0..3 {
                        gradient.displacements[first + 3 * node as usize + axis] +=
                            by_stress * cell.by_displacement[local][axis];
                        // Only the nodes of the lower body move.
                        if number == 0 && self.map.moves(node) {
                            gradient.positions[node as usize][axis] += by_stress * cell.by_position[local][axis]
                                + by_volume * cell.volume_by_position[local][axis];
                        }
                    }
                }
            }
            first += 3 * mesh.node_count();
        }
    }

    /// l = f, and uᵀ∂f.
    fn add_compliance_gradient(&self, bodies: &[SolvedBody], gradient: &mut FieldGradient) {
        let mut first = 0;
        for (solved, body) in bodies.iter().zip(&*self.bodies) {
            for (node, force) in nodal_forces(body, &solved.positions) {
                for (axis, force) in force.into_iter().enumerate() {
                    gradient.displacements[first + 3 * node as usize + axis] += force;
                }
            }
            first += 3 * body.mesh.node_count();
        }
        if let (Some(lower), Some(body)) = (bodies.first(), self.bodies.first()) {
            let u = |node: u32| lower.displacement[node as usize];
            let moves = |node: u32| self.map.moves(node);
            for (node, value) in load_sensitivities(body, &|_| true, &lower.positions, &u, &moves) {
                if moves(node) {
                    gradient.positions[node as usize] = value;
                }
            }
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

impl<S> Cost<ContactState<S>> for FieldCost {
    fn value(&self, _control: &Vector, state: &ContactState<S>) -> f64 {
        state.bodies.as_ref().map_or(f64::NAN, |bodies| self.value_of(bodies))
    }

    fn gradient(&self, _control: &Vector, state: &ContactState<S>) -> CostGradient {
        let mut dual = vec![0.0; self.row_count];
        let gradient = self.gradient_of(state.bodies.as_deref().unwrap_or_default());
        dual.extend(gradient.displacements);
        let control = if gradient.positions.is_empty() {
            Vector::zeros(self.map.control_count())
        } else {
            Vector::from_vec(self.map.pull_back(&gradient.positions))
        };
        CostGradient { control, state: Vector::from_vec(dual) }
    }
}
