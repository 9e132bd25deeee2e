//! The working set: which cuts, rows and bounds are held active, with their multipliers and factors.
//!
//! ```text
//! column of a member:  ã = (L⁻¹ normal, c s),   s = 1 for a cut, 0 otherwise
//! ```
//! The extra entry c carries the equality Σ π = 1 into the orthogonal factors: ÃᵀÃ = N H⁻¹Nᵀ + c² s sᵀ, with the active
//! normals as rows of N, is regular whenever the vectors (normal, s) of the active members are linearly independent.
//! The last row of Q is c R⁻ᵀs, so that the factors hold s as well. With a diagonal metric an active bound is no
//! column: it fixes its coordinate.

use crate::Vector;
use crate::linalg::upper_median;

use super::certificate::{LENGTH_SHARE, SIDE_SHARE, largest_side};
use super::coordinates::Coordinates;
use super::factor::{Factor, Split};
use super::kernels::{dot, dot_terms};
use super::problem::EpigraphQp;

/// One inequality or equality of the QP.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Member {
    Cut(usize),
    Row(usize),
    Bound(usize),
}

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

/// The extra entry c of a cut's column (g̃, c). Columns lose the digits of what is small beside c, and of c where it is
/// small itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CutEntry {
    /// The median norm of the cuts.
    Median,
    /// The geometric mean of the median and the least norm: where most cuts are far steeper than the active ones.
    Lower,
    /// The geometric mean of the median and the largest norm: where the active cuts are far steeper than most, and
    /// beside them a side looks as if it depended on those held.
    Upper,
}

pub(super) struct WorkingSet<'a> {
    pub(super) qp: &'a EpigraphQp<'a>,
    pub(super) coordinates: &'a Coordinates,
    /// Rows of A, one after the other.
    rows: Vec<f64>,
    /// Norms of the normals, cuts then rows.
    pub(super) norms: Vec<f64>,
    /// The extra entry c of a cut's column.
    pub(super) cut_entry: f64,
    pub(super) factor: Factor,
    pub(super) general: Vec<Active>,
    pub(super) fixed: Vec<Option<Active>>,
    held: Vec<bool>,
    /// The current d, with fixed coordinates at their bounds.
    pub(super) step: Vector,
    /// The current v.
    pub(super) epigraph: f64,
    pub(super) pivots: usize,
    /// Norm of the steepest cut: the length of the unconstrained step.
    steepest: f64,
    /// ℓ = |d| + steepest.
    reach: f64,
    /// b: largest distance |side| / |a| of the rows and bounds.
    largest_side: f64,
    /// Smallest size of an active cut: one v serves them all, so an error of one is an error of each.
    pub(super) smallest_cut_size: f64,
}

impl<'a> WorkingSet<'a> {
    pub(super) fn new(qp: &'a EpigraphQp<'a>, coordinates: &'a Coordinates, cut_entry: CutEntry) -> Self {
        let (n, m, p) = (qp.dimension(), qp.slopes.len(), qp.rows.nrows());
        let mut rows = vec![0.0; n * p];
        for (k, column) in qp.rows.column_iter().enumerate() {
            column.iter().enumerate().for_each(|(i, a)| rows[i * n + k] = *a);
        }
        let weights: Vec<f64> = (0..n).map(|i| qp.metric.diagonal_entry(i).sqrt().recip()).collect();
        let scaled_norm = |normal: &[f64]| {
            let mut scaled = normal.to_vec();
            scaled.iter_mut().zip(&weights).for_each(|(a, w)| *a *= w);
            super::kernels::norm(&scaled)
        };
        let mut norms: Vec<f64> = qp.slopes.iter().map(|slope| scaled_norm(slope.as_slice())).collect();
        let steepest = norms.iter().copied().fold(0.0, f64::max);
        let cut_entry = cut_entry.of(&norms);
        if n > 0 {
            norms.extend(rows.chunks_exact(n).map(scaled_norm));
        } else {
            norms.resize(m + p, 0.0);
        }
        Self {
            qp,
            coordinates,
            largest_side: largest_side(qp, &norms[m..], &weights),
            rows,
            norms,
            cut_entry,
            factor: Factor::new(n + 1),
            general: Vec::new(),
            fixed: vec![None; n],
            held: vec![false; m + p + n],
            step: Vector::zeros(n),
            epigraph: 0.0,
            pivots: 0,
            steepest,
            reach: steepest,
            smallest_cut_size: f64::INFINITY,
        }
    }

    fn index(&self, member: Member) -> usize {
        let cuts = self.qp.slopes.len();
        match member {
            Member::Cut(j) => j,
            Member::Row(i) => cuts + i,
            Member::Bound(k) => cuts + self.qp.rows.nrows() + k,
        }
    }

    pub(super) fn is_held(&self, member: Member) -> bool {
        self.held[self.index(member)]
    }

    /// Gradient of a cut or of a row in the variables d; none for a bound.
    pub(super) fn gradient(&self, member: Member) -> Option<&[f64]> {
        let n = self.qp.dimension();
        match member {
            Member::Cut(j) => Some(self.qp.slopes[j].as_slice()),
            Member::Row(i) => Some(&self.rows[i * n..(i + 1) * n]),
            Member::Bound(_) => None,
        }
    }

    /// Lower and upper side of a member.
    pub(super) fn interval(&self, member: Member) -> (f64, f64) {
        match member {
            Member::Cut(j) => (f64::NEG_INFINITY, self.qp.offsets[j]),
            Member::Row(i) => (self.qp.row_lower[i], self.qp.row_upper[i]),
            Member::Bound(k) => (self.qp.lower[k], self.qp.upper[k]),
        }
    }

    /// normalᵀ d − s v.
    pub(super) fn value(&self, member: Member) -> f64 {
        match (member, self.gradient(member)) {
            (Member::Cut(_), Some(gradient)) => dot(gradient, self.step.as_slice()) - self.epigraph,
            (_, Some(gradient)) => dot(gradient, self.step.as_slice()),
            (Member::Bound(k), None) => self.step[k],
            (_, None) => 0.0,
        }
    }

    /// Size of the terms of `value − side`.
    pub(super) fn terms(&self, member: Member, side: f64) -> f64 {
        let terms = match member {
            Member::Bound(k) => self.step[k].abs(),
            _ => self.gradient(member).map_or(0.0, |gradient| dot_terms(gradient, self.step.as_slice())),
        };
        let epigraph = if matches!(member, Member::Cut(_)) { self.epigraph.abs() } else { 0.0 };
        terms + epigraph + side.abs()
    }

    /// Size of a side: its terms, plus a share of its normal for the case that they vanish.
    pub(super) fn size(&self, member: Member, side: f64) -> f64 {
        self.terms(member, side) + LENGTH_SHARE * self.reach * self.norm(member)
    }

    /// Size of a side that counts the rounding of all sides too, as in the certificate.
    pub(super) fn data_size(&self, member: Member, side: f64) -> f64 {
        let largest_side = if matches!(member, Member::Cut(_)) { 0.0 } else { self.largest_side };
        self.size(member, side) + SIDE_SHARE * largest_side * self.norm(member)
    }

    /// Norm of a normal in the metric's coordinates; for a dense metric in those of its diagonal.
    pub(super) fn norm(&self, member: Member) -> f64 {
        match member {
            Member::Bound(k) => self.qp.metric.diagonal_entry(k).sqrt().recip(),
            _ => self.norms[self.index(member)],
        }
    }

    /// Updates the sizes against which residuals are measured to the current step.
    pub(super) fn measure(&mut self) {
        let square = |(k, d): (usize, &f64)| d * d * self.qp.metric.diagonal_entry(k);
        self.reach = self.steepest + self.step.iter().enumerate().map(square).sum::<f64>().sqrt();
        let cuts = self.general.iter().filter(|active| matches!(active.member, Member::Cut(_)));
        let sizes = cuts.map(|active| self.size(active.member, self.held_value(active)));
        self.smallest_cut_size = sizes.fold(f64::INFINITY, f64::min);
    }

    /// The value an active member is held at.
    pub(super) fn held_value(&self, active: &Active) -> f64 {
        let (lower, upper) = self.interval(active.member);
        if active.side == Side::Lower { lower } else { upper }
    }

    /// The column of a member in the factors.
    pub(super) fn column(&self, member: Member) -> Vec<f64> {
        let mut column = match (member, self.gradient(member)) {
            (Member::Bound(k), _) => {
                let mut unit = vec![0.0; self.qp.dimension()];
                unit[k] = self.coordinates.axis_length(k).unwrap_or(1.0);
                self.coordinates.normal(&unit)
            }
            (_, Some(gradient)) => self.coordinates.normal(gradient),
            (_, None) => vec![0.0; self.qp.dimension()],
        };
        column.push(if matches!(member, Member::Cut(_)) { self.cut_entry } else { 0.0 });
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
        let index = self.index(active.member);
        self.held[index] = true;
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
            let index = self.index(active.member);
            self.held[index] = false;
        }
        self.pivots += 1;
    }

    pub(super) fn actives(&self) -> impl Iterator<Item = &Active> {
        self.general.iter().chain(self.fixed.iter().flatten())
    }

    /// Sum of the active cuts' multipliers.
    pub(super) fn cut_sum(&self) -> f64 {
        self.general.iter().filter(|active| matches!(active.member, Member::Cut(_))).map(|a| a.multiplier).sum()
    }
}

impl CutEntry {
    /// In the order in which they are tried.
    pub(super) const ALL: [Self; 3] = [Self::Median, Self::Lower, Self::Upper];

    /// Its value for cuts of these norms.
    fn of(self, norms: &[f64]) -> f64 {
        let mut positive: Vec<f64> = norms.iter().copied().filter(|norm| *norm > 0.0).collect();
        let Some(median) = upper_median(&mut positive) else { return 1.0 };
        match self {
            Self::Median => median,
            Self::Lower => median.sqrt() * positive.into_iter().fold(median, f64::min).sqrt(),
            Self::Upper => median.sqrt() * positive.into_iter().fold(median, f64::max).sqrt(),
        }
    }
}
