//! Semismooth Newton on contact forces and rigid motions, for one compliance δ of the contact nodes.
//!
//! ```text
//! λ = Π(λ + ρ w),  w = d − (C + δ) λ + R a,  Rᵀ λ = e,   ρ = 1/(1 + δ)
//! ```
//! A proximal spring in the rigid block of the derivative keeps it regular where the closed nodes leave a motion free;
//! the residual does not contain it, so that the state does not depend on it. Open nodes are eliminated from every
//! step. Once the residual comes near the rounding of d + R a, the bodies are moved by these motions: d := d + R a, a
//! := 0.

use crate::direct::active_system::{ActiveFactor, ActiveSystem, Kept};
use crate::direct::compliant_contact::CompliantContact;
use crate::equilibrium::Stage;
use crate::equilibrium::law::{Friction, Linearization};
use crate::linear::dense::multiply;
use crate::linear::vector::norm;

/// Proximal springs, relative to the mean contact stiffness, tried one after the other.
pub(super) const SPRINGS: [f64; 2] = [1e-8, 1e-6];
/// Newton steps for one compliance.
const MAX_STEPS: usize = 30;
/// Halvings of one step.
const MAX_HALVINGS: usize = 6;
/// Relative decrease of the residual asked of a step of length one.
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Multiple of its rounding floor up to which a residual counts as having reached it.
pub(super) const FLOOR_REACHED: f64 = 100.0;
/// Tightest relative residual aimed at: below it rounding decides.
pub(super) const TIGHTEST: f64 = 1e-13;
/// Relative residual accepted when rounding stops all progress.
const ACCEPTABLE: f64 = 1e-9;

/// How one Newton iteration is run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Problem {
    /// δ, over the unit of compliances.
    pub(super) delta: f64,
    pub(super) spring: f64,
    pub(super) tolerance: f64,
    /// Newton steps allowed in all, those before it included.
    pub(super) max_steps: usize,
}

/// Newton's method from unknowns near an equilibrium, in so many steps, with their number; none where it diverges.
pub(super) fn newton_near(
    contact: &mut CompliantContact,
    unknowns: &[f64],
    tolerance: f64,
    max_steps: usize,
) -> (Option<Vec<f64>>, usize) {
    let mut history = Vec::new();
    let problem = Problem { delta: 0.0, spring: SPRINGS[0], tolerance: tolerance.max(TIGHTEST), max_steps };
    (newton(contact, unknowns.to_vec(), problem, &mut history), history.len())
}

/// Newton's method for one compliance; none where it does not converge.
pub(super) fn newton(
    contact: &mut CompliantContact,
    mut unknowns: Vec<f64>,
    problem: Problem,
    history: &mut Vec<f64>,
) -> Option<Vec<f64>> {
    let (mut residual, mut arguments) = contact.residual(&unknowns, problem.delta);
    let mut size = norm(&residual);
    let mut before = None;
    for _step in 0..MAX_STEPS {
        if size <= problem.tolerance || !size.is_finite() || history.len() >= problem.max_steps {
            break;
        }
        if before.is_none() && size <= FLOOR_REACHED * contact.rounding(&unknowns) {
            before = Some(contact.recentre(&mut unknowns));
            (residual, arguments) = contact.residual(&unknowns, problem.delta);
            size = norm(&residual);
        }
        let previous = size;
        let step = step(contact, &contact.linearize(&arguments), &residual, problem);
        unknowns = search(contact, &unknowns, &step, size, problem.delta);
        (residual, arguments) = contact.residual(&unknowns, problem.delta);
        size = norm(&residual);
        history.push(size);
        Stage::Contact.reached(history.len(), size).ok()?;
        if size <= ACCEPTABLE && size > 0.5 * previous {
            break;
        }
    }
    let solved = size <= problem.tolerance.max(ACCEPTABLE);
    // The unknowns that the caller keeps refer to where the bodies were.
    if let Some(before) = before.filter(|_| !solved) {
        contact.placement = before;
    }
    solved.then_some(unknowns)
}

/// Halves the step until the residual falls; takes the full step where no length helps.
fn search(contact: &CompliantContact, from: &[f64], step: &[f64], size: f64, delta: f64) -> Vec<f64> {
    let at = |length: f64| -> Vec<f64> { from.iter().zip(step).map(|(x, step)| x - length * step).collect() };
    let mut length = 1.0;
    for _halving in 0..=MAX_HALVINGS {
        let trial = at(length);
        if norm(&contact.residual(&trial, delta).0) <= (1.0 - SUFFICIENT_DECREASE * length) * size {
            return trial;
        }
        length *= 0.5;
    }
    at(1.0)
}

/// M⁻¹ r for the derivative M with a spring: open nodes first, whose rows are those of the identity.
pub(super) fn step(
    contact: &CompliantContact,
    linearizations: &[Linearization],
    residual: &[f64],
    problem: Problem,
) -> Vec<f64> {
    let (count, rho) = (contact.row_count(), 1.0 / (1.0 + problem.delta));
    let boundary = &contact.problem.boundary;
    let mut step = vec![0.0; residual.len()];
    for (node, linearization) in boundary.points.iter().zip(linearizations) {
        if *linearization == Linearization::Open {
            let range = node.rows();
            step[range.clone()].copy_from_slice(&residual[range]);
        }
    }
    let product = multiply(&contact.compliance, &step[..count]);
    let system = ActiveSystem::new(contact, linearizations, problem.delta, Friction::Coulomb, Kept::Coupled);
    let active = ActiveFactor::new(system.with_springs(problem.spring * rho), None);
    let mut right: Vec<f64> = Vec::with_capacity(active.rows().len() + residual.len() - count);
    for (node, linearization) in boundary.points.iter().zip(linearizations) {
        if *linearization == Linearization::Open {
            continue;
        }
        let block = linearization.derivative(node.row_count(), node.friction);
        right.extend((0..node.row_count()).map(|i| {
            let open: f64 = (0..node.row_count()).map(|j| block[i][j] * product[node.start + j]).sum();
            residual[node.start + i] - rho * open
        }));
    }
    for (column, resultant) in residual[count..].iter().enumerate() {
        let open: f64 = (0..count).map(|row| contact.motions[(row, column)] * step[row]).sum();
        right.push(resultant - open);
    }
    let solution = active.solve(contact, right);
    for (row, value) in active.rows().iter().copied().chain(count..residual.len()).zip(&solution) {
        step[row] = *value;
    }
    step
}
