//! Forward derivative of the condensed problem: all columns on one factorisation; method.md (5.4).
//!
//! ```text
//! r = −∂(K u + Bᵀλ − f),   r_c: what it puts on the contact dofs,   δd = B C r_c + ∂B u − ∂g,   δe = Nᵀ r_c
//! M (δλ; δa) = (D δd; δe),   M = ∂(λ − Π(λ + w), Rᵀλ − e)/∂(λ, a),   δw = δd − C δλ + R δa
//! ```
//! The adjoint solves with Mᵀ what is solved here with M. Rigid motions of bodies of fixed shape do not change; what
//! those of other bodies change is part of r.

use crate::direct::active_system::ActiveFactor;
use crate::direct::compliant_body::{ContactBody, Response};
use crate::direct::compliant_contact::CompliantContact;
use crate::equilibrium::Tangents;
use crate::equilibrium::law::Linearization;
use crate::linear::dense::{multiply, multiply_columns};
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

/// Tangents of forces and openings at given derivatives, with the factor of Newton's matrix there, for what changes of
/// the shape do to the contact problem.
pub(super) fn tangents(
    contact: &CompliantContact,
    (linearizations, active): (&[Linearization], &ActiveFactor),
    loads: &ShapeLoads,
) -> CondensedTangents {
    let ShapeLoads { responses, approaches, .. } = loads;
    let boundary = &contact.problem.boundary;
    let (size, motions) = (active.rows().len(), contact.resultant.len());
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
    let (solution, residual) = active.solve_columns(contact, &right);
    let forces = active.forces(contact, &solution);
    let products = multiply_columns(&contact.compliance, &forces);
    let areas = loads.areas.clone();
    let (of_forces, openings) = (Vec::new(), Vec::new());
    let mut tangents = Tangents { forces: of_forces, openings, areas, displacements: None, residual, applications: 0 };
    let mut amplitudes = Vec::new();
    for (column, (constant, _)) in driven.iter().enumerate() {
        let solution = solution.col_as_slice(column);
        let (product, rigid) = (products.col_as_slice(column), multiply(&contact.motions, &solution[size..]));
        let opening = |start: usize| (constant[start] - product[start] + rigid[start]) * contact.unit * contact.load;
        tangents.openings.push(boundary.points.iter().map(|point| opening(point.start)).collect());
        tangents.forces.push(forces.col_as_slice(column).iter().map(|force| force * contact.load).collect());
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
