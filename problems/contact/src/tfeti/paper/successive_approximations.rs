//! The paper's path: successive approximations over Tresca problems, each a dual QP for SMALSE-M and MPGP.
//!
//! ```text
//! Ψ ← 𝓕 λ_N(Ψ):   min ½ λᵀ PFP λ − λᵀ P(d − F λ₀)   s.t.  C λ = L⁻¹e,  λ_N ≥ 0,  |λ_T,i| ≤ Ψ_i          method.md (4.1)
//! λ₀ = Gᵀ(GGᵀ)⁻¹ e,   C = L⁻¹G,   LLᵀ = GGᵀ,   Q = CᵀC,   P = I − Q
//! ```
//! The orthonormalised homogenised problem in the unshifted multipliers: P λ₀ = 0, so that the bounds stay where they
//! are. Every Tresca problem is solved only as far as its slip bound is worth: to a share of the change of Ψ.

use crate::equilibrium::certificate::projection_residual;
use crate::equilibrium::law::tangential_norm;
use crate::equilibrium::{Stage, Work};
use crate::error::ContactError;
use crate::linear::vector::{add_scaled, norm};
use crate::qp::{
    Block, FacePreconditioner, LinearEqualities, QpLimits, QuadraticProgram, SeparableSet, Smalse, SmalseSolution,
    StepCounts, WarmStart,
};
use crate::tfeti::dual::{Iterate, TornContact, TornSolution};
use crate::tfeti::newton::{balanced, first_iterate, slip_bounds};
use crate::tfeti::paper::projected_dual::{OrthonormalCoarse, ProjectedDual, projected_preconditioner};

/// When to stop, and how the dual QPs are solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AugmentedLagrangianSettings {
    /// Relative residual aimed at, measured as Newton's.
    pub tolerance: f64,
    /// Accuracy of a Tresca problem relative to the change of the slip bound that it brings about. Default 0.2 (0.1
    /// takes some five per cent more products, 0.3 some five per cent fewer).
    pub adaptivity: f64,
    /// Fixed point steps allowed, one Tresca problem each. Default 60.
    pub max_fixed_point_steps: usize,
    /// Whether the preconditioner is used inside faces. Default true.
    pub precondition: bool,
    /// Work allowed to the dual QP solver.
    pub qp: QpLimits,
}

impl AugmentedLagrangianSettings {
    /// Settings for a relative residual.
    pub fn to(tolerance: f64) -> Self {
        let tolerance = tolerance.max(TIGHTEST_TOLERANCE);
        Self { tolerance, adaptivity: 0.2, max_fixed_point_steps: 60, precondition: true, qp: QpLimits::default() }
    }
}

/// Work of the paper's path.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AugmentedLagrangianCounts {
    /// Number of Tresca problems solved.
    pub fixed_point_steps: usize,
    /// Multiplier updates of SMALSE-M.
    pub outer: usize,
    /// Products of the dual QP solver by the kind of step.
    pub steps: StepCounts,
    /// Estimated contraction factor of Ψ ↦ 𝓕λ_N(Ψ); 0 without friction or with fewer than three steps.
    pub contraction: f64,
}

impl AugmentedLagrangianCounts {
    /// The sum of these counts and those of a run before, whose contraction counts.
    fn after(self, before: Self) -> Self {
        let [own, other] = [self.steps, before.steps];
        let steps = StepCounts {
            cg_steps: own.cg_steps + other.cg_steps,
            expansion_steps: own.expansion_steps + other.expansion_steps,
            proportioning_steps: own.proportioning_steps + other.proportioning_steps,
            refreshed_gradients: own.refreshed_gradients + other.refreshed_gradients,
        };
        Self {
            fixed_point_steps: self.fixed_point_steps + before.fixed_point_steps,
            outer: self.outer + before.outer,
            steps,
            contraction: before.contraction,
        }
    }

    /// The counts in the record that all contact solvers share.
    pub fn added_to(&self, work: Work) -> Work {
        Work {
            newton_steps: 0,
            fixed_point_steps: self.fixed_point_steps,
            cg_steps: self.steps.cg_steps,
            expansion_steps: self.steps.expansion_steps,
            proportioning_steps: self.steps.proportioning_steps,
            ..work
        }
    }
}

/// Tightest relative residual that rounding allows to ask for.
const TIGHTEST_TOLERANCE: f64 = 1e-12;
/// Mean contraction factor above which a run that has not converged is said not to contract.
const MAX_CONTRACTION: f64 = 0.9;
/// Consecutive steps without contraction that end the iteration; the contraction factor is a mean over as many.
const MAX_GROWING_STEPS: usize = 4;
/// Relative residual that is accepted when rounding stops all progress.
const TIGHTEST_ACCEPTABLE: f64 = 1e-9;
/// Share of the tolerance aimed at: the final amplitudes are found by least squares and may leave a little more.
const TARGET_SHARE: f64 = 0.5;
/// Relative change of the slip bound below which rounding decides, and ratios of changes mean nothing.
const SMALLEST_CHANGE: f64 = 1e-8;
/// Factor on the tolerance aimed at when the balanced multipliers miss it.
const TIGHTENING: f64 = 0.2;
/// Share of the tolerance that the inner solver may leave.
const INNER_SHARE: f64 = 0.1;

/// The changing part of the fixed point iteration.
struct FixedPoint {
    bounds: Vec<f64>,
    warm: WarmStart,
    changes: Vec<f64>,
    counts: AugmentedLagrangianCounts,
}

/// Solves by successive approximations of the slip bound, from given multipliers (over all rows) of a similar
/// problem or from the bonded problem.
///
/// # Errors
/// [`ContactError::NoContraction`] when the fixed point iteration does not contract, [`ContactError::DualProblem`]
/// from the dual QP, [`ContactError::NotConverged`], [`ContactError::NoEquilibrium`].
pub fn solve_by_successive_approximations(
    contact: &TornContact<'_>,
    start: Option<&[f64]>,
    settings: &AugmentedLagrangianSettings,
) -> Result<(TornSolution, AugmentedLagrangianCounts), ContactError> {
    let acceptable = settings.tolerance.max(TIGHTEST_ACCEPTABLE);
    let coarse = OrthonormalCoarse::new(contact.space, contact.operator.model)?;
    let dual = ProjectedDual { operator: &contact.operator, coarse: &coarse };
    let linear = dual.homogenised(&contact.constant);
    let mut state = first_point(contact, &first_iterate(contact, start, usize::MAX, None)?, &coarse);
    let mut history = Vec::new();
    let mut aimed = *settings;
    let (iterate, residual) = loop {
        approximate(contact, &dual, &linear, &aimed, &mut state, &mut history)?;
        let iterate = balanced(contact, &contact.operator.model.constraints.own_rows(&state.warm.x), &state.bounds)?;
        let residual = contact.residual(&iterate);
        let spent = history.len() >= settings.max_fixed_point_steps || aimed.tolerance <= TIGHTEST_TOLERANCE;
        if residual.is_nan() || residual <= acceptable || spent {
            break (iterate, residual);
        }
        // Balancing the multipliers has cost more than the share kept for it.
        aimed.tolerance = (TIGHTENING * aimed.tolerance).max(TIGHTEST_TOLERANCE);
    };
    if residual.is_nan() || residual > acceptable {
        let factor = overall_contraction(&state.changes);
        if factor > MAX_CONTRACTION {
            return Err(ContactError::NoContraction { factor, history: state.changes });
        }
        return Err(ContactError::NotConverged {
            solver: "successive approximations",
            residual,
            tolerance: settings.tolerance,
            iterations: history.len(),
            history,
        });
    }
    // Motions of the bodies have taken an approach away that the unit of forces counts.
    if let Some((finer, moved)) = contact.finer(&iterate) {
        match solve_by_successive_approximations(&finer, Some(&state.warm.x), settings) {
            Ok((mut solution, counts)) => {
                add_scaled(&mut solution.iterate.amplitudes, 1.0, &moved);
                return Ok((solution, counts.after(state.counts)));
            }
            // What does not converge any further is left to the certificate.
            Err(ContactError::NotConverged { .. } | ContactError::NoContraction { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok((contact.solution(iterate, residual, state.counts.fixed_point_steps), state.counts))
}

/// Tresca problems until their residual is below a share of the tolerance aimed at, or the steps are spent.
fn approximate(
    contact: &TornContact<'_>,
    dual: &ProjectedDual<'_>,
    linear: &[f64],
    settings: &AugmentedLagrangianSettings,
    state: &mut FixedPoint,
    history: &mut Vec<f64>,
) -> Result<(), ContactError> {
    loop {
        let solution = tresca(contact, dual, linear, settings, state)?;
        let residual = coulomb_residual(contact, &solution);
        history.push(residual);
        Stage::Contact.reached(history.len(), residual)?;
        let exhausted = !solution.converged && residual <= settings.tolerance.max(TIGHTEST_ACCEPTABLE);
        let target = TARGET_SHARE * settings.tolerance;
        state.counts.fixed_point_steps += 1;
        state.counts.outer += solution.outer;
        state.counts.steps += solution.counts;
        advance(contact, state, solution)?;
        let spent = history.len() >= settings.max_fixed_point_steps;
        if residual <= target || exhausted || spent || !contact.boundary.has_friction() {
            return Ok(());
        }
    }
}

/// The first slip bounds and multipliers: those of an iterate. The QP's gradient is −w, its rigid part Cᵀμ.
fn first_point(contact: &TornContact<'_>, iterate: &Iterate, coarse: &OrthonormalCoarse<'_>) -> FixedPoint {
    let multipliers = coarse.apply(&coarse.whole(&iterate.jumps)).into_iter().map(|entry| -entry).collect();
    let warm = WarmStart { x: coarse.whole(&iterate.multipliers), multipliers, ..WarmStart::default() };
    let bounds = slip_bounds(contact, iterate.multipliers.contact());
    FixedPoint { bounds, warm, changes: Vec::new(), counts: AugmentedLagrangianCounts::default() }
}

/// λ_N ≥ 0, |λ_T| ≤ Ψ.
fn feasible_set(contact: &TornContact<'_>, bounds: &[f64]) -> Result<SeparableSet, ContactError> {
    let equality = contact.operator.model.constraints.total_equality_count;
    let mut blocks = Vec::with_capacity(2 * bounds.len());
    for (point, &radius) in contact.boundary.points.iter().zip(bounds) {
        let index = equality + point.start;
        blocks.push(Block::HalfLine { index, bound: 0.0 });
        if point.tangents > 0 {
            blocks.push(Block::Disc { first: index + 1, size: point.tangents, centre: [0.0; 2], radius });
        }
    }
    Ok(SeparableSet::new(equality + contact.boundary.row_count, blocks)?)
}

/// Solves the Tresca problem of the current slip bounds as far as they deserve.
fn tresca(
    contact: &TornContact<'_>,
    dual: &ProjectedDual<'_>,
    linear: &[f64],
    settings: &AugmentedLagrangianSettings,
    state: &FixedPoint,
) -> Result<SmalseSolution, ContactError> {
    let (set, coarse) = (feasible_set(contact, &state.bounds)?, dual.coarse);
    let program = QuadraticProgram { hessian: dual, linear, set: &set, equalities: coarse };
    let mut solver = Smalse { program, preconditioner: None, limits: settings.qp };
    let norm_h = solver.norm(&state.warm)?;
    let warm = WarmStart { norm: Some(norm_h), ..state.warm.clone() };
    let preconditioner = projected_preconditioner(&contact.preconditioner, coarse, norm_h);
    if settings.precondition {
        solver.preconditioner = Some(FacePreconditioner { operator: &preconditioner, diagonal: contact.stiffness });
    }
    let floor = INNER_SHARE * settings.tolerance * contact.load / contact.stiffness;
    let solution = solver.run(&warm, floor, &mut |progress| {
        let error = contact.stiffness * progress.reduced_gradient + progress.infeasibility;
        let residual = coulomb_residual(contact, progress);
        let change = difference(&slip_bounds(contact, split(contact, &progress.warm.x).1), &state.bounds);
        let deserved = (settings.adaptivity * change).max(2.0 * floor * contact.stiffness);
        residual <= TARGET_SHARE * settings.tolerance || (contact.boundary.has_friction() && error <= deserved)
    })?;
    Ok(solution)
}

/// The rows of B_E and the packed contact rows of a vector of the QP solver.
fn split<'v>(contact: &TornContact<'_>, all: &'v [f64]) -> (&'v [f64], &'v [f64]) {
    all.split_at(contact.operator.model.constraints.total_equality_count)
}

/// The relative residual, as Newton measures it, for the jumps that the multipliers of the equalities imply.
fn coulomb_residual(contact: &TornContact<'_>, solution: &SmalseSolution) -> f64 {
    let (glued, opening) = split(contact, &solution.gradient);
    let jumps: Vec<f64> = opening.iter().map(|entry| -entry).collect();
    let law = projection_residual(contact.boundary, split(contact, &solution.warm.x).1, &jumps, contact.stiffness);
    (contact.stiffness * norm(glued)).hypot(norm(&law)).hypot(solution.infeasibility) / contact.load
}

/// Ψ ← 𝓕λ_N; sliding tractions keep to the circle. Watches the contraction.
fn advance(contact: &TornContact<'_>, state: &mut FixedPoint, solution: SmalseSolution) -> Result<(), ContactError> {
    let equality = contact.operator.model.constraints.total_equality_count;
    let bounds = slip_bounds(contact, split(contact, &solution.warm.x).1);
    let change = difference(&bounds, &state.bounds);
    if !change.is_finite() {
        return Err(ContactError::NotFinite { what: "slip bound" });
    }
    state.warm = solution.warm;
    for ((point, &new), &old) in contact.boundary.points.iter().zip(&bounds).zip(&state.bounds) {
        let range = equality + point.start..equality + point.start + point.row_count();
        let rows = &mut state.warm.x[range];
        if old > 0.0 && tangential_norm(rows) >= old * (1.0 - 1e-9) {
            rows[1..].iter_mut().for_each(|entry| *entry *= new / old);
        }
    }
    state.warm.image = None;
    state.bounds = bounds;
    state.changes.push(change / norm(&state.bounds).max(f64::MIN_POSITIVE));
    state.counts.contraction = contraction(&state.changes);
    if diverges(&state.changes) {
        return Err(ContactError::NoContraction { factor: state.counts.contraction, history: state.changes.clone() });
    }
    Ok(())
}

/// The distance |a − b|₂.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Geometric mean of the last ratios of changes; the first change measures the start and does not count.
fn contraction(changes: &[f64]) -> f64 {
    let pairs = changes.windows(2).skip(1).filter(|pair| pair[1] > SMALLEST_CHANGE);
    let ratios: Vec<f64> = pairs.map(|pair| pair[1] / pair[0]).collect();
    let recent = &ratios[ratios.len().saturating_sub(MAX_GROWING_STEPS)..];
    if recent.is_empty() {
        return 0.0;
    }
    (recent.iter().map(|ratio| ratio.ln()).sum::<f64>() / recent.len() as f64).exp()
}

/// Geometric mean of the ratios in the second half of the changes: what remains of an iteration that oscillates.
fn overall_contraction(changes: &[f64]) -> f64 {
    let half = &changes[changes.len() / 2..];
    match (half.first(), half.last()) {
        (Some(&first), Some(&last)) if half.len() > MAX_GROWING_STEPS && last > SMALLEST_CHANGE => {
            (last / first).powf(1.0 / (half.len() - 1) as f64)
        }
        _ => 0.0,
    }
}

/// Whether the last changes do not fall although they are far above rounding.
fn diverges(changes: &[f64]) -> bool {
    let recent = &changes[changes.len().saturating_sub(MAX_GROWING_STEPS + 1)..];
    recent.len() > MAX_GROWING_STEPS && recent.windows(2).all(|pair| pair[1] >= pair[0] && pair[1] > SMALLEST_CHANGE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contraction_is_the_rate_of_the_changes() {
        let changes: Vec<f64> = (0..6).map(|step| 0.3 * 0.1_f64.powi(step)).collect();
        assert!((contraction(&changes) - 0.1).abs() < 1e-12);
        assert!(!diverges(&changes));
        assert_eq!(contraction(&changes[..2]), 0.0);
        assert!((overall_contraction(&[1.0, 0.9, 0.7, 1.0, 0.7, 1.0, 0.7, 1.0, 0.7, 1.0]) - 1.0).abs() < 0.2);
    }

    #[test]
    fn a_growing_or_circling_slip_bound_is_diagnosed() {
        let growing: Vec<f64> = (0..6).map(|step| 0.01 * 1.2_f64.powi(step)).collect();
        assert!(diverges(&growing) && (contraction(&growing) - 1.2).abs() < 1e-12);
        assert!(diverges(&[0.5; 5]) && !diverges(&[0.5; 4]));
        // At the level of rounding nothing falls any more, and nothing is wrong.
        assert!(!diverges(&[1e-14; 9]));
    }
}
