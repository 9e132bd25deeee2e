//! Where the runs of an optimization begin: the start of the scene, other starts, or what earlier runs have found.

use crate::commands::failure::Failure;
use crate::commands::optimize::coarse_net::{Beginning, coarse_net};
use crate::commands::optimize::fairness::fair_shape;
use crate::commands::optimize::mesh_run::MeshRun;
use crate::commands::optimize::stages::{Attempt, Part};
use crate::commands::shape_facts::is_proved;
use crate::commands::solved_shape::ContactObjective;
use nonsmooth::Vector;
use nonsmooth::qp::project;
use nonsmooth::verify::seeded_direction;

/// First step of a run that goes on from a shape already optimized, in first steps of the first run. The gap there says
/// nothing about the changes that are left, since the bodies have followed the surface; steps from a fourteenth to a
/// third of the first were measured to do about equally well (docs/long_runs.md).
const LATER_FIRST_STEP: f64 = 0.2;

/// Largest change of a control at a further start, in first steps: several times the length on which contact changes.
const CHANGE: f64 = 4.0;

/// The relative violation of the limits at the end of a run; 0 where all are kept.
fn violation(run: &MeshRun) -> f64 {
    let violated = run.report.constraints.iter().filter(|limit| !limit.satisfied);
    violated.map(|limit| limit.violation).fold(0.0, f64::max)
}

/// The best of some runs: least violation of the limits, then least Θ.
pub fn best<'r>(runs: impl Iterator<Item = &'r MeshRun>) -> Option<&'r MeshRun> {
    runs.min_by(|a, b| violation(a).total_cmp(&violation(b)).then(a.report.value.total_cmp(&b.report.value)))
}

/// Relative difference of Θ that a fairer shape may cost: shapes are not made more exactly.
const AS_GOOD: f64 = 1e-4;

/// The run that an optimization is reported by: the last one, or the best one of several starts, or of attempts without
/// a later run. A run from a fairer shape counts if its end is as good.
pub fn chosen(runs: &[MeshRun]) -> Option<&MeshRun> {
    let last = runs.last()?;
    let others = &runs[..runs.len() - 1];
    match last.part {
        Part::Start(_) | Part::Try(_) => best(runs.iter()),
        Part::Fair => others.last().filter(|whole| !is_as_good(last, whole)).or(Some(last)),
        Part::Whole | Part::Mesh(_) => Some(last),
    }
}

fn is_as_good(fair: &MeshRun, other: &MeshRun) -> bool {
    let (gain, same) = (other.report.value - fair.report.value, AS_GOOD * other.report.value.abs());
    violation(fair) <= violation(other) && (gain > same || gain >= -same && is_proved(&fair.report))
}

/// Relative difference of Θ within which two attempts agree: about their tolerance.
pub const AGREES: f64 = 0.03;

/// Whether the coarse net leads to no other Θ than the direct way, which has come to its end: not worth to be refined.
fn is_outdone(before: &[MeshRun]) -> bool {
    let [direct, coarse, ..] = before else { return false };
    let bar = direct.report.value - AGREES * direct.report.value.abs();
    direct.report.termination.is_stationary() && violation(direct) <= violation(coarse) && coarse.report.value >= bar
}

/// Where a part of an optimization begins, after the runs before it, in what the whole optimization began with; none if
/// the part is not worth a run.
///
/// # Errors
/// [`Failure::Computation`] where a start cannot be moved into the admissible set, or from the contact solver.
pub fn beginning(
    part: Part,
    objective: &ContactObjective,
    before: &[MeshRun],
    (start, first_step): (&Vector, f64),
) -> Result<Option<Beginning>, Failure> {
    let at =
        |controls: Vector, share: f64| Beginning { controls, first_step: share * first_step, bending_before: None };
    let later = |run: &MeshRun, share: f64| at(run.report.solution.clone(), share);
    Ok(Some(match (part, before.last()) {
        (Part::Start(number @ 2..) | Part::Try(Attempt::Start(number)), _) => {
            at(other_start(objective, (start, first_step), number)?, 1.0)
        }
        (Part::Mesh(_), Some(last)) => later(last, LATER_FIRST_STEP),
        (Part::Try(Attempt::Refined), _) if is_outdone(before) => return Ok(None),
        (Part::Try(Attempt::Refined), Some(last)) => later(last, 1.0),
        (Part::Whole, Some(last)) => {
            let best = best(before.iter()).unwrap_or(last);
            // All other controls have yet to follow those of the coarse net.
            let plain = later(best, if best.part == Part::Try(Attempt::Coarse) { 1.0 } else { LATER_FIRST_STEP });
            fairer(objective, best, first_step)?.unwrap_or(plain)
        }
        (Part::Fair, Some(last)) => return fairer(objective, last, first_step),
        _ => at(start.clone(), 1.0),
    }))
}

/// A beginning at a fairer shape than that where a run has ended; none unless it has ended where Θ is stationary.
fn fairer(objective: &ContactObjective, run: &MeshRun, first_step: f64) -> Result<Option<Beginning>, Failure> {
    if !run.report.termination.is_stationary() || !run.report.is_feasible() {
        return Ok(None);
    }
    let fair = fair_shape(objective, &run.report.solution)?;
    Ok(fair.map(|fair| Beginning {
        controls: fair.controls,
        first_step: LATER_FIRST_STEP * first_step,
        bending_before: Some(fair.before),
    }))
}

/// A further start, moved into the admissible set, always the same for its number: where all controls are heights, the
/// second follows what lies opposite to them; the others are random in the coarse net, so that they differ as shapes
/// and not as noise.
fn other_start(
    objective: &ContactObjective,
    (start, first_step): (&Vector, f64),
    number: usize,
) -> Result<Vector, Failure> {
    let problem = objective.solver().problem();
    let set = problem.admissible.polyhedron();
    let ceiling = set.upper().add_scalar(-set.upper().mean());
    let follows = number == 2 && ceiling.amax().is_finite() && ceiling.amax() > 0.0;
    let moved = if follows && problem.scene.shapes().all(|shape| shape.face().is_some()) {
        start + ceiling
    } else {
        let net = coarse_net(&problem.scene)?.directions;
        let direction = &net * seeded_direction(net.ncols(), number as u64);
        start + &direction * (CHANGE * first_step / direction.amax().max(f64::MIN_POSITIVE))
    };
    project(set, &moved).map_err(|error| Failure::Computation(format!("start {number}: {error}")))
}
