//! Equilibria by cone programs: the path that owes nothing to Newton's method.
//!
//! ```text
//! min ½ λᵀCλ − (d − 𝓕 s)ᵀλ,   λ in the friction cones,   Rᵀλ = e;      s := |w_T| per node, to be repeated until it stays
//! ```
//! Without friction one convex program gives the state. With friction its fixed points are the equilibria.

use contact::direct::CompliantContact;
use contact::qp::{Cone, ConeProgram};

/// Most programs that are solved with friction.
const MAX_PROGRAMS: usize = 12;
/// Relative change of s that ends the fixed point.
const SETTLED: f64 = 1e-9;

/// Forces and amplitudes of an equilibrium, as nearly as cone programs give them; none where one of them is not solved.
pub fn equilibrium(contact: &CompliantContact) -> Option<Vec<f64>> {
    let boundary = &contact.problem.boundary;
    let mut slips = vec![0.0; boundary.points.len()];
    let programs = if boundary.has_friction() { MAX_PROGRAMS } else { 1 };
    let mut found = None;
    for _program in 0..programs {
        let unknowns = program(contact, &slips)?;
        let jumps = contact.jumps(&unknowns, 0.0);
        let slip =
            |start: usize, count: usize| jumps[start + 1..start + count].iter().map(|j| j * j).sum::<f64>().sqrt();
        let next: Vec<f64> = boundary.points.iter().map(|point| slip(point.start, point.row_count())).collect();
        let change = next.iter().zip(&slips).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let size = next.iter().copied().fold(1.0, f64::max);
        found = Some(unknowns);
        slips = next;
        if change <= SETTLED * size {
            break;
        }
    }
    found
}

/// One cone program for given norms of the slip.
fn program(contact: &CompliantContact, slips: &[f64]) -> Option<Vec<f64>> {
    let boundary = &contact.problem.boundary;
    let mut linear: Vec<f64> = contact.constant().iter().map(|d| -d).collect();
    let points = boundary.points.iter();
    let cones = points.map(|point| Cone { first: point.start, size: point.row_count(), slope: boundary.friction });
    for (point, slip) in boundary.points.iter().zip(slips) {
        linear[point.start] += boundary.friction * slip;
    }
    let program = ConeProgram {
        hessian: &contact.compliance,
        linear,
        equalities: &contact.motions,
        right_side: contact.resultant.clone(),
        cones: cones.collect(),
    };
    let (forces, amplitudes) = program.minimise()?;
    Some(forces.into_iter().chain(amplitudes).collect())
}
