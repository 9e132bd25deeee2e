//! Functions of the shape alone: volume and mass.

use crate::cost::Quantity;
use crate::equilibrium::ContactProblem;
use crate::error::SceneError;
use crate::shape::Positions;
use nonsmooth::Vector;

/// kg per mm³ of a density in kg/m³.
const PER_CUBIC_MILLIMETRE: f64 = 1e-9;

/// Σ ρ V over some bodies, as a function of the controls.
#[derive(Debug, Clone)]
pub struct ShapeFunction {
    /// The bodies that count, with ρ by volume of their meshes.
    bodies: Vec<(usize, Vec<f64>)>,
}

impl ShapeFunction {
    /// The function of a quantity [of the shape](Quantity::is_of_shape); none for other quantities. `place`: what
    /// messages call the table that has it.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for the mass of bodies without densities, and of a body some of whose volumes have
    /// one and some have none.
    pub(crate) fn new(place: &str, quantity: &Quantity, problem: &ContactProblem) -> Result<Option<Self>, SceneError> {
        let uniform = |factor: f64| {
            let of_body = |body: usize| (body, vec![factor; problem.bodies[body].solid.materials().len()]);
            Self { bodies: problem.map.shaped_bodies().map(of_body).collect() }
        };
        Ok(match quantity {
            Quantity::Volume => Some(uniform(1.0)),
            Quantity::RelativeVolume => {
                let start = uniform(1.0).value_at(problem, &problem.start_positions());
                Some(uniform(1.0 / start))
            }
            Quantity::Mass => Some(Self { bodies: densities(place, problem)? }),
            _ => None,
        })
    }

    /// The value at some controls.
    pub(crate) fn value(&self, problem: &ContactProblem, controls: &[f64]) -> f64 {
        self.value_at(problem, &problem.map.positions(controls))
    }

    fn value_at(&self, problem: &ContactProblem, positions: &Positions) -> f64 {
        let of_body = |(body, factors): &(usize, Vec<f64>)| {
            let mesh = &problem.bodies[*body].mesh;
            let of_cell =
                |cell: usize| factors[mesh.volume_of(cell)] * mesh.cell_nodes(cell, &positions[*body]).volume();
            (0..mesh.cell_count()).map(of_cell).sum::<f64>()
        };
        self.bodies.iter().map(of_body).sum()
    }

    /// Its derivative by the positions of the points of all bodies.
    pub(crate) fn slope(&self, problem: &ContactProblem, controls: &[f64]) -> Vec<[f64; 3]> {
        let positions = problem.map.positions(controls);
        let mut slope = problem.no_sensitivities();
        for (body, factors) in &self.bodies {
            let mesh = &problem.bodies[*body].mesh;
            for cell in 0..mesh.cell_count() {
                let factor = factors[mesh.volume_of(cell)];
                let derivative = mesh.cell_nodes(cell, &positions[*body]).volume_derivative();
                for (&node, own) in mesh.cell(cell).nodes.iter().zip(derivative) {
                    let sum = &mut slope[problem.node_number(*body, node)];
                    (0..3).for_each(|axis| sum[axis] += factor * own[axis]);
                }
            }
        }
        slope
    }

    /// Its derivative by the controls.
    pub(crate) fn gradient(&self, problem: &ContactProblem, controls: &[f64]) -> Vector {
        Vector::from_vec(problem.map.pull_back(&self.slope(problem, controls)))
    }
}

/// The bodies with densities, kg/mm³ by volume.
fn densities(place: &str, problem: &ContactProblem) -> Result<Vec<(usize, Vec<f64>)>, SceneError> {
    let mut found = Vec::new();
    for (number, body) in problem.bodies.iter().enumerate() {
        let own: Vec<Option<f64>> = body.solid.materials().iter().map(|material| material.density()).collect();
        if own.iter().all(Option::is_none) {
            continue;
        }
        let missing = own.iter().position(Option::is_none);
        if let Some(volume) = missing {
            let value = format!("mass, without a density of volume \"{}\"", body.mesh.volumes()[volume]);
            let allowed = format!("a density in all materials of \"{}\"", body.name);
            return Err(SceneError::out_of_range(format!("{place}.quantity"), value, allowed));
        }
        found.push((number, own.into_iter().flatten().map(|density| PER_CUBIC_MILLIMETRE * density).collect()));
    }
    let allowed = "a scene with material.density (kg/m³) of at least one body";
    SceneError::require(!found.is_empty(), format!("{place}.quantity"), "mass", allowed)?;
    Ok(found)
}
