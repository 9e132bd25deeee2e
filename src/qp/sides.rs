//! The cuts, rows and bounds of a QP, in one numbering: their normals, and the intervals in which they hold values.

use super::certificate::largest_side;
use super::kernels::{add_scaled, dot, norm};
use super::problem::EpigraphQp;
use crate::linalg::upper_median;

/// One inequality or equality of the QP.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Member {
    Cut(usize),
    Row(usize),
    Bound(usize),
}

impl Member {
    pub(super) fn is_cut(self) -> bool {
        matches!(self, Self::Cut(_))
    }
}

/// The normal of a member in the variables d.
pub(super) enum Normal<'a> {
    /// The gradient of a cut or of a row.
    Gradient(&'a [f64]),
    /// The unit vector of a bound.
    Axis(usize),
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

/// The data of a QP with the sizes that follow from them.
pub(super) struct Sides<'a> {
    pub(super) qp: &'a EpigraphQp<'a>,
    /// Rows of A, one after the other.
    rows: Vec<f64>,
    /// Norms of the normals, cuts then rows.
    norms: Vec<f64>,
    /// The extra entry c of a cut's column.
    pub(super) cut_entry: f64,
    /// Norm of the steepest cut: the length of the unconstrained step.
    pub(super) steepest: f64,
    /// b: largest distance |side| / |a| of the rows and bounds.
    pub(super) largest: f64,
}

impl<'a> Sides<'a> {
    pub(super) fn new(qp: &'a EpigraphQp<'a>, cut_entry: CutEntry) -> Self {
        let (n, m, p) = (qp.dimension(), qp.slopes.len(), qp.rows.nrows());
        let mut rows = vec![0.0; n * p];
        for (k, column) in qp.rows.column_iter().enumerate() {
            column.iter().enumerate().for_each(|(i, a)| rows[i * n + k] = *a);
        }
        let weights: Vec<f64> = (0..n).map(|i| qp.metric.diagonal_entry(i).sqrt().recip()).collect();
        let scaled_norm = |normal: &[f64]| {
            let mut scaled = normal.to_vec();
            scaled.iter_mut().zip(&weights).for_each(|(a, w)| *a *= w);
            norm(&scaled)
        };
        let mut norms: Vec<f64> = qp.slopes.iter().map(|slope| scaled_norm(slope.as_slice())).collect();
        let steepest = norms.iter().copied().fold(0.0, f64::max);
        let cut_entry = cut_entry.of(&norms);
        norms.extend((0..p).map(|i| scaled_norm(&rows[i * n..(i + 1) * n])));
        let largest = largest_side(qp, &norms[m..], &weights);
        Self { qp, rows, norms, cut_entry, steepest, largest }
    }

    /// Number of cuts, rows and bounds.
    pub(super) fn count(&self) -> usize {
        self.norms.len() + self.qp.dimension()
    }

    pub(super) fn index(&self, member: Member) -> usize {
        match member {
            Member::Cut(j) => j,
            Member::Row(i) => self.qp.slopes.len() + i,
            Member::Bound(k) => self.norms.len() + k,
        }
    }

    pub(super) fn normal(&self, member: Member) -> Normal<'_> {
        let n = self.qp.dimension();
        match member {
            Member::Cut(j) => Normal::Gradient(self.qp.slopes[j].as_slice()),
            Member::Row(i) => Normal::Gradient(&self.rows[i * n..(i + 1) * n]),
            Member::Bound(k) => Normal::Axis(k),
        }
    }

    /// normalᵀ d.
    pub(super) fn product(&self, member: Member, step: &[f64]) -> f64 {
        match self.normal(member) {
            Normal::Gradient(gradient) => dot(gradient, step),
            Normal::Axis(k) => step[k],
        }
    }

    /// Adds a multiple of a normal.
    pub(super) fn add_normal(&self, sum: &mut [f64], factor: f64, member: Member) {
        match self.normal(member) {
            Normal::Gradient(gradient) => add_scaled(sum, factor, gradient),
            Normal::Axis(k) => sum[k] += factor,
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

    /// Norm of a normal in the metric's coordinates; for a dense metric in those of its diagonal.
    pub(super) fn norm(&self, member: Member) -> f64 {
        match member {
            Member::Bound(k) => self.qp.metric.diagonal_entry(k).sqrt().recip(),
            _ => self.norms[self.index(member)],
        }
    }
}

impl CutEntry {
    /// In the order in which they are tried.
    pub(super) const ALL: [Self; 3] = [Self::Median, Self::Lower, Self::Upper];

    /// The entry c for cuts of these norms.
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
