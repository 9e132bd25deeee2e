//! Quantities of the contact forces: resultant force and moment, work of friction, mean pressure, closed area.
//!
//! ```text
//! F = −Σ_i f_i,   M = −Σ_i (x_i − p) × f_i,   W = Σ_i λ_T,i·s_i           f_i = λ_N n + λ_T: on what lies opposite
//! ```
//! method.md (3.14), (3.16). F·e is minus the work of the forces on a translation of the slave nodes, M·e that on a
//! rotation.

use crate::cost::piece::StateGradient;
use crate::cost::row_terms::RowTerms;
use crate::cost::state_view::StateView;
use crate::equilibrium::problem::add_at;
use crate::equilibrium::row_work::NodeValues;
use crate::equilibrium::{ContactProblem, ContactStatus};
use crate::mortar::vector::{cross, dot, length, plus};
use std::ops::Range;

/// The contact nodes of a contact, or of all whose sides may part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ContactNodes(pub Range<usize>);

/// A resultant of the forces on the slave body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Resultant {
    pub nodes: ContactNodes,
    /// The axis; none for the length.
    pub axis: Option<usize>,
    /// The point of a moment; none for a force.
    pub about: Option<[f64; 3]>,
}

impl ContactNodes {
    /// Whether a node belongs to them.
    fn has(&self, index: usize) -> bool {
        self.0.contains(&index)
    }

    /// Leaves of numbers of all packed rows those of these nodes, without the first rows of each.
    fn restrict(&self, problem: &ContactProblem, packed: &mut [f64], first: usize) {
        for (index, point) in problem.boundary.points.iter().enumerate() {
            let dropped = if self.has(index) { first } else { point.row_count() };
            packed[point.start..point.start + dropped].fill(0.0);
        }
    }

    /// Σλ_N/ΣA, MPa; 0 without area.
    pub fn mean_pressure(&self, at: &StateView<'_>) -> f64 {
        let [force, area] = self.force_and_area(at);
        if area > 0.0 { force / area } else { 0.0 }
    }

    fn force_and_area(&self, at: &StateView<'_>) -> [f64; 2] {
        let area = at.rows.nodes[self.0.clone()].iter().map(|node| node.area).sum();
        [at.forces.normal[self.0.clone()].iter().sum(), area]
    }

    /// Its derivatives.
    pub fn mean_pressure_gradient(&self, problem: &ContactProblem, at: &StateView<'_>) -> StateGradient {
        let [force, area] = self.force_and_area(at);
        let mut forces = vec![0.0; problem.boundary.row_count];
        let mut areas = vec![0.0; at.forces.normal.len()];
        if area > 0.0 {
            for index in self.0.clone() {
                forces[problem.boundary.points[index].start] = 1.0 / area;
                areas[index] = -force / (area * area);
            }
        }
        let positions = problem.pull_back_areas(at.rows, &areas);
        StateGradient { forces, displacements: Vec::new(), positions }
    }

    /// Σ A over those that stick or slip, mm².
    pub fn closed_area(&self, at: &StateView<'_>) -> f64 {
        let nodes = self.0.clone().filter(|&index| at.forces.status[index] != ContactStatus::Open);
        nodes.map(|index| at.rows.nodes[index].area).fold(0.0, |sum, area| sum + area)
    }

    /// Σ λ_T·s, N·mm.
    pub fn friction_work(&self, at: &StateView<'_>) -> f64 {
        let forces = at.forces.tangential.iter().zip(&at.forces.slip).enumerate();
        forces.filter(|(index, _)| self.has(*index)).map(|(_, (force, slip))| dot(*force, *slip)).sum()
    }

    /// Its derivatives: the slip is B_T u.
    pub fn friction_work_gradient(&self, terms: RowTerms<'_>) -> StateGradient {
        let (problem, at) = (terms.problem, terms.at);
        let mut tangential = terms.forces();
        self.restrict(problem, &mut tangential, 1);
        let field = |body: usize, node: u32| at.displacement(body, node);
        let u = terms.weighted(&field);
        let mut forces = terms.products(&u);
        self.restrict(problem, &mut forces, 1);
        let mut displacements = vec![0.0; problem.displacement_count()];
        terms.by_field(&tangential, |body, node, share| {
            let first = 3 * problem.map.number(body, node);
            (0..3).for_each(|axis| displacements[first + axis] += share[axis]);
        });
        StateGradient { forces, displacements, positions: terms.by_positions(&tangential, &u, field) }
    }
}

impl Resultant {
    /// F or M along the axes.
    fn vector(&self, terms: RowTerms<'_>, packed: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for index in self.nodes.0.clone() {
            let force = terms.force(index, packed);
            let own = match self.about {
                None => force,
                Some(about) => cross(self.arm(terms, index, about), force),
            };
            sum = plus(sum, -1.0, own);
        }
        sum
    }

    fn arm(&self, terms: RowTerms<'_>, index: usize, about: [f64; 3]) -> [f64; 3] {
        let point = &terms.problem.boundary.points[index];
        plus(terms.at.bodies[point.body].positions[point.node as usize], -1.0, about)
    }

    /// The component, or the length.
    pub fn value(&self, terms: RowTerms<'_>) -> f64 {
        component(self.vector(terms, &terms.forces()), self.axis)
    }

    /// Its derivatives.
    pub fn gradient(&self, terms: RowTerms<'_>) -> StateGradient {
        let (problem, mut packed) = (terms.problem, terms.forces());
        let along = direction(self.vector(terms, &packed), self.axis);
        let mut field = NodeValues::zeros(problem.bodies.len());
        self.nodes.restrict(problem, &mut packed, 0);
        for index in self.nodes.0.clone() {
            let point = &problem.boundary.points[index];
            let motion = match self.about {
                None => along,
                Some(about) => cross(along, self.arm(terms, index, about)),
            };
            field.add_to(point.body, point.node, motion.map(|w| -w));
        }
        let mut forces = terms.products(&field);
        self.nodes.restrict(problem, &mut forces, 0);
        // The motion of the slave nodes alone: masters have none, and weights of a node in its own rows do not change.
        let mut positions = terms.by_positions(&packed, &field, |_, _| [0.0; 3]);
        if self.about.is_some() {
            for index in self.nodes.0.clone() {
                let (point, force) = (&problem.boundary.points[index], terms.force(index, &packed));
                if problem.map.moves(point.body, point.node) {
                    let turned = cross(along, force);
                    add_at(&mut positions, problem.node_number(point.body, point.node), turned);
                }
            }
        }
        StateGradient { forces, displacements: Vec::new(), positions }
    }
}

/// A component of a vector, or its length.
pub(super) fn component(vector: [f64; 3], axis: Option<usize>) -> f64 {
    axis.map_or_else(|| length(vector), |axis| vector[axis])
}

/// The derivative of that by the vector; 0 for the length at 0, one of its subgradients.
pub(super) fn direction(vector: [f64; 3], axis: Option<usize>) -> [f64; 3] {
    match axis {
        Some(axis) => std::array::from_fn(|own| f64::from(u8::from(own == axis))),
        None => {
            let size = length(vector);
            if size > 0.0 { vector.map(|own| own / size) } else { [0.0; 3] }
        }
    }
}
