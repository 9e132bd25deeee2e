//! The equilibrium by continuation in the contact compliance.
//!
//! ```text
//! δ = 0, else 1, 10², … brought down to 0;   last resort: cone programs
//! ```
//! From the bonded state, δ = 0 is enough in most scenes. With a large compliance δ of its own every contact node
//! yields, and Newton's method converges from the bonded guess also where few nodes hold the bodies; the state of every
//! δ is the start of the next.

use crate::direct::compliant_contact::CompliantContact;
use crate::direct::cone_programs::{Programs, by_cone_programs, steps_for_programs};
use crate::direct::newton::{Problem, SPRINGS, TIGHTEST, newton, step};
use crate::equilibrium::law::Linearization;
use crate::equilibrium::{ForceUnit, Work};
use nonsmooth::interruption::interrupted;

/// Compliances that the first problem is tried with, one after the other until Newton's method converges.
const FIRST_COMPLIANCES: [f64; 6] = [0.0, 1.0, 1e2, 1e4, 1e6, 1e8];
/// Compliance below which it is set to 0: rounding. Where bodies bend, their compliances are far above those of single
/// nodes, and states change down to 1e-8.
const LAST_COMPLIANCE: f64 = 1e-12;
/// Factor of the compliance in the first step that lowers it.
const SHRINKAGE: f64 = 0.25;
/// Smallest factor of the compliance in one step.
const SMALLEST_FACTOR: f64 = 1e-4;
/// Factor of the compliance above which a step is no progress any more.
const LARGEST_FACTOR: f64 = 0.999;
/// Newton steps that lowering the compliance may take with one spring.
const MAX_TOTAL_STEPS: usize = 1000;

/// What the iteration reached.
#[derive(Debug, Clone)]
pub(super) struct Reached {
    /// Forces and amplitudes, dimensionless.
    pub(super) unknowns: Vec<f64>,
    pub(super) linearizations: Vec<Linearization>,
    /// Whether they solve the problem without a compliance of the contact nodes (δ = 0).
    pub(super) solved: bool,
    /// Relative residual after every Newton step, at the compliance of the step; without those from cone programs.
    pub(super) history: Vec<f64>,
    /// The last resort, where it was needed.
    pub(super) programs: Option<Programs>,
}

impl Reached {
    /// Goes on from a solution whose forces turn out to be small in the unit that they were found in: motions of the
    /// bodies have taken the approach away that the unit counts.
    pub(super) fn refine(&mut self, contact: &mut CompliantContact, unit: ForceUnit, tolerance: f64) {
        let forces: Vec<f64> = self.unknowns[..contact.row_count()].iter().map(|force| force * contact.load).collect();
        let Some(finer) = unit.finer(&contact.problem.boundary, &forces, contact.load) else { return };
        contact.rescale(finer, &mut self.unknowns);
        let problem = Problem { delta: 0.0, spring: SPRINGS[0], tolerance, max_steps: usize::MAX };
        // What does not converge any further is left to the certificate.
        if let Some(found) = newton(contact, self.unknowns.clone(), problem, &mut self.history) {
            self.unknowns = found;
        }
        self.linearizations = contact.linearize(&contact.residual(&self.unknowns, 0.0).1);
    }

    pub(super) fn work(&self) -> Work {
        let programs = self.programs.as_ref().map_or([0; 2], |programs| [programs.iterations, programs.newton_steps]);
        let newton_steps = self.history.len() + programs[1];
        Work { newton_steps, dense_factorizations: newton_steps + programs[0], ..Work::default() }
    }
}

/// The equilibrium from given unknowns, from the bonded problem, or from cone programs, to a relative residual; or,
/// after at most so many factorisations, the last state on the way.
pub(super) fn equilibrium(
    contact: &mut CompliantContact,
    start: Option<&[f64]>,
    tolerance: f64,
    max_steps: usize,
) -> Reached {
    let mut history = Vec::new();
    let tolerance = tolerance.max(TIGHTEST);
    let all_steps = max_steps;
    let max_steps = max_steps - steps_for_programs(contact, max_steps);
    let zero = vec![0.0; contact.row_count() + contact.resultant.len()];
    let problem = |delta, spring| Problem { delta, spring, tolerance, max_steps };
    let started = start.and_then(|start| newton(contact, start.to_vec(), problem(0.0, SPRINGS[0]), &mut history));
    let mut reached = (zero.clone(), false);
    for spring in SPRINGS.into_iter().take_while(|_| started.is_none() && !interrupted()) {
        let first = FIRST_COMPLIANCES.into_iter().take_while(|_| !interrupted()).find_map(|delta| {
            let bonded = bonded(contact, &zero, problem(delta, spring));
            newton(contact, bonded, problem(delta, spring), &mut history).map(|found| (delta, found))
        });
        if let Some((delta, found)) = first {
            reached = lower(contact, found, problem(delta, spring), &mut history);
            if reached.1 {
                break;
            }
        }
    }
    let (mut unknowns, mut solved) = started.map_or(reached, |found| (found, true));
    // The programs know half-lines and friction cones alone, no glued nodes.
    let programs = (!solved && !interrupted() && !contact.problem.boundary.has_ties())
        .then(|| by_cone_programs(contact, tolerance, all_steps.saturating_sub(history.len())));
    if let Some(found) = programs.as_ref().and_then(|programs| programs.unknowns.clone()) {
        (unknowns, solved) = (found, true);
    }
    let linearizations = contact.linearize(&contact.residual(&unknowns, 0.0).1);
    Reached { unknowns, linearizations, solved, history, programs }
}

/// Lowers the compliance from a solved problem; the last solved one, and whether its compliance is 0.
fn lower(
    contact: &mut CompliantContact,
    mut unknowns: Vec<f64>,
    mut problem: Problem,
    history: &mut Vec<f64>,
) -> (Vec<f64>, bool) {
    let mut factor = SHRINKAGE;
    let last = (history.len() + MAX_TOTAL_STEPS).min(problem.max_steps);
    while problem.delta > 0.0 && factor <= LARGEST_FACTOR && history.len() < last {
        let delta = if factor * problem.delta < LAST_COMPLIANCE { 0.0 } else { factor * problem.delta };
        match newton(contact, unknowns.clone(), Problem { delta, ..problem }, history) {
            Some(found) => {
                (problem.delta, unknowns) = (delta, found);
                factor = (factor * factor).max(SMALLEST_FACTOR);
            }
            None => factor = factor.sqrt(),
        }
    }
    (unknowns, problem.delta == 0.0)
}

/// The solution with all nodes glued.
fn bonded(contact: &CompliantContact, start: &[f64], problem: Problem) -> Vec<f64> {
    let rho = 1.0 / (1.0 + problem.delta);
    let (mut residual, _) = contact.residual(start, problem.delta);
    for (entry, jump) in residual.iter_mut().zip(contact.jumps(start, problem.delta)) {
        *entry = -rho * jump;
    }
    let glued = vec![Linearization::Stick; contact.problem.boundary.points.len()];
    let step = step(contact, &glued, &residual, problem);
    start.iter().zip(&step).map(|(x, step)| x - step).collect()
}
