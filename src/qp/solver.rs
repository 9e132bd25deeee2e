//! The solver: warm start, active-set method, certificate, interior-point fallback.

use super::active_set::ActiveSetEnd;
use super::answer::{WANTED, assemble};
use super::coordinates::{Coordinates, CoordinatesCache};
use super::gram::{Gram, GramMemory};
#[cfg(feature = "interior-point")]
use super::interior_point;
use super::problem::{EpigraphQp, QpCounts, QpError, QpMethod, QpSolution};
use super::sides::{CutEntry, Member, Sides};
use super::working_set::{Active, Side, WorkingSet};

/// Largest residual with which an answer is returned at all.
const REQUIRED: f64 = 1e-10;

/// Solver of a sequence of related QPs; remembers the active set of the last answer.
///
/// ```
/// use nonsmooth::qp::{EpigraphQp, EpigraphQpSolver, Metric};
/// use nonsmooth::{Matrix, Vector};
///
/// // min max(d, −2 d) + ½ d²  has its minimiser in the kink.
/// let slopes = [Vector::from_vec(vec![1.0]), Vector::from_vec(vec![-2.0])];
/// let (rows, none) = (Matrix::zeros(0, 1), Vector::zeros(0));
/// let (lower, upper) = (Vector::from_element(1, f64::NEG_INFINITY), Vector::from_element(1, f64::INFINITY));
/// let qp = EpigraphQp {
///     metric: Metric::ScaledIdentity(1.0), slopes: &slopes, offsets: &[0.0, 0.0], cut_ids: &[0, 1],
///     rows: &rows, row_lower: &none, row_upper: &none, lower: &lower, upper: &upper,
/// };
/// let solution = EpigraphQpSolver::new().solve(&qp)?;
/// assert!(solution.step[0].abs() < 1e-15);
/// assert!((solution.cut_multipliers[0] - 2.0 / 3.0).abs() < 1e-15);
/// # Ok::<(), nonsmooth::qp::QpError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct EpigraphQpSolver {
    memory: Vec<Remembered>,
    coordinates: CoordinatesCache,
    gram: GramMemory,
    counts: QpCounts,
}

/// A member of the last active set, by an identity that outlives the call.
#[derive(Debug, Clone, Copy)]
struct Remembered {
    identity: Identity,
    multiplier: f64,
}

#[derive(Debug, Clone, Copy)]
enum Identity {
    Cut(u64),
    Row(usize),
    Bound(usize),
}

/// The result of one run of the active-set method.
struct Attempt {
    outcome: ActiveSetEnd,
    solution: QpSolution,
    actives: Vec<Active>,
}

impl EpigraphQpSolver {
    /// A solver without memory.
    pub fn new() -> Self {
        Self::default()
    }

    /// Work done so far.
    pub fn counts(&self) -> QpCounts {
        self.counts
    }

    /// Forgets the last active set: the next call of [`solve`](Self::solve) starts cold.
    pub fn forget(&mut self) {
        self.memory.clear();
    }

    /// Solves one QP, starting from the active set of the last one.
    ///
    /// # Errors
    /// [`QpError::Input`] for data that cannot be worked with, [`QpError::Infeasible`] if rows and box have no common
    /// point, [`QpError::NotSolved`] if no answer reaches a relative KKT residual of 1e-10 (without the feature
    /// `interior-point`: if the active-set method alone does not).
    pub fn solve(&mut self, qp: &EpigraphQp<'_>) -> Result<QpSolution, QpError> {
        qp.validate()?;
        let coordinates = self.coordinates.factorise(qp.metric, qp.dimension())?;
        self.counts.solves += 1;
        let warm = self.recall(qp);
        let first = Some((warm.as_slice(), CutEntry::Median)).filter(|_| !warm.is_empty());
        // A single cut has a single scale.
        let scales = if qp.slopes.len() == 1 { &[CutEntry::Median][..] } else { &CutEntry::ALL };
        let cold = scales.iter().map(|scale| (&[] as &[Active], *scale));
        let mut best: Option<Attempt> = None;
        let mut contradictions = vec![];
        for (start, cut_entry) in first.into_iter().chain(cold) {
            let attempt = run_active_set(qp, &coordinates, start, cut_entry);
            self.counts.pivots += attempt.solution.pivots;
            let done = attempt.outcome == ActiveSetEnd::Solved && attempt.solution.kkt_residual <= WANTED;
            if let (ActiveSetEnd::Infeasible { violation }, true) = (attempt.outcome, start.is_empty()) {
                contradictions.push(violation);
            }
            keep_better(&mut best, attempt);
            if done {
                break;
            }
        }
        // Where cuts are far steeper than others, rounding in one scale of the columns may look like a contradiction.
        // So may sides that are all but opposite where d = 0 meets them.
        let all = contradictions.len() == scales.len();
        if let Some(&violation) = contradictions.first().filter(|_| all && !holds_zero(qp)) {
            return Err(QpError::Infeasible { violation });
        }
        let best = match best {
            Some(best) if best.solution.kkt_residual <= WANTED => best,
            other => self.fall_back(qp, &coordinates, other)?,
        };
        self.finish(qp, best)
    }

    /// Solves one QP with a diagonal metric whose slopes have known inner products: first in the space of the
    /// multipliers, from the working set that the last such call has left, and, where that does not succeed, as
    /// [`solve`](Self::solve) does.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub(crate) fn solve_with_products(&mut self, qp: &EpigraphQp<'_>, gram: Gram<'_>) -> Result<QpSolution, QpError> {
        match self.gram.solve(qp, gram, WANTED) {
            Some(solution) => {
                self.counts.solves += 1;
                self.counts.pivots += solution.pivots;
                Ok(solution)
            }
            None => self.solve(qp),
        }
    }

    fn finish(&mut self, qp: &EpigraphQp<'_>, best: Attempt) -> Result<QpSolution, QpError> {
        if best.solution.kkt_residual <= REQUIRED {
            self.remember(qp, &best.actives);
            return Ok(best.solution);
        }
        self.memory.clear();
        Err(QpError::NotSolved { kkt_residual: best.solution.kkt_residual })
    }

    /// Returns the best answer so far, as there is no other method without the feature `interior-point`.
    #[cfg(not(feature = "interior-point"))]
    fn fall_back(
        &mut self,
        _qp: &EpigraphQp<'_>,
        _coordinates: &Coordinates,
        best: Option<Attempt>,
    ) -> Result<Attempt, QpError> {
        best.ok_or(QpError::NotSolved { kkt_residual: f64::INFINITY })
    }

    /// Runs the interior-point method, and then the active-set method from the members that the former has found
    /// active.
    #[cfg(feature = "interior-point")]
    fn fall_back(
        &mut self,
        qp: &EpigraphQp<'_>,
        coordinates: &Coordinates,
        mut best: Option<Attempt>,
    ) -> Result<Attempt, QpError> {
        self.counts.fallbacks += 1;
        let answer = match (interior_point::solve(qp), best) {
            (Ok(answer), known) => {
                best = known;
                answer
            }
            // The sides contradict each other by rounding only: the active-set method has found a point.
            (Err(_), Some(known)) if known.outcome == ActiveSetEnd::Solved => return Ok(known),
            (Err(error), _) => return Err(error),
        };
        let refined = run_active_set(qp, coordinates, &answer.actives, CutEntry::Median);
        self.counts.pivots += refined.solution.pivots;
        keep_better(&mut best, refined);
        let outcome = ActiveSetEnd::Stalled;
        keep_better(&mut best, Attempt { outcome, solution: answer.solution, actives: answer.actives });
        best.ok_or(QpError::NotSolved { kkt_residual: f64::INFINITY })
    }

    fn recall(&self, qp: &EpigraphQp<'_>) -> Vec<Active> {
        let find = |remembered: &Remembered| {
            let member = match remembered.identity {
                Identity::Cut(id) => Member::Cut(qp.cut_ids.iter().position(|known| *known == id)?),
                Identity::Row(i) => (i < qp.rows.nrows()).then_some(Member::Row(i))?,
                Identity::Bound(k) => (k < qp.dimension()).then_some(Member::Bound(k))?,
            };
            Some(Active { member, side: Side::Upper, multiplier: remembered.multiplier })
        };
        self.memory.iter().filter_map(find).collect()
    }

    fn remember(&mut self, qp: &EpigraphQp<'_>, actives: &[Active]) {
        let identify = |active: &Active| {
            let identity = match active.member {
                Member::Cut(j) => Identity::Cut(qp.cut_ids[j]),
                Member::Row(i) => Identity::Row(i),
                Member::Bound(k) => Identity::Bound(k),
            };
            Remembered { identity, multiplier: active.multiplier }
        };
        self.memory = actives.iter().map(identify).collect();
    }
}

/// Whether d = 0 lies in the box and between the sides of the rows.
fn holds_zero(qp: &EpigraphQp<'_>) -> bool {
    qp.row_lower.iter().chain(qp.lower).all(|side| *side <= 0.0)
        && qp.row_upper.iter().chain(qp.upper).all(|side| *side >= 0.0)
}

fn keep_better(best: &mut Option<Attempt>, attempt: Attempt) {
    if best.as_ref().is_none_or(|best| attempt.solution.kkt_residual < best.solution.kkt_residual) {
        *best = Some(attempt);
    }
}

/// Runs the active-set method from the members given.
fn run_active_set(qp: &EpigraphQp<'_>, coordinates: &Coordinates, warm: &[Active], cut_entry: CutEntry) -> Attempt {
    let mut set = WorkingSet::new(Sides::new(qp, cut_entry), coordinates);
    set.start(warm);
    let outcome = set.run();
    let actives: Vec<Active> = set.actives().copied().collect();
    let solution = assemble(qp, set.step, &actives, set.pivots, QpMethod::ActiveSet);
    Attempt { outcome, solution, actives }
}

#[cfg(all(test, feature = "interior-point"))]
mod tests {
    use super::super::Metric;
    use super::*;
    use crate::{Matrix, Vector};

    #[test]
    fn the_fallback_is_refined_to_the_accuracy_of_the_active_set_method() {
        let n = 6;
        let slopes: Vec<Vector> =
            (0..9).map(|j| Vector::from_fn(n, |i, _| (0.3 + (i * i + 1) as f64 * j as f64).sin())).collect();
        let (lower, upper) = (Vector::from_element(n, -0.2), Vector::from_element(n, 0.1));
        let qp = EpigraphQp {
            metric: Metric::ScaledIdentity(0.5),
            slopes: &slopes,
            offsets: &[0.0; 9],
            cut_ids: &[0, 1, 2, 3, 4, 5, 6, 7, 8],
            rows: &Matrix::zeros(0, n),
            row_lower: &Vector::zeros(0),
            row_upper: &Vector::zeros(0),
            lower: &lower,
            upper: &upper,
        };
        let mut solver = EpigraphQpSolver::new();
        let expected = solver.solve(&qp).expect("feasible");
        let coordinates = solver.coordinates.factorise(qp.metric, n).expect("positive");
        let attempt = solver.fall_back(&qp, &coordinates, None).expect("feasible");
        assert_eq!(solver.counts().fallbacks, 1);
        assert_eq!(attempt.solution.method, QpMethod::ActiveSet);
        assert!(attempt.solution.kkt_residual <= 1e-14);
        assert!((attempt.solution.step - expected.step).norm() <= 1e-14);
    }
}
