//! Forward derivative of the condensed problem: all columns on one factorisation; method.md (5.4).
//!
//! ```text
//! r = −∂(K u + Bᵀλ − f),   r_c: what it puts on the contact dofs,   δd = B C r_c + ∂B u − ∂g,   δe = Nᵀ r_c
//! M (δλ; δa) = (D δd; δe),   M = ∂(λ − Π(λ + w), Rᵀλ − e)/∂(λ, a),   δw = δd − C δλ + R δa
//! ```
//! The adjoint solves with Mᵀ what is solved here with M. Rigid motions of bodies of fixed shape do not change; what
//! those of other bodies change is part of r.

use crate::direct::compliant_body::{ContactBody, Response};
use crate::direct::compliant_contact::CompliantContact;
use crate::direct::newton::SPRINGS;
use crate::direct::newton::active_system;
use crate::equilibrium::Tangents;
use crate::equilibrium::law::{Friction, Linearization};
use crate::linear::dense::{DenseLu, multiply, multiply_columns};
use crate::linear::vector::norm;
use faer::Mat;
use nalgebra::DVector;

/// What some changes of the shape do to the contact problem, one column or vector per change.
pub(super) struct ShapeLoads {
    /// What they do to the contact dofs of every body.
    pub responses: Vec<Response>,
    /// Forces on the contact dofs that turned contact rows cause, N.
    pub turned: Vec<Mat<f64>>,
    /// ∂B u − ∂g over the packed rows, mm.
    pub approaches: Vec<Vec<f64>>,
    /// Changes of the areas of the contact nodes, mm².
    pub areas: Vec<Vec<f64>>,
}

/// Tangents of the condensed problem.
pub(super) struct CondensedTangents {
    /// Forces and openings.
    pub tangents: Tangents,
    /// δa per change, dimensionless.
    pub amplitudes: Vec<Vec<f64>>,
}

/// Tangents of forces and openings at given derivatives, for what changes of the shape do to the contact problem.
pub(super) fn tangents(
    contact: &CompliantContact,
    linearizations: &[Linearization],
    loads: &ShapeLoads,
) -> CondensedTangents {
    let ShapeLoads { responses, approaches, .. } = loads;
    let boundary = &contact.problem.boundary;
    let (count, motions) = (contact.row_count(), contact.resultant.len());
    let active = active_system(contact, linearizations, 0.0, Friction::Coulomb);
    let size = active.rows.len();
    let mut sprung = active.matrix.clone();
    for motion in size..size + motions {
        sprung[(motion, motion)] = SPRINGS[0];
    }
    let driving = |(column, approach): (usize, &Vec<f64>)| driving(contact, responses, column, approach);
    let driven: Vec<(Vec<f64>, Vec<f64>)> = approaches.iter().enumerate().map(driving).collect();
    let mut right = Mat::<f64>::zeros(size + motions, approaches.len());
    for (column, (constant, resultant)) in driven.iter().enumerate() {
        let right = right.col_as_slice_mut(column);
        let mut row = 0;
        for (node, linearization) in boundary.points.iter().zip(linearizations) {
            if *linearization == Linearization::Open {
                continue;
            }
            let block = linearization.derivative(node.row_count(), node.friction);
            for coefficients in block.iter().take(node.row_count()) {
                right[row] = coefficients.iter().zip(&constant[node.rows()]).map(|(d, w)| d * w).sum();
                row += 1;
            }
        }
        right[size..].copy_from_slice(resultant);
    }
    let (solution, residual) = refined(&DenseLu::new(&sprung), &active.matrix, right);
    let (forces, openings) = (Vec::new(), Vec::new());
    let areas = loads.areas.clone();
    let mut tangents = Tangents { forces, openings, areas, displacements: None, residual, applications: 0 };
    let mut amplitudes = Vec::new();
    for (column, (constant, _)) in driven.iter().enumerate() {
        let solution = solution.col_as_slice(column);
        let mut forces = vec![0.0; count];
        for (&row, value) in active.rows.iter().zip(solution) {
            forces[row] = *value;
        }
        let (product, rigid) = (multiply(&contact.compliance, &forces), multiply(&contact.motions, &solution[size..]));
        let opening = |start: usize| (constant[start] - product[start] + rigid[start]) * contact.unit * contact.load;
        tangents.openings.push(boundary.points.iter().map(|point| opening(point.start)).collect());
        forces.iter_mut().for_each(|force| *force *= contact.load);
        tangents.forces.push(forces);
        amplitudes.push(solution[size..].to_vec());
    }
    CondensedTangents { tangents, amplitudes }
}

/// δd and δe, dimensionless, of a column of what moves the contact dofs and of ∂B u − ∂g.
fn driving(
    contact: &CompliantContact,
    responses: &[Response],
    column: usize,
    approach: &[f64],
) -> (Vec<f64>, Vec<f64>) {
    let mut constant = approach.to_vec();
    let mut own = Vec::new();
    for (ContactBody { rows, .. }, response) in contact.bodies.iter().zip(responses) {
        rows.add_jumps(response.displacement.col_as_slice(column), 1.0, &mut constant);
        own.extend(response.resultants.col_as_slice(column).iter().map(|resultant| resultant / contact.load));
    }
    constant.iter_mut().for_each(|d| *d /= contact.unit * contact.load);
    (constant, contact.resultants_of(&DVector::from_vec(own)))
}

/// M⁻¹ B by a factor of a matrix near M, refined against M; also the largest relative residual of a column.
fn refined(factor: &DenseLu, matrix: &Mat<f64>, right: Mat<f64>) -> (Mat<f64>, f64) {
    let mut solution = right.clone();
    factor.solve_columns_in_place(&mut solution);
    let mut rest = &right - multiply_columns(matrix, &solution);
    for _refinement in 0..2 {
        let mut correction = rest.clone();
        factor.solve_columns_in_place(&mut correction);
        let better = &solution + correction;
        let remaining = &right - multiply_columns(matrix, &better);
        for column in 0..right.ncols() {
            if norm(remaining.col_as_slice(column)) < norm(rest.col_as_slice(column)) {
                solution.col_as_slice_mut(column).copy_from_slice(better.col_as_slice(column));
                rest.col_as_slice_mut(column).copy_from_slice(remaining.col_as_slice(column));
            }
        }
    }
    let relative = (0..right.ncols()).map(|column| {
        let size = norm(right.col_as_slice(column));
        if size > 0.0 { norm(rest.col_as_slice(column)) / size } else { 0.0 }
    });
    let residual = relative.fold(0.0, f64::max);
    (solution, residual)
}
