//! The last resort: equilibria from cone programs, which need no start.
//!
//! ```text
//! min ½ λᵀCλ − (d − 𝓕 s)ᵀλ,   λ in the friction cones,   Rᵀλ = e;     s := s + θ (|w_T| − s)     method.md (4.11)
//! ```
//! Without friction, this convex program is the contact problem. With friction, its solution fulfils the contact law
//! but for openings of 𝓕(|w_T| − s) at the sliding nodes \[AcaryCadouxLemarechalMalick2011\]; so the fixed points of s
//! are the equilibria. These are damped successive approximations on norms of slip in place of slip bounds: a Tresca
//! problem has no solution where its bounds cannot carry the load, while every one of these programs has one where
//! rigid statics have one. Newton's method finishes from the first minimiser that is near enough. After every program
//! the bodies are moved to where it left them, since jumps that are differences of large numbers spoil the next one.

use crate::direct::compliant_contact::CompliantContact;
use crate::direct::newton::newton_near;
#[cfg(feature = "interior-point")]
use crate::direct::resistance::MAX_ROWS;
#[cfg(feature = "interior-point")]
use crate::qp::{Cone, ConeProgram, MAX_ITERATIONS};

/// Most programs: fixed points that contract at all are near enough for Newton's method after one or two.
const MAX_PROGRAMS: usize = 30;
/// Decrease of the change of s below which the steps are halved.
const SUFFICIENT_DECREASE: f64 = 0.7;
/// Smallest θ of the damping.
const SMALLEST_SHARE: f64 = 1.0 / 64.0;
/// Change of s, relative to its largest entry or to 1, below which another program says nothing new.
const SMALLEST_CHANGE: f64 = 1e-9;

/// Of so many steps of direct condensation, one is kept for cone programs where they can be solved.
#[cfg(feature = "interior-point")]
const SHARE_OF_STEPS: usize = 4;

/// What cone programs led to, and what they cost.
#[derive(Debug, Clone, PartialEq)]
pub struct Programs {
    /// Forces and amplitudes of the equilibrium, dimensionless; none where no program was near enough.
    pub unknowns: Option<Vec<f64>>,
    pub count: usize,
    /// Interior-point iterations of all programs.
    pub iterations: usize,
    /// Newton steps from their solutions.
    pub newton_steps: usize,
}

impl Programs {
    /// Iterations and Newton steps, each of which factors a dense matrix.
    pub fn steps(&self) -> usize {
        self.iterations + self.newton_steps
    }
}

/// The equilibrium from cone programs, to a relative residual, for at most so many factorisations. Large problems
/// are left out.
pub fn by_cone_programs(contact: &mut CompliantContact, tolerance: f64, max_steps: usize) -> Programs {
    let before = contact.placement.clone();
    let mut slips = vec![0.0; contact.problem.boundary.points.len()];
    let mut found = Programs { unknowns: None, count: 0, iterations: 0, newton_steps: 0 };
    let (mut share, mut last, mut converged) = (1.0, f64::INFINITY, false);
    while found.count < MAX_PROGRAMS && found.steps() < max_steps {
        let Some((mut unknowns, iterations)) = program(contact, &slips, max_steps - found.steps()) else { break };
        found.count += 1;
        found.iterations += iterations;
        contact.recentre(&mut unknowns);
        let left = max_steps.saturating_sub(found.steps());
        let (state, steps) = newton_near(contact, &unknowns, tolerance, left);
        found.newton_steps += steps;
        if state.is_some() {
            return Programs { unknowns: state, ..found };
        }
        let next = slip_norms(contact, &unknowns);
        let change = next.iter().zip(&slips).map(|(next, slip)| (next - slip).abs()).fold(0.0, f64::max);
        if converged || share < SMALLEST_SHARE {
            break;
        }
        // Once more where the bodies have been moved to: the program has more digits there.
        converged = change <= SMALLEST_CHANGE * next.iter().copied().fold(1.0, f64::max);
        share *= if change > SUFFICIENT_DECREASE * last { 0.5 } else { 1.0 };
        last = change;
        slips.iter_mut().zip(&next).for_each(|(slip, next)| *slip += share * (next - *slip));
    }
    // The unknowns that the caller keeps refer to where the bodies were.
    contact.placement = before;
    found
}

/// Forces and amplitudes of the program for given norms of slip, and the iterations that it took.
#[cfg(feature = "interior-point")]
fn program(contact: &CompliantContact, slips: &[f64], max_iterations: usize) -> Option<(Vec<f64>, usize)> {
    let boundary = &contact.problem.boundary;
    if boundary.row_count > MAX_ROWS {
        return None;
    }
    let points = boundary.points.iter();
    let cones = points.map(|point| Cone { first: point.start, size: point.row_count(), slope: point.friction });
    let mut linear: Vec<f64> = contact.constant().iter().map(|d| -d).collect();
    for (point, slip) in boundary.points.iter().zip(slips) {
        linear[point.start] += point.friction * slip;
    }
    let program = ConeProgram {
        hessian: &contact.compliance,
        linear,
        equalities: &contact.motions,
        right_side: contact.resultant.clone(),
        cones: cones.collect(),
    };
    let minimiser = program.minimise(max_iterations.min(MAX_ITERATIONS))?;
    Some(([minimiser.entries, minimiser.multipliers].concat(), minimiser.iterations))
}

/// Of so many steps of direct condensation, those that are kept for cone programs.
#[cfg(feature = "interior-point")]
pub(super) fn steps_for_programs(contact: &CompliantContact, max_steps: usize) -> usize {
    if contact.row_count() <= MAX_ROWS { max_steps / SHARE_OF_STEPS } else { 0 }
}

/// None where there is no interior-point method.
#[cfg(not(feature = "interior-point"))]
pub(super) fn steps_for_programs(contact: &CompliantContact, _max_steps: usize) -> usize {
    0
}

/// Cone programs need an interior-point method.
#[cfg(not(feature = "interior-point"))]
fn program(contact: &CompliantContact, _slips: &[f64], _max_iterations: usize) -> Option<(Vec<f64>, usize)> {
    None
}

/// |w_T| of every node.
fn slip_norms(contact: &CompliantContact, unknowns: &[f64]) -> Vec<f64> {
    let jumps = contact.jumps(unknowns, 0.0);
    let norm = |jumps: &[f64]| jumps.iter().map(|jump| jump * jump).sum::<f64>().sqrt();
    contact.problem.boundary.points.iter().map(|point| norm(&jumps[point.rows()][1..])).collect()
}
