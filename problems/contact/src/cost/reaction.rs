//! The resultant of the forces that the supports of a face exert on its body; method.md (3.15).
//!
//! ```text
//! R·e = Σ_nodes w·(K u − f) + Σ_r λ_r (B w)_r,     w = Σ (d·e) d over the directions d that the supports hold at a node
//! ```

use crate::body::Body;
use crate::body::loads::{load_sensitivities, nodal_forces};
use crate::cost::contact_work::{component, direction};
use crate::cost::piece::StateGradient;
use crate::cost::row_terms::RowTerms;
use crate::equilibrium::problem::add_at;
use crate::mortar::vector::{dot, plus};

/// A resultant of reactions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reaction {
    /// The body.
    pub body: usize,
    /// Its supports, by their places in the scene.
    pub supports: Vec<usize>,
    /// The axis; none for the length.
    pub axis: Option<usize>,
}

impl Reaction {
    fn body<'a>(&self, terms: RowTerms<'a>) -> &'a Body {
        &terms.problem.bodies[self.body]
    }

    /// w per node of the body for a direction e.
    fn field(&self, terms: RowTerms<'_>, along: [f64; 3]) -> Vec<[f64; 3]> {
        let body = self.body(terms);
        let mut field = vec![[0.0; 3]; body.mesh.node_count()];
        for node in body.held_nodes() {
            for (d, _) in body.held_by(node).filter(|(_, support)| self.supports.contains(support)) {
                field[node as usize] = plus(field[node as usize], dot(d, along), d);
            }
        }
        field
    }

    /// R·e.
    fn along(&self, terms: RowTerms<'_>, along: [f64; 3]) -> f64 {
        let (w, solved) = (self.field(terms, along), &terms.at.bodies[self.body]);
        let stiff = self.body(terms).solid.internal_forces(&solved.positions, &w);
        let internal: f64 = stiff.iter().zip(&solved.displacement).map(|(force, u)| dot(*force, *u)).sum();
        let loads = nodal_forces(self.body(terms), &solved.positions).into_iter();
        let external: f64 = loads.map(|(node, force)| dot(force, w[node as usize])).sum();
        let weighted = terms.weighted(&|body, node| self.at(&w, body, node));
        let contact: f64 = terms.products(&weighted).iter().zip(terms.forces()).map(|(own, force)| own * force).sum();
        internal - external + contact
    }

    fn at(&self, w: &[[f64; 3]], body: usize, node: u32) -> [f64; 3] {
        if body == self.body { w[node as usize] } else { [0.0; 3] }
    }

    fn vector(&self, terms: RowTerms<'_>) -> [f64; 3] {
        std::array::from_fn(|axis| self.along(terms, direction([0.0; 3], Some(axis))))
    }

    /// The component, or the length, N.
    pub fn value(&self, terms: RowTerms<'_>) -> f64 {
        match self.axis {
            Some(axis) => self.along(terms, direction([0.0; 3], Some(axis))),
            None => component(self.vector(terms), None),
        }
    }

    /// Its derivatives.
    pub fn gradient(&self, terms: RowTerms<'_>) -> StateGradient {
        let (problem, body, solved) = (terms.problem, self.body(terms), &terms.at.bodies[self.body]);
        let along = direction(if self.axis.is_none() { self.vector(terms) } else { [0.0; 3] }, self.axis);
        let w = self.field(terms, along);
        let mut displacements = vec![0.0; problem.displacement_count()];
        for (node, force) in body.solid.internal_forces(&solved.positions, &w).into_iter().enumerate() {
            let first = 3 * problem.map.number(self.body, node as u32);
            (0..3).for_each(|axis| displacements[first + axis] = force[axis]);
        }
        let field = |body: usize, node: u32| self.at(&w, body, node);
        let weighted = terms.weighted(&field);
        let forces = terms.products(&weighted);
        let mut positions = terms.by_positions(&terms.forces(), &weighted, field);
        let moves = |node: u32| problem.map.moves(self.body, node);
        for cell in 0..body.mesh.cell_count() {
            let (nodes, own) = (body.mesh.cell(cell).nodes, body.mesh.cell_values(cell, &w));
            if own.iter().all(|entry| *entry == 0.0) || !nodes.iter().any(|node| moves(*node)) {
                continue;
            }
            let u = body.mesh.cell_values(cell, &solved.displacement);
            let shape = body.mesh.cell_nodes(cell, &solved.positions);
            let derivative = shape.position_derivative(body.solid.material(cell), &u, &own);
            for (&node, own) in nodes.iter().zip(derivative).filter(|(node, _)| moves(**node)) {
                add_at(&mut positions, problem.node_number(self.body, node), own);
            }
        }
        let w = |node: u32| w[node as usize];
        for (node, value) in load_sensitivities(body, &|_| true, &solved.positions, &w, &moves) {
            if moves(node) {
                add_at(&mut positions, problem.node_number(self.body, node), value.map(|own| -own));
            }
        }
        StateGradient { forces, displacements, positions }
    }
}
