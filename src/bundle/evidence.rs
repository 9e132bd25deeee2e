//! What the multipliers of a subproblem say about its center, whatever the units of the variables.
//!
//! ```text
//! z̃ = Σ λ_j g_j + Aᵀμ + ν,   ẽ                      aggregate subgradient and aggregate error
//! Θ(x̂) − Θ(y) ≤ ẽ + Σ_i |z̃_i| |y_i − x̂_i|             if Θ is convex
//! small:    |z̃_i| ≤ 1e-3 max(Σ_j λ_j |g_ji| + Σ |A_ki μ_k| + |ν_i|,  largest |g_i| of the run)      variable i
//! distance of cut j:  Σ_i steepest |g_i| of the bundle · |y_ji − x̂_i|, in units of Θ
//! ```
//! No number changes if a variable is measured in another unit: a coordinate of z̃ is compared with what cancels in
//! this coordinate, with the slopes seen along it, or with the width of the box.

use super::cut::{Cut, LEAST_ACTIVE_MULTIPLIER};
use super::proposers::proposal::Proposal;
use super::state::BundleState;
use crate::{Polyhedron, Vector};

/// A coordinate of the aggregate subgradient counts as small below this share of what cancels in it. Points that are
/// not stationary have shares of 0.03 and more; at smooth minima, where nothing cancels, a share of 1e-3 of the slopes
/// seen leaves 1e-6 of the decrease.
const SMALL_SHARE: f64 = 1e-3;
/// A sum that cancels to this share of its terms is zero as far as the multipliers of a subproblem tell.
const CANCELLED_SHARE: f64 = 1e-8;
/// Subgradients of the center itself that cancel to this share of their terms prove it stationary: away from kinks and
/// vertices nothing cancels, and where a point is not stationary shares are 0.03 and more.
const EXACT_SHARE: f64 = 1e-5;
/// Rounding of a sum, as a share of its terms.
const ROUNDING: f64 = 2.0 * f64::EPSILON;

/// The aggregate subgradient along a variable, with the sizes to compare it with.
#[derive(Debug, Clone, Copy)]
struct Coordinate {
    /// |z̃_i|.
    slope: f64,
    /// The sum of what cancels in z̃_i.
    terms: f64,
    /// The largest |g_i| of the run.
    steepest: f64,
    /// How far the variable may move: to the farther side of the box.
    room: f64,
    /// How far the variable lies from zero or from its start.
    moved: f64,
    /// How far from the center the variable has gone in the run.
    farthest: f64,
}

impl Coordinate {
    /// |z̃_i|, and what rounding of the sum can hide.
    fn largest_slope(&self) -> f64 {
        self.slope + ROUNDING * self.terms
    }

    fn is_small(&self) -> bool {
        self.largest_slope() <= SMALL_SHARE * self.terms.max(self.steepest)
    }

    /// Whether the slope is zero as far as the multipliers tell.
    fn is_zero(&self) -> bool {
        self.slope <= CANCELLED_SHARE * self.terms
    }

    /// |z̃_i| times a distance that the box may shorten.
    fn fall(&self, distance: f64) -> f64 {
        let slope = self.largest_slope();
        if slope > 0.0 { slope * distance.min(self.room) } else { 0.0 }
    }
}

/// Aggregate subgradient and error at a center.
#[derive(Debug, Clone)]
pub(crate) struct Evidence {
    coordinates: Vec<Coordinate>,
    /// ẽ.
    pub error: f64,
    /// The decrease seen in the run, in units of Θ.
    pub drop: f64,
    /// The decrease from the start on.
    drop_from_start: f64,
    /// Largest distance of an active cut, in units of Θ: how far the linearizations of the bundle can vary in between.
    pub distance: f64,
    /// Largest distance of an active cut in the norm of the run, relative to the size of the variables; for reports.
    pub radius: f64,
    /// Whether all active cuts are those of the center itself, so that no difference of values enters.
    at_center: bool,
    /// Whether the active nonlinear constraints are degenerate.
    pub degenerate: bool,
    /// Whether the outputs behind Θ and their Jacobian give it, without any difference of values.
    pub of_outputs: bool,
}

impl Evidence {
    pub(crate) fn new(state: &BundleState, set: &Polyhedron, proposal: &Proposal) -> Self {
        let (sum, terms) = aggregate(state, set, proposal);
        let coordinate = |i: usize| Coordinate {
            slope: f64::abs(sum[i]),
            terms: terms[i],
            steepest: state.seen.steepest[i],
            room: (set.upper()[i] - state.center[i]).max(state.center[i] - set.lower()[i]),
            moved: state.reach(i),
            farthest: state.seen.farthest(i, state.center[i]),
        };
        let of_outputs = proposal.composite_aggregate.is_some();
        let active = || active_cuts(state, proposal);
        let distances = Distances::new(state);
        let far = |point: &Vector| *point != state.center;
        let tangents = || proposal.active_tangents().map(|(tangent, _)| &*tangent.point).filter(|point| far(point));
        let of_tangents = tangents().map(|point| distances.length(&(point - &state.center))).fold(0.0, f64::max);
        Self {
            coordinates: (0..sum.len()).map(coordinate).collect(),
            error: proposal.cut_error + proposal.slack_error,
            drop: state.drop_from(state.seen.highest),
            drop_from_start: state.drop_from(state.start_value),
            distance: if of_outputs {
                of_tangents
            } else {
                active().map(|cut| distances.of(cut)).fold(of_tangents, f64::max)
            },
            radius: radius(state, proposal, of_outputs),
            of_outputs,
            degenerate: degenerate(state, proposal),
            at_center: tangents().next().is_none()
                && (of_outputs || proposal.cut_error == 0.0 && active().all(|cut| cut.id == state.center_id)),
        }
    }

    /// Whether nothing but rounding is left: subgradients of the center itself and the normal cone cancel.
    pub(crate) fn is_exact(&self, small: f64) -> bool {
        self.at_center && self.error <= small && self.cancels()
    }

    /// Whether the subgradients cancel along every variable.
    pub(crate) fn cancels(&self) -> bool {
        self.coordinates.iter().all(|i| i.slope <= EXACT_SHARE * i.terms)
    }

    /// The terms that cancel in the aggregate subgradient, times how far the variables have moved.
    pub(crate) fn cancelling(&self) -> f64 {
        self.coordinates.iter().map(|i| i.terms * i.moved).sum()
    }

    /// ẽ + Σ |z̃_i| reach_i over the coordinates that do not cancel: what Θ, if it is convex, can still fall within
    /// reach and in the box. A variable reaches as far as it has moved, or as far as the slopes along it would need for
    /// the decrease of the run.
    pub(crate) fn remaining(&self) -> f64 {
        let falls = |i: &Coordinate| if i.is_zero() { 0.0 } else { i.fall(i.moved.max(self.drop / i.steepest)) };
        self.error + self.coordinates.iter().map(falls).sum::<f64>()
    }

    /// How far a convex Θ can lie above its minimum: a proof in the variables with finite bounds. The others reach as
    /// far as the run has gone, and what cancels to 1e-8 along them counts as zero.
    pub(crate) fn gap(&self) -> f64 {
        let reach = |i: &Coordinate| i.moved.max(i.farthest).max(self.drop_from_start / i.steepest);
        let falls = |i: &Coordinate| {
            if i.room.is_finite() {
                i.fall(i.room)
            } else if i.is_zero() {
                0.0
            } else {
                i.fall(reach(i))
            }
        };
        self.error + self.coordinates.iter().map(falls).sum::<f64>()
    }

    /// The first variable along which the aggregate subgradient is not small; a fall of at most `allowed` that the box
    /// proves counts as small.
    pub(crate) fn undecided(&self, allowed: f64) -> Option<usize> {
        self.coordinates.iter().position(|i| !(i.is_small() || i.fall(f64::INFINITY) <= allowed))
    }
}

/// The cuts of the bundle with a multiplier in the proposal that is no rounding.
pub(crate) fn active_cuts<'s>(state: &'s BundleState, proposal: &'s Proposal) -> impl Iterator<Item = &'s Cut> {
    let cuts = state.bundle.cuts().iter().zip(&proposal.cut_multipliers);
    cuts.filter(|(_, multiplier)| **multiplier > LEAST_ACTIVE_MULTIPLIER).map(|(cut, _)| cut)
}

/// Distances of cuts from the center in units of Θ.
pub(crate) struct Distances<'s> {
    state: &'s BundleState,
    /// The largest |g_i| in the bundle, for every variable.
    steepest: Vector,
}

impl<'s> Distances<'s> {
    pub(crate) fn new(state: &'s BundleState) -> Self {
        let mut steepest = Vector::zeros(state.center.len());
        for cut in state.bundle.cuts() {
            steepest.zip_apply(&cut.subgradient, |largest, slope| *largest = largest.max(slope.abs()));
        }
        Self { state, steepest }
    }

    /// Σ_i steepest_i |d_i|.
    pub(crate) fn length(&self, step: &Vector) -> f64 {
        self.steepest.dot(&step.abs())
    }

    /// The direction g_i/steepest_i² that a subgradient belongs to.
    pub(crate) fn raise(&self, subgradient: &Vector) -> Vector {
        subgradient
            .zip_map(&self.steepest, |slope, steepest| if steepest > 0.0 { slope / (steepest * steepest) } else { 0.0 })
    }

    /// Σ_i steepest_i |y_i − x̂_i|, for merged cuts of the farthest point behind them.
    pub(crate) fn of(&self, cut: &Cut) -> f64 {
        let state = self.state;
        let far = |i: usize| (cut.point[i] - state.center[i]).abs() + cut.radius * state.norm.unit(i);
        (0..self.steepest.len()).filter(|i| self.steepest[*i] > 0.0).map(|i| self.steepest[i] * far(i)).sum()
    }
}

/// The radius of the active cuts, relative to the size of the variables in the run.
fn radius(state: &BundleState, proposal: &Proposal, of_outputs: bool) -> f64 {
    let tangents = proposal.active_tangents().map(|(tangent, _)| state.norm.length(&(&*tangent.point - &state.center)));
    let of_tangents = tangents.fold(0.0, f64::max);
    let cuts = active_cuts(state, proposal).filter(|_| !of_outputs);
    let farthest = cuts.map(|cut| cut.farthest_from(&state.center, &state.norm)).fold(of_tangents, f64::max);
    if farthest > 0.0 { farthest / state.length_scale().max(f64::MIN_POSITIVE) } else { 0.0 }
}

/// Whether the multipliers of the nonlinear constraints are those of degenerate constraints.
fn degenerate(state: &BundleState, proposal: &Proposal) -> bool {
    let Some(constraints) = &state.constraints else { return false };
    let mut multipliers = vec![0.0; constraints.kinds().len()];
    for (tangent, multiplier) in proposal.active_tangents() {
        multipliers[tangent.constraint] += multiplier / constraints.unit(tangent.constraint);
    }
    let slope = match &proposal.composite_aggregate {
        Some(slope) => state.norm.dual_length(slope),
        None => {
            let cuts = state.bundle.cuts().iter().zip(&proposal.cut_multipliers);
            cuts.map(|(cut, multiplier)| multiplier * state.norm.dual_length(&cut.subgradient)).sum()
        }
    };
    constraints.is_degenerate(&multipliers, slope, &state.norm, state.length_scale())
}

/// z̃ and the sum of the absolute values of its terms, from the multipliers and the subgradients as they are.
fn aggregate(state: &BundleState, set: &Polyhedron, proposal: &Proposal) -> (Vector, Vector) {
    let (rows, bounds) = (&proposal.row_multipliers, &proposal.bound_multipliers);
    let mut sum = bounds + set.rows().tr_mul(rows);
    let mut terms = bounds.abs() + set.rows().abs().tr_mul(&rows.abs());
    let mut add = |multiplier: f64, slope: &Vector| {
        sum.axpy(multiplier, slope, 1.0);
        terms.zip_apply(slope, |term, slope| *term += (multiplier * slope).abs());
    };
    match &proposal.composite_aggregate {
        Some(slope) => {
            add(1.0, slope);
            if let Some(outputs) = &state.output_scales {
                terms.zip_apply(&outputs.slopes, |term, slope| *term = term.max(slope));
            }
        }
        None => {
            let cuts = state.bundle.cuts().iter().zip(&proposal.cut_multipliers);
            cuts.filter(|(_, multiplier)| **multiplier > 0.0).for_each(|(cut, &m)| add(m, &cut.subgradient));
        }
    }
    (sum, terms)
}
