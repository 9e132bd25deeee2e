//! The admissible set with the linearized constraints, relaxed so far that it is not empty.

use super::memory::Constraints;
use super::tangent::Tangent;
use crate::bundle::norm::ScaledNorm;
use crate::bundle::proposers::proposal::Proposal;
use crate::bundle::proposers::subproblem::{self, Cuts};
use crate::bundle::step_trust::StepTrust;
use crate::qp::EpigraphQpSolver;
use crate::{ConstraintKind, Matrix, Polyhedron, Vector};
use std::borrow::Cow;
use std::rc::Rc;

/// Weight κ of the relaxation, times the violation: the linearized violation falls as long as it does so by a hundredth
/// of the length.
const WEIGHT: f64 = 1e-2;
/// Weights κ tried for one step.
const MAX_WEIGHTS: usize = 16;
/// A weight that lets the linearized violation fall by less than this share is too large.
const LEAST_SHARE: f64 = 0.01;
/// Linearizations this many times steeper than those of the center drown them in rounding, and are left out.
const MAX_RELATIVE_SLOPE: f64 = 1e5;
/// Share of the reduction by which the rows are relaxed beyond what is possible.
pub(crate) const ROOM: f64 = 1e-6;
/// The violation is stationary where its linearization falls by at most this share within reach.
const STATIONARY: f64 = 1e-6;

/// The set of the subproblems at a center.
#[derive(Debug)]
pub(crate) struct WorkingSet {
    /// U with the rows of the linearizations, which are measured in σ.
    pub set: Polyhedron,
    /// Number of rows of U.
    pub own_rows: usize,
    /// The linearizations behind the other rows.
    pub tangents: Rc<Vec<Tangent>>,
    /// σ_j of every constraint.
    pub units: Vec<f64>,
    /// The kinds of the constraints.
    pub kinds: Vec<ConstraintKind>,
    /// v(x̂) − s ≥ 0.
    pub reduction: f64,
    /// The violation that the rows leave.
    relaxation: f64,
    /// Steps that reduce the linearized violation most for their lengths: lengths, and by how much.
    path: Rc<Vec<(f64, f64)>>,
    /// Length of the step that the relaxation takes.
    pub forced_length: f64,
    /// The weight κ of this step.
    restoring_weight: f64,
    /// Whether the center satisfies the constraints to their tolerance.
    pub feasible: bool,
    /// Whether no direction reduces the violation.
    pub stationary: bool,
    /// Whether a constraint has given several linearizations at the center: all pieces near its largest one, which tell
    /// more of it than further linearizations elsewhere.
    pub of_pieces: bool,
    /// Whether the constraints are inequalities of which no linearization proves one nonconvex.
    pub convex: bool,
}

/// A linearization as seen from the center, in σ.
struct Seen<'a> {
    tangent: Cow<'a, Tangent>,
    slope: Vector,
    level: f64,
    two_sided: bool,
    /// Whether it tells about the constraint next to the center: it was taken there, or the constraint looks convex and
    /// nonsmooth.
    holds: bool,
}

impl WorkingSet {
    /// Whether the violation, rather than the objective, determines a step of this length.
    pub(crate) fn forces(&self, step_length: f64) -> bool {
        step_length <= 2.0 * self.forced_length
    }

    /// Learns how far the linearizations of violated constraints hold, from the values at the end of a step whose
    /// length they determined.
    pub(crate) fn learn(&self, constraints: &mut Constraints, length: f64, serious: bool, values: &Vector) {
        if !(self.restoring() && self.forces(length)) {
            return;
        }
        if serious {
            let drop = constraints.center_violation() - constraints.violation(values);
            let good = drop >= 0.5 * self.reduction;
            let next = |_| StepTrust::accepted(self.restoring_weight, good);
            constraints.restoring = constraints.restoring.map(next);
        } else {
            constraints.restoring = Some(StepTrust::rejected(self.restoring_weight, length));
        }
    }

    /// The set without the linearizations that are not wanted.
    pub(crate) fn filtered(&self, keep: impl Fn(&Tangent) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.tangents.len()).filter(|&i| keep(&self.tangents[i])).collect();
        Self {
            set: self.set.with_tangents_kept(&kept),
            tangents: Rc::new(kept.iter().map(|&i| self.tangents[i].clone()).collect()),
            units: self.units.clone(),
            kinds: self.kinds.clone(),
            path: Rc::clone(&self.path),
            ..*self
        }
    }

    /// Σ |μ_j| of the rows of the linearizations at a proposal.
    pub(crate) fn multipliers(&self, proposal: &Proposal) -> f64 {
        proposal.row_multipliers.iter().skip(self.own_rows).map(|multiplier| multiplier.abs()).sum()
    }

    /// The set with rows that leave another violation s.
    pub(crate) fn leaving(&self, left: f64) -> Self {
        Self {
            set: self.set.with_tangents_relaxed(left - self.relaxation),
            relaxation: left,
            reduction: self.reduction + self.relaxation - left,
            tangents: Rc::clone(&self.tangents),
            units: self.units.clone(),
            kinds: self.kinds.clone(),
            path: Rc::clone(&self.path),
            ..*self
        }
    }

    /// By how much a step of this length can reduce the linearized violation, linearly between the steps of the
    /// relaxation.
    pub(crate) fn reducible(&self, length: f64) -> f64 {
        let mut from = (0.0, 0.0);
        for &to in self.path.iter() {
            if length <= to.0 {
                return from.1 + (length - from.0) / (to.0 - from.0) * (to.1 - from.1);
            }
            from = to;
        }
        from.1
    }

    /// The set with the linearizations at a trial point that has not become the center: a step from there may leave as
    /// much violation as the step to it was to leave. None where that point is not known.
    pub(crate) fn at_rejected(&self, own: &Polyhedron, constraints: &Constraints, point: &Vector) -> Option<Self> {
        let left = (constraints.center_violation() - self.reduction).max(0.0);
        let unit = |t: &Tangent| self.units[t.constraint];
        let tangents = constraints.rejected_tangents(point)?.iter();
        let tangents: Vec<Tangent> = tangents.filter(|t| unit(t) > 0.0 && t.slope.amax() > 0.0).cloned().collect();
        let rows = Matrix::from_fn(tangents.len(), point.len(), |i, k| tangents[i].slope[k] / unit(&tangents[i]));
        let at_point = &rows * point;
        let level = Vector::from_fn(tangents.len(), |i, _| at_point[i] - tangents[i].value / unit(&tangents[i]));
        let two_sided = |i: usize| self.kinds[tangents[i].constraint] == ConstraintKind::SmoothEquality;
        let lower =
            Vector::from_fn(tangents.len(), |i, _| if two_sided(i) { level[i] - left } else { f64::NEG_INFINITY });
        Some(Self {
            set: own.clone().with_tangents(&rows, &lower, &level.add_scalar(left)),
            tangents: Rc::new(tangents),
            units: self.units.clone(),
            kinds: self.kinds.clone(),
            path: Rc::clone(&self.path),
            ..*self
        })
    }

    /// Whether the next step has to reduce the violation.
    pub(crate) fn restoring(&self) -> bool {
        !self.feasible
    }

    pub(crate) fn new(
        set: &Polyhedron,
        constraints: &Constraints,
        center: &Vector,
        norm: &ScaledNorm,
        negligible: f64,
        reach: f64,
        solver: &mut EpigraphQpSolver,
    ) -> Self {
        let mut seen = seen_from(constraints, center, norm);
        let (violation, excess) = (constraints.center_violation(), constraints.center_excess());
        let mut restoring = Restoring { left: violation, stationary: false, length: 0.0, weight: 0.0 };
        let mut path = vec![];
        let costly = constraints.sensitivity * violation > negligible;
        if excess > 1e-3 || costly {
            (restoring, path) = relax(set, constraints, &seen, reach, center, norm, solver);
            if restoring.stationary && seen.iter().any(|seen| !seen.holds) {
                // Linearizations at other points prove nothing where a constraint is not convex.
                seen.retain(|seen| seen.holds);
                (restoring, path) = relax(set, constraints, &seen, reach, center, norm, solver);
            }
        }
        // The rows keep a common point in the rounding of the subproblem.
        let relaxation = restoring.left + ROOM * (violation - restoring.left);
        let seen: Vec<Seen<'_>> = seen.into_iter().filter(|seen| seen.slope.amax() > 0.0).collect();
        let rows = Matrix::from_fn(seen.len(), center.len(), |i, k| seen[i].slope[k]);
        let at_center = &rows * center;
        let upper = Vector::from_fn(seen.len(), |i, _| at_center[i] - seen[i].level + relaxation);
        let lower = Vector::from_fn(seen.len(), |i, _| {
            if seen[i].two_sided { at_center[i] - seen[i].level - relaxation } else { f64::NEG_INFINITY }
        });
        let own_rows = set.rows().nrows();
        let extended = set.clone().with_tangents(&rows, &lower, &upper);
        Self {
            set: extended,
            own_rows,
            tangents: Rc::new(seen.iter().map(|seen| (*seen.tangent).clone()).collect()),
            units: (0..constraints.kinds().len()).map(|j| constraints.unit(j)).collect(),
            kinds: constraints.kinds().to_vec(),
            relaxation,
            path: Rc::new(path),
            forced_length: restoring.length,
            restoring_weight: restoring.weight,
            reduction: (violation - relaxation).max(0.0),
            feasible: excess <= 1.0 && !costly,
            stationary: restoring.stationary && excess > 1.0,
            of_pieces: has_pieces(constraints.tangents().0),
            convex: !constraints.nonconvex().contains(&true)
                && !constraints.kinds().contains(&ConstraintKind::SmoothEquality),
        }
    }
}

/// Whether a constraint has several linearizations among those at the center.
fn has_pieces(own: &[Tangent]) -> bool {
    let mut of: Vec<usize> = own.iter().map(|tangent| tangent.constraint).collect();
    of.sort_unstable();
    of.windows(2).any(|pair| pair[0] == pair[1])
}

/// The linearizations that can matter, in σ. One at another point never lies above the constraint at the center.
fn seen_from<'a>(constraints: &'a Constraints, center: &Vector, norm: &ScaledNorm) -> Vec<Seen<'a>> {
    let (own, others) = constraints.tangents();
    let values = constraints.at_center();
    let view = |tangent: Cow<'a, Tangent>, level: f64| {
        let unit = constraints.unit(tangent.constraint);
        let two_sided = constraints.kinds()[tangent.constraint] == ConstraintKind::SmoothEquality;
        (unit > 0.0).then(|| Seen {
            slope: &*tangent.slope / unit,
            level: level / unit,
            two_sided,
            holds: *tangent.point == *center
                || constraints.kinds()[tangent.constraint] == ConstraintKind::Nonsmooth
                    && !constraints.nonconvex()[tangent.constraint],
            tangent,
        })
    };
    let of_center = own.iter().filter_map(|t| view(Cow::Borrowed(t), t.value));
    let curvatures = curvatures(constraints, center, norm);
    let of_others = others.iter().filter_map(|t| {
        let (value, curvature) = (values[t.constraint], curvatures[t.constraint]);
        let error = (value - t.at(center)).abs();
        if curvature == 0.0 {
            return view(Cow::Borrowed(t), value - error);
        }
        let away = &*t.point - center;
        let level = value - error.max(curvature * norm.squared(&away));
        let slope = &*t.slope + norm.lower_index(&away) * (2.0 * curvature);
        let convexified = Tangent { value: level + slope.dot(&away), slope: Rc::new(slope), ..t.clone() };
        view(Cow::Owned(convexified), level)
    });
    let mut seen: Vec<Seen<'_>> = of_center.collect();
    let steepest = seen.iter().map(|seen| seen.slope.amax()).fold(1.0, f64::max);
    seen.extend(of_others.filter(|seen| seen.slope.amax() <= MAX_RELATIVE_SLOPE * steepest));
    seen
}

/// The curvature γ with which c_j + γ‖x − x̂‖² lies above its linearizations at the center, for every nonsmooth
/// constraint.
fn curvatures(constraints: &Constraints, center: &Vector, norm: &ScaledNorm) -> Vec<f64> {
    let mut curvatures = vec![0.0_f64; constraints.kinds().len()];
    for t in constraints.tangents().1.iter().filter(|t| {
        constraints.nonconvex()[t.constraint] && constraints.kinds()[t.constraint] == ConstraintKind::Nonsmooth
    }) {
        let above = t.at(center) - constraints.at_center()[t.constraint];
        let squared = norm.squared(&(&*t.point - center));
        if above > 0.0 && squared > 0.0 {
            curvatures[t.constraint] = curvatures[t.constraint].max(above / squared);
        }
    }
    curvatures
}

/// A step that reduces the linearized violation.
#[derive(Debug, Clone, Copy)]
struct Restoring {
    /// The violation s that it leaves.
    left: f64,
    /// Whether the violation is stationary.
    stationary: bool,
    /// Its length.
    length: f64,
    /// κ.
    weight: f64,
}

/// The violation as the largest of linear functions: their slopes, and how far they lie below it at the center.
fn below(violation: f64, seen: &[Seen<'_>], dimension: usize) -> (Vec<Vector>, Vec<f64>) {
    let mut slopes = vec![Vector::zeros(dimension)];
    let mut offsets = vec![violation];
    for seen in seen {
        slopes.push(seen.slope.clone());
        offsets.push(violation - seen.level);
        if seen.two_sided {
            slopes.push(-&seen.slope);
            offsets.push(violation + seen.level);
        }
    }
    (slopes, offsets)
}

/// The step that reduces the violation: min over d of max_i (level_i + ⟨h_i, d⟩) + κ‖d‖²/2, within the set; with the
/// steps for other κ, longer and longer, and by how much they reduce it.
fn relax(
    set: &Polyhedron,
    constraints: &Constraints,
    seen: &[Seen<'_>],
    reach: f64,
    center: &Vector,
    norm: &ScaledNorm,
    solver: &mut EpigraphQpSolver,
) -> (Restoring, Vec<(f64, f64)>) {
    let (violation, trust) = (constraints.center_violation(), constraints.restoring);
    let longest = trust.map_or(f64::INFINITY, |trust| trust.longest);
    let (slopes, offsets) = below(violation, seen, center.len());
    let ids: Vec<u64> = (0..slopes.len() as u64).collect();
    let cuts = Cuts { slopes: &slopes, offsets: &offsets, ids: &ids, gram: None };
    let steepest = slopes.iter().zip(&offsets).filter(|(_, offset)| **offset <= 0.5 * violation);
    let slope = steepest.map(|(slope, _)| norm.dual_length(slope)).fold(0.0, f64::max);
    let first_weight = WEIGHT * if slope > 0.0 { slope * slope } else { 1.0 } / violation;
    let mut weight = trust.map_or(first_weight, |trust| trust.weight);
    let mut best = Restoring { left: violation, stationary: false, length: 0.0, weight };
    let (mut first, mut path): (bool, Vec<(f64, f64)>) = (true, vec![]);
    for _ in 0..MAX_WEIGHTS {
        let metric = norm.weighted(weight);
        let Ok(solution) = subproblem::solve(solver, set, center, metric.metric(), cuts) else { break };
        let length = norm.length(&solution.step);
        // The linearized violation falls by no more than this within reach.
        let error: f64 = offsets.iter().zip(&solution.cut_multipliers).map(|(a, m)| m * a).sum();
        if error + weight * length * reach <= STATIONARY * violation {
            return (Restoring { stationary: true, ..best }, path);
        }
        if length > longest {
            if best.left < violation {
                break;
            }
            weight *= 10.0;
            continue;
        }
        let level = |seen: &Seen<'_>| {
            let level = seen.level + seen.slope.dot(&solution.step);
            if seen.two_sided { level.abs() } else { level }
        };
        let left = seen.iter().map(level).fold(0.0, f64::max).min(violation);
        let gained = best.left - left;
        if path.last().is_none_or(|last| length > last.0 && violation - left > last.1) {
            path.push((length, violation - left));
        }
        if gained > 0.0 {
            best = Restoring { left, stationary: false, length, weight };
        }
        // The relaxation is small enough, or no longer step reduces it much. Once a step has failed, its weight says
        // how far the linearizations hold.
        let falls = best.left < (1.0 - LEAST_SHARE) * violation;
        let enough = best.left <= 0.1 * violation || trust.is_some() && falls;
        if enough || !first && falls && gained <= 0.1 * best.left {
            break;
        }
        first = false;
        weight /= 10.0;
    }
    (best, path)
}
