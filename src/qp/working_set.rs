//! The working set: which cuts, rows and bounds are held active, with their multipliers and factors, and the step.
//!
//! ```text
//! column of a member:  ã = (L⁻¹ normal, c s),   s = 1 for a cut, 0 otherwise
//! ```
//! The extra entry c carries the equality Σ π = 1 into the orthogonal factors: ÃᵀÃ = N H⁻¹Nᵀ + c² s sᵀ, with the active
//! normals as rows of N, is regular whenever the vectors (normal, s) of the active members are linearly independent.
//! The last row of Q is c R⁻ᵀs, so that the factors hold s as well. With a diagonal metric an active bound is no
//! column: it fixes its coordinate.

use crate::Vector;

use super::certificate::{LENGTH_SHARE, SIDE_SHARE};
use super::coordinates::Coordinates;
use super::factor::{Factor, Split};
use super::kernels::dot_terms;
use super::sides::{Member, Normal, Sides};

/// The side at which a member is active; cuts have an upper side only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Lower,
    Upper,
    Both,
}

/// An active member. The multiplier is signed: ≥ 0 at the upper side, ≤ 0 at the lower side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Active {
    pub(super) member: Member,
    pub(super) side: Side,
    pub(super) multiplier: f64,
}

/// Where an active member is kept.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place {
    /// Column of the factors.
    Column(usize),
    /// Fixed coordinate.
    Coordinate(usize),
}

pub(super) struct WorkingSet<'a> {
    pub(super) sides: Sides<'a>,
    pub(super) coordinates: &'a Coordinates,
    pub(super) factor: Factor,
    pub(super) general: Vec<Active>,
    pub(super) fixed: Vec<Option<Active>>,
    held: Vec<bool>,
    /// The current d, with fixed coordinates at their bounds.
    pub(super) step: Vector,
    /// The current v.
    pub(super) epigraph: f64,
    pub(super) pivots: usize,
    /// ℓ = |d| + norm of the steepest cut.
    reach: f64,
    /// Smallest size of an active cut: one v serves them all, so an error of one is an error of each.
    pub(super) smallest_cut_size: f64,
}

impl<'a> WorkingSet<'a> {
    pub(super) fn new(sides: Sides<'a>, coordinates: &'a Coordinates) -> Self {
        let n = sides.qp.dimension();
        Self {
            coordinates,
            factor: Factor::new(n + 1),
            general: Vec::new(),
            fixed: vec![None; n],
            held: vec![false; sides.count()],
            step: Vector::zeros(n),
            epigraph: 0.0,
            pivots: 0,
            reach: sides.steepest,
            smallest_cut_size: f64::INFINITY,
            sides,
        }
    }

    pub(super) fn is_held(&self, member: Member) -> bool {
        self.held[self.sides.index(member)]
    }

    /// normalᵀ d − s v.
    pub(super) fn value(&self, member: Member) -> f64 {
        let product = self.sides.product(member, self.step.as_slice());
        if member.is_cut() { product - self.epigraph } else { product }
    }

    /// Size of the terms of `value − side`.
    pub(super) fn terms(&self, member: Member, side: f64) -> f64 {
        let terms = match self.sides.normal(member) {
            Normal::Gradient(gradient) => dot_terms(gradient, self.step.as_slice()),
            Normal::Axis(k) => self.step[k].abs(),
        };
        let epigraph = if member.is_cut() { self.epigraph.abs() } else { 0.0 };
        terms + epigraph + side.abs()
    }

    /// Size of a side: its terms, plus a share of its normal for the case that they vanish.
    pub(super) fn size(&self, member: Member, side: f64) -> f64 {
        self.terms(member, side) + LENGTH_SHARE * self.reach * self.sides.norm(member)
    }

    /// Size of a side that counts the rounding of all sides too, as in the certificate.
    pub(super) fn data_size(&self, member: Member, side: f64) -> f64 {
        let largest = if member.is_cut() { 0.0 } else { self.sides.largest };
        self.size(member, side) + SIDE_SHARE * largest * self.sides.norm(member)
    }

    /// Updates the sizes against which residuals are measured to the current step.
    pub(super) fn measure(&mut self) {
        let square = |(k, d): (usize, &f64)| d * d * self.sides.qp.metric.diagonal_entry(k);
        self.reach = self.sides.steepest + self.step.iter().enumerate().map(square).sum::<f64>().sqrt();
        let cuts = self.general.iter().filter(|active| active.member.is_cut());
        let sizes = cuts.map(|active| self.size(active.member, self.held_value(active)));
        self.smallest_cut_size = sizes.fold(f64::INFINITY, f64::min);
    }

    /// The value an active member is held at.
    pub(super) fn held_value(&self, active: &Active) -> f64 {
        let (lower, upper) = self.sides.interval(active.member);
        if active.side == Side::Lower { lower } else { upper }
    }

    /// The column of a member in the factors.
    pub(super) fn column(&self, member: Member) -> Vec<f64> {
        let mut column = match self.sides.normal(member) {
            Normal::Gradient(gradient) => self.coordinates.normal(gradient),
            Normal::Axis(k) => {
                let mut unit = vec![0.0; self.sides.qp.dimension()];
                unit[k] = self.coordinates.axis_length(k).unwrap_or(1.0);
                self.coordinates.normal(&unit)
            }
        };
        column.push(if member.is_cut() { self.sides.cut_entry } else { 0.0 });
        column
    }

    /// The coordinate that an active bound fixes, if the metric is diagonal.
    pub(super) fn coordinate(&self, member: Member) -> Option<usize> {
        match member {
            Member::Bound(k) => self.coordinates.axis_length(k).map(|_| k),
            _ => None,
        }
    }

    /// Takes a member in unless it depends on those held; tells whether it was taken.
    pub(super) fn try_hold(&mut self, active: Active) -> bool {
        if self.is_held(active.member) {
            return false;
        }
        let column = self.column(active.member);
        let split = self.factor.split(&column);
        if split.is_dependent() {
            return false;
        }
        self.hold(active, column, split);
        true
    }

    /// Takes in a member whose split is known to be independent.
    pub(super) fn hold(&mut self, active: Active, column: Vec<f64>, split: Split) {
        if let Some(k) = self.coordinate(active.member) {
            self.factor.fix(k, split);
            self.fixed[k] = Some(active);
        } else {
            self.factor.push(column, split);
            self.general.push(active);
        }
        self.held[self.sides.index(active.member)] = true;
        self.pivots += 1;
    }

    /// Lets a member go.
    pub(super) fn release(&mut self, place: Place) {
        let released = match place {
            Place::Column(position) => {
                self.factor.remove(position);
                Some(self.general.remove(position))
            }
            Place::Coordinate(k) => {
                self.factor.release(k);
                self.fixed[k].take()
            }
        };
        if let Some(active) = released {
            self.held[self.sides.index(active.member)] = false;
        }
        self.pivots += 1;
    }

    pub(super) fn actives(&self) -> impl Iterator<Item = &Active> {
        self.general.iter().chain(self.fixed.iter().flatten())
    }

    /// Sum of the active cuts' multipliers.
    pub(super) fn cut_sum(&self) -> f64 {
        self.general.iter().filter(|active| active.member.is_cut()).map(|a| a.multiplier).sum()
    }

    /// Adds the normals of the columns, each times the factor of its column.
    pub(super) fn add_normals(&self, sum: &mut [f64], factors: impl IntoIterator<Item = f64>) {
        for (active, factor) in self.general.iter().zip(factors) {
            self.sides.add_normal(sum, factor, active.member);
        }
    }

    /// Sets d to the minimiser that belongs to the multipliers of the columns, v to 0.
    pub(super) fn place_step(&mut self) {
        let mut step = Vector::zeros(self.step.len());
        self.add_normals(step.as_mut_slice(), self.general.iter().map(|active| active.multiplier));
        self.coordinates.minimiser(&mut step);
        self.step = step;
        self.epigraph = 0.0;
    }

    /// Puts fixed coordinates on their bounds without rounding.
    pub(super) fn place_fixed(&mut self) {
        for k in 0..self.fixed.len() {
            if let Some(active) = self.fixed[k] {
                self.step[k] = self.held_value(&active);
            }
        }
    }
}

/// The first multiplier that reaches zero: the length until then, and the place of its member.
#[derive(Default)]
pub(super) struct FirstBlock(pub(super) Option<(f64, Place)>);

impl FirstBlock {
    pub(super) fn consider(&mut self, length: Option<f64>, place: Place) {
        if let Some(length) = length.filter(|length| self.0.is_none_or(|(shortest, _)| *length < shortest)) {
            self.0 = Some((length, place));
        }
    }
}
