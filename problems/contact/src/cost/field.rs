//! Costs of the displacements: stress norm in a region, compliance, largest stress, largest or smallest displacement;
//! method.md (3.7), (3.8), (5.5) to (5.7).
//!
//! ```text
//! J = ((1/V₀) Σ_e V_e σ_vM,e^p)^{1/p},     J = f·u,     J = max of points         l = ∂J/∂u: a load in the adjoint problem
//! ```
//! What J depends on the shape at fixed displacements is ∇₁J of the framework: volumes and stresses of cells whose
//! nodes move, and loads that depend on the shape.

use crate::body::Body;
use crate::body::elasticity::CellNodes;
use crate::body::loads::{load_sensitivities, nodal_forces};
use crate::cost::extreme::{Extreme, Points};
use crate::cost::field_measure::FieldMeasure;
use crate::cost::field_piece::{FieldGradient, FieldPiece};
use crate::cost::region::RegionCells;
use crate::equilibrium::{ContactProblem, ContactState, SolvedBody};
use crate::error::SceneError;
use crate::shape::ShapeMap;
use nonsmooth::{Cost, CostGradient, Vector};
use std::sync::Arc;

/// J(α, u) as a measure of the displacements, for states of a map
/// [with displacements](crate::contact_shape::ContactShape::with_displacements). The value at another state is not a
/// number.
#[derive(Debug, Clone)]
pub struct FieldCost {
    measure: FieldMeasure,
    function: Function,
    bodies: Arc<[Body]>,
    map: Arc<ShapeMap>,
    /// Entries of a dual before those of the displacements.
    row_count: usize,
}

/// A measure on the mesh of a problem.
#[derive(Debug, Clone)]
enum Function {
    StressNorm { cells: RegionCells, exponent: f64 },
    Compliance,
    Extreme(Extreme),
}

impl FieldCost {
    /// The cost on the bodies of a problem, as the objective of a scene.
    ///
    /// # Errors
    /// As [`FieldCost::named`].
    pub fn new(measure: FieldMeasure, problem: &ContactProblem) -> Result<Self, SceneError> {
        Self::named("objective", measure, problem)
    }

    /// The cost on the bodies of a problem; `place`: what messages call the table that has the measure.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless the exponent is finite and > 1, for an axis beyond 2, for the smallest length
    /// of displacements, for a region of held cells alone that leaves them out, and as [`Region::cells`] and
    /// [`Region::nodes`](crate::cost::Region::nodes).
    ///
    /// [`Region::cells`]: crate::cost::Region::cells
    pub fn named(place: &str, measure: FieldMeasure, problem: &ContactProblem) -> Result<Self, SceneError> {
        measure.check(place)?;
        let (bodies, map) = (Arc::clone(&problem.bodies), Arc::clone(&problem.map));
        let extreme = |points, least| {
            let (bodies, map) = (Arc::clone(&problem.bodies), Arc::clone(&problem.map));
            Function::Extreme(Extreme { points, least, bodies, map })
        };
        let function = match &measure {
            FieldMeasure::StressNorm { region, exponent } => {
                Function::StressNorm { cells: region.cells(place, problem)?, exponent: *exponent }
            }
            FieldMeasure::Compliance => Function::Compliance,
            FieldMeasure::PeakStress { region, without_held } => {
                let mut cells = region.cells(place, problem)?;
                if *without_held {
                    leave_out_held(place, &bodies, &mut cells)?;
                }
                extreme(Points::Stresses(cells), false)
            }
            FieldMeasure::Displacement { region, component, least } => {
                let nodes = region.nodes(place, problem)?;
                extreme(Points::Displacements { nodes, component: *component }, *least)
            }
        };
        Ok(Self { measure, function, bodies, map, row_count: problem.boundary.row_count })
    }

    /// The unit of the value.
    pub fn unit(&self) -> &'static str {
        self.measure.unit()
    }

    /// Whether J has a gradient wherever the contact state has one; false for maxima and minima over points.
    pub fn is_smooth(&self) -> bool {
        self.measure.is_smooth()
    }

    /// J of solved bodies.
    pub fn value_of(&self, bodies: &[SolvedBody]) -> f64 {
        match &self.function {
            Function::StressNorm { cells, exponent } => {
                let stresses = cells.map(&self.bodies, bodies, |cell, shear_modulus, u| {
                    (cell.von_mises(shear_modulus, u), cell.volume())
                });
                let largest = stresses.iter().flatten().map(|(stress, _)| *stress).fold(0.0, f64::max);
                if largest == 0.0 {
                    return 0.0;
                }
                // Relative to the largest stress, so that no power leaves the range of doubles.
                let terms =
                    stresses.iter().flatten().map(|(stress, volume)| volume * (stress / largest).powf(*exponent));
                largest * (terms.sum::<f64>() / cells.volume).powf(1.0 / exponent)
            }
            Function::Compliance => {
                let works = bodies.iter().zip(&*self.bodies).map(|(solved, body)| {
                    let forces = nodal_forces(body, &solved.positions).into_iter();
                    let work = |(node, force): (u32, [f64; 3])| dot(force, solved.displacement[node as usize]);
                    forces.map(work).sum::<f64>()
                });
                works.sum()
            }
            Function::Extreme(extreme) => extreme.value(bodies),
        }
    }

    /// The derivatives of J at solved bodies: of a maximum or minimum over points those of the first
    /// extreme one, which is one subgradient of a maximum of such functions.
    pub fn gradient_of(&self, bodies: &[SolvedBody]) -> FieldGradient {
        let node_count = bodies.iter().map(|body| body.mesh.node_count()).sum::<usize>();
        let zero = FieldPiece { value: 0.0, displacements: Vec::new(), positions: Vec::new() };
        if let Function::Extreme(extreme) = &self.function {
            return extreme.first(bodies).unwrap_or(zero).gradient(node_count);
        }
        let mut gradient = zero.gradient(node_count);
        match &self.function {
            Function::StressNorm { cells, exponent } => {
                self.add_stress_gradient(bodies, cells, *exponent, &mut gradient)
            }
            Function::Compliance => self.add_compliance_gradient(bodies, &mut gradient),
            Function::Extreme(_) => {}
        }
        gradient
    }

    /// The smooth functions of which J is made near solved bodies. One piece, J itself, for smooth
    /// measures. For a maximum the points whose values are within a tenth of it, at most 200, the largest first; for a
    /// minimum those within a tenth of the largest absolute value above it, the smallest first. Values and derivatives
    /// have the sign of the displacements, for a minimum too: J is the smallest of its pieces then.
    pub fn pieces_of(&self, bodies: &[SolvedBody]) -> Vec<FieldPiece> {
        match &self.function {
            Function::Extreme(extreme) => extreme.pieces(bodies),
            Function::StressNorm { .. } | Function::Compliance => {
                vec![FieldPiece::of(self.value_of(bodies), &self.gradient_of(bodies))]
            }
        }
    }

    /// With r = σ/σ_max, s = Σ V r^p/V₀: dJ = s^{1/p−1}/V₀ Σ (V r^{p−1} dσ + σ_max/p r^p dV).
    fn add_stress_gradient(
        &self,
        bodies: &[SolvedBody],
        region: &RegionCells,
        exponent: f64,
        gradient: &mut FieldGradient,
    ) {
        let cells = region.map(&self.bodies, bodies, CellNodes::stressed);
        let largest = cells.iter().flatten().map(|cell| cell.stress).fold(0.0, f64::max);
        if largest == 0.0 {
            return;
        }
        let terms = cells.iter().flatten().map(|cell| cell.volume * (cell.stress / largest).powf(exponent));
        let sum = terms.sum::<f64>() / region.volume;
        let factor = sum.powf(1.0 / exponent - 1.0) / region.volume;
        let mut first = 0;
        for (number, (places, cells)) in region.cells.iter().zip(&cells).enumerate() {
            let mesh = &bodies[number].mesh;
            for (place, cell) in places.iter().zip(cells) {
                let relative = (cell.stress / largest).powf(exponent - 1.0);
                let by_stress = factor * cell.volume * relative;
                let by_volume = factor * relative * cell.stress / exponent;
                for (local, &node) in mesh.cell(*place).nodes.iter().enumerate() {
                    for axis in 0..3 {
                        gradient.displacements[first + 3 * node as usize + axis] +=
                            by_stress * cell.by_displacement[local][axis];
                        if self.map.moves(number, node) {
                            gradient.positions[first / 3 + node as usize][axis] += by_stress
                                * cell.by_position[local][axis]
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
        for (number, (solved, body)) in bodies.iter().zip(&*self.bodies).enumerate() {
            for (node, force) in nodal_forces(body, &solved.positions) {
                for (axis, force) in force.into_iter().enumerate() {
                    gradient.displacements[first + 3 * node as usize + axis] += force;
                }
            }
            let u = |node: u32| solved.displacement[node as usize];
            let moves = |node: u32| self.map.moves(number, node);
            for (node, value) in load_sensitivities(body, &|_| true, &solved.positions, &u, &moves) {
                if moves(node) {
                    gradient.positions[first / 3 + node as usize] = value;
                }
            }
            first += 3 * body.mesh.node_count();
        }
    }
}

/// Takes cells off that have a node held by a support of their body.
fn leave_out_held(place: &str, bodies: &[Body], cells: &mut RegionCells) -> Result<(), SceneError> {
    for (cells, body) in cells.cells.iter_mut().zip(bodies) {
        let held = body.held_nodes();
        cells.retain(|&cell| body.mesh.cell(cell).nodes.iter().all(|node| held.binary_search(node).is_err()));
    }
    let any = cells.cells.iter().any(|cells| !cells.is_empty());
    let allowed = "false: supports hold a node of every cell of the region";
    SceneError::require(any, format!("{place}.without_held"), true, allowed)
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
