//! Costs of the displacements: stress norm in a region, compliance; method.md (3.7), (3.8), (5.5) to (5.7).
//!
//! ```text
//! J = ((1/V₀) Σ_e V_e σ_vM,e^p)^{1/p}      or      J = f·u            l = ∂J/∂u: a load in the adjoint problem
//! ```
//! What J depends on the shape at fixed displacements is ∇₁J of the framework: volumes and stresses of bricks whose
//! nodes move, and loads on faces whose area changes. Only the lower body changes its shape.

use crate::body::elasticity::brick::DOFS;
use crate::body::elasticity::von_mises::{StressedBrick, stress_and_volume};
use crate::body::mesh::{Block, Grid, Subdomain};
use crate::body::shape_load::{height_derivative, loaded_faces, nodal_loads};
use crate::cost::region::{Region, RegionBricks};
use crate::equilibrium::{ContactProblem, ContactState, SolvedBody};
use crate::error::SceneError;
use crate::scene::BodyScene;
use crate::shape::HeightMap;
use nonsmooth::{Cost, CostGradient, Vector};
use rayon::prelude::*;

/// A function of the displacements of the bodies.
#[derive(Debug, Clone, PartialEq)]
pub enum FieldMeasure {
    /// ((1/V₀) Σ V_e σ_vM,e^p)^{1/p}, MPa: a mean of the von Mises stress at the centres of the bricks of a region, the
    /// closer to its largest value the larger p is. V₀ is the volume of the region at the start height.
    StressNorm {
        /// The bricks that count.
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
    /// Bricks of the region per body; none for the compliance.
    bricks: Vec<Vec<[usize; 3]>>,
    /// The volume V₀ of the region, mm³.
    volume: f64,
    grid: Grid,
    bodies: Vec<BodyScene>,
    height_map: HeightMap,
    /// Entries of a dual before those of the displacements.
    dual_dimension: usize,
}

/// The derivatives of J at a state.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldGradient {
    /// ∂J/∂u, three entries per node of every body, lower first, unit of J per mm.
    pub displacements: Vec<f64>,
    /// ∂J/∂(height of a contact node) at fixed displacements, unit of J per mm.
    pub heights: Vec<f64>,
}

impl FieldCost {
    /// The cost on the bodies of a problem.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless the exponent is finite and > 1, and as [`Region::bricks`].
    pub fn new(measure: FieldMeasure, problem: &ContactProblem) -> Result<Self, SceneError> {
        let (mut bricks, mut volume) = (Vec::new(), 1.0);
        if let FieldMeasure::StressNorm { region, exponent } = &measure {
            let valid = *exponent > 1.0 && exponent.is_finite();
            SceneError::require(valid, "objective.exponent", exponent, "a finite number > 1")?;
            RegionBricks { bricks, volume } = region.bricks(problem)?;
        }
        Ok(Self {
            measure,
            bricks,
            volume,
            grid: problem.grid,
            bodies: problem.bodies().cloned().collect(),
            height_map: problem.height_map.clone(),
            dual_dimension: problem.boundary.dual_dimension(),
        })
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
                let stresses = self.map_bricks(bodies, stress_and_volume);
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
                let works = bodies.iter().zip(&self.bodies).map(|(body, scene)| {
                    let loads = nodal_loads(&body.block, &Subdomain::whole(&self.grid), &scene.loads);
                    loads.iter().zip(body.displacement.as_flattened()).map(|(force, u)| force * u).sum::<f64>()
                });
                works.sum()
            }
        }
    }

    /// The derivatives of J at solved bodies, lower first.
    pub fn gradient_of(&self, bodies: &[SolvedBody]) -> FieldGradient {
        match &self.measure {
            FieldMeasure::StressNorm { exponent, .. } => self.stress_gradient(bodies, *exponent),
            FieldMeasure::Compliance => self.compliance_gradient(bodies),
        }
    }

    /// What `compute` makes of every brick of the region, per body: given its nodes, shear modulus and displacements.
    fn map_bricks<T: Send>(
        &self,
        bodies: &[SolvedBody],
        compute: impl Fn(&[[f64; 3]; 8], f64, &[f64; DOFS]) -> T + Sync,
    ) -> Vec<Vec<T>> {
        let parts = self.bricks.iter().zip(bodies).zip(&self.bodies);
        let of_body = |((bricks, body), scene): ((&Vec<[usize; 3]>, &SolvedBody), &BodyScene)| {
            let of_brick = |brick: &[usize; 3]| {
                let corners = self.grid.brick_nodes(*brick);
                let u = std::array::from_fn(|dof| body.displacement[corners[dof / 3]][dof % 3]);
                compute(&body.block.brick(*brick), scene.material.shear_modulus(), &u)
            };
            bricks.par_iter().map(of_brick).collect()
        };
        parts.map(of_body).collect()
    }

    /// With r = σ/σ_max, s = Σ V r^p/V₀: dJ = s^{1/p−1}/V₀ Σ (V r^{p−1} dσ + σ_max/p r^p dV).
    fn stress_gradient(&self, bodies: &[SolvedBody], exponent: f64) -> FieldGradient {
        let bricks = self.map_bricks(bodies, StressedBrick::new);
        let largest = bricks.iter().flatten().map(|brick| brick.stress).fold(0.0, f64::max);
        let mut gradient = self.no_gradient(bodies.len());
        if largest == 0.0 {
            return gradient;
        }
        let terms = bricks.iter().flatten().map(|brick| brick.volume * (brick.stress / largest).powf(exponent));
        let sum = terms.sum::<f64>() / self.volume;
        let factor = sum.powf(1.0 / exponent - 1.0) / self.volume;
        let mut moved = vec![0.0; self.grid.node_count()];
        for (body, (places, bricks)) in self.bricks.iter().zip(&bricks).enumerate() {
            let first = 3 * self.grid.node_count() * body;
            for (place, brick) in places.iter().zip(bricks) {
                let relative = (brick.stress / largest).powf(exponent - 1.0);
                let by_stress = factor * brick.volume * relative;
                let by_volume = factor * relative * brick.stress / exponent;
                for (a, node) in self.grid.brick_nodes(*place).into_iter().enumerate() {
                    for component in 0..3 {
                        gradient.displacements[first + 3 * node + component] +=
                            by_stress * brick.by_displacement[3 * a + component];
                    }
                    // Only the nodes of the lower body move.
                    if body == 0 {
                        moved[node] += by_stress * brick.by_height[a] + by_volume * brick.volume_by_height[a];
                    }
                }
            }
        }
        gradient.heights = self.columns(&moved);
        gradient
    }

    /// l = f, and uᵀ∂f.
    fn compliance_gradient(&self, bodies: &[SolvedBody]) -> FieldGradient {
        let mut gradient = self.no_gradient(bodies.len());
        let parts =
            bodies.iter().zip(&self.bodies).zip(gradient.displacements.chunks_exact_mut(3 * self.grid.node_count()));
        for ((body, scene), loads) in parts {
            loads.copy_from_slice(&nodal_loads(&body.block, &Subdomain::whole(&self.grid), &scene.loads));
        }
        if let (Some(lower), Some(scene)) = (bodies.first(), self.bodies.first()) {
            gradient.heights = self.columns(&load_sensitivities(&lower.block, scene, &lower.displacement));
        }
        gradient
    }

    fn no_gradient(&self, bodies: usize) -> FieldGradient {
        FieldGradient {
            displacements: vec![0.0; 3 * self.grid.node_count() * bodies],
            heights: vec![0.0; self.grid.column_count()],
        }
    }

    /// From derivatives by x₃ of the nodes of the lower body to those by the heights of its columns.
    fn columns(&self, nodes: &[f64]) -> Vec<f64> {
        let layers = self.grid.cells[2];
        let share = |k: usize| k as f64 / layers as f64;
        let sum = |(i, j)| (0..=layers).map(|k| share(k) * nodes[self.grid.node([i, j, k])]).sum();
        self.grid.columns().map(sum).collect()
    }
}

/// The sensitivities uᵀ∂f/∂x₃ per node.
fn load_sensitivities(block: &Block, scene: &BodyScene, displacement: &[[f64; 3]]) -> Vec<f64> {
    let grid = &block.grid;
    let mut nodes = vec![0.0; grid.node_count()];
    for load in &scene.loads {
        for face in loaded_faces(grid, load.face, None) {
            let u = |node| displacement[grid.node(node)];
            height_derivative(block, &face, load.traction, u, |node, value| nodes[grid.node(node)] += value);
        }
    }
    nodes
}

impl<S> Cost<ContactState<S>> for FieldCost {
    fn value(&self, _control: &Vector, state: &ContactState<S>) -> f64 {
        state.bodies.as_ref().map_or(f64::NAN, |bodies| self.value_of(bodies))
    }

    fn gradient(&self, _control: &Vector, state: &ContactState<S>) -> CostGradient {
        let mut dual = vec![0.0; self.dual_dimension];
        let gradient = self.gradient_of(state.bodies.as_deref().unwrap_or_default());
        dual.extend(gradient.displacements);
        CostGradient {
            control: Vector::from_vec(self.height_map.pull_back(&gradient.heights)),
            state: Vector::from_vec(dual),
        }
    }
}
