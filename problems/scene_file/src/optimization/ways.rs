//! Where the runs of an optimization begin: the start of the scene, other starts, or what earlier runs have found.

use crate::optimization::coarse_net::coarse_net;
use crate::optimization::fairness::fair_shape;
use crate::optimization::runs::{AGREES, ContactRun, best, violation};
use crate::optimization::{Attempt, OptimizationError, Part};
use contact::contact_objective::ContactObjective;
use nonsmooth::Vector;
use nonsmooth::runs::moved_start;
use nonsmooth::verify::seeded_direction;

/// First step of a run that goes on from a shape already optimized, in first steps of the first run. The gap there says
/// nothing about the changes that are left, since the bodies have followed the surface; steps from a fourteenth to a
/// third of the first were measured to do about equally well.
const LATER_FIRST_STEP: f64 = 0.2;

/// Largest change of a control at a further start, in first steps: several times the length on which contact changes.
const CHANGE: f64 = 4.0;

/// Where a run begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Beginning {
    pub controls: Vector,
    pub first_step: f64,
    /// The bending of the shape that a fairer one has replaced.
    pub bending_before: Option<f64>,
}

/// Whether the coarse net leads to no other Θ than the direct way, which has come to its end: not worth to be refined.
fn is_outdone(before: &[ContactRun]) -> bool {
    let [direct, coarse, ..] = before else { return false };
    let bar = direct.report.value - AGREES * direct.report.value.abs();
    direct.report.termination.is_stationary() && violation(direct) <= violation(coarse) && coarse.report.value >= bar
}

/// Where a part of an optimization begins, after the runs before it, in what the whole optimization began with; none if
/// the part is not worth a run.
///
/// # Errors
/// [`OptimizationError::Start`] where a start cannot be moved into the admissible set, and
/// [`OptimizationError::Derivatives`] of the contact solver.
pub fn beginning(
    part: Part,
    objective: &ContactObjective,
    before: &[ContactRun],
    (start, first_step): (&Vector, f64),
) -> Result<Option<Beginning>, OptimizationError> {
    let at =
        |controls: Vector, share: f64| Beginning { controls, first_step: share * first_step, bending_before: None };
    let later = |run: &ContactRun, share: f64| at(run.report.solution.clone(), share);
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
            let plain =
                later(best, if best.stage.label.part == Part::Try(Attempt::Coarse) { 1.0 } else { LATER_FIRST_STEP });
            fairer(objective, best, first_step)?.unwrap_or(plain)
        }
        (Part::Fair, Some(last)) => return fairer(objective, last, first_step),
        _ => at(start.clone(), 1.0),
    }))
}

/// A beginning at a fairer shape than that where a run has ended; none unless it has ended where Θ is stationary.
fn fairer(
    objective: &ContactObjective,
    run: &ContactRun,
    first_step: f64,
) -> Result<Option<Beginning>, OptimizationError> {
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
) -> Result<Vector, OptimizationError> {
    let problem = objective.solver().problem();
    let set = problem.admissible.polyhedron();
    let ceiling = set.upper().add_scalar(-set.upper().mean());
    let follows = number == 2 && ceiling.amax().is_finite() && ceiling.amax() > 0.0;
    let (direction, length) = if follows && problem.scene.shapes().all(|shape| shape.face().is_some()) {
        (ceiling.clone(), ceiling.amax())
    } else {
        let net = coarse_net(&problem.scene)?.directions;
        // Bounds would cut off a larger change, and leave a constant.
        let widths = set.upper() - set.lower();
        let room = widths.iter().copied().filter(|width| *width > 0.0).fold(f64::INFINITY, f64::min);
        (&net * seeded_direction(net.ncols(), number as u64), (CHANGE * first_step).min(0.5 * room))
    };
    moved_start(set, start, &direction, length).map_err(|source| OptimizationError::Start { number, source })
}
