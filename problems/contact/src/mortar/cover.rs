//! What covers one slave facet: the master facets that meet it, nearest layer first, and its dual basis.
//!
//! ```text
//! ψ_i = Σ_k A_ik N_k,   A = diag(D) M⁻¹,   W_ij = ∫ ψ_i Nᵐ_j = Σ_f Σ_k A_ik P_kj
//! ```

use super::Along;
use super::facet::Patch;
use super::frame::{Frame, circle};
use super::opposite_facets::OppositeFacets;
use super::pair::{COLUMNS, Raw, Wide, row_sums, visit};
use super::planar::Planar;
use super::polygon::Polygon;
use nalgebra::Matrix4;

/// Facets covered less than this are not covered.
const UNCOVERED: f64 = 1e-9;

/// Parts that overlap nearer ones by more than this part of the slave facet belong to another layer.
const OVERLAP: f64 = 1e-9;

/// Least pivot of the Cholesky factorisation of M scaled to a unit diagonal.
const PIVOT: f64 = 1e-10;

/// Square matrices over the corners of a facet.
pub type Square = [[f64; 4]; 4];

/// A master facet on a slave facet.
#[derive(Debug, Clone)]
pub struct Pair {
    pub master: usize,
    /// P, gap and normal.
    pub mixed: Wide<f64>,
    /// W, and the same sums of gap and normal.
    pub weights: Wide<f64>,
    /// Places of W in the list of all weights.
    pub slots: [[usize; 4]; 4],
}

/// The dual basis of a slave facet.
#[derive(Debug, Clone)]
pub struct Basis {
    /// D.
    pub sums: [f64; 4],
    /// M⁻¹; rows and columns of a missing corner are those of the unit matrix.
    pub inverse: Square,
    /// A.
    pub dual: Square,
}

/// A slave facet with its plane and what covers it.
#[derive(Debug, Clone)]
pub struct Cover {
    pub frame: Frame,
    /// ∫ N_i over the whole projected facet.
    pub whole: [f64; 4],
    /// None where nothing covers the facet; then there are no pairs.
    pub basis: Option<Basis>,
    pub pairs: Vec<Pair>,
}

/// A master facet that may cover.
struct Candidate {
    master: usize,
    distance: f64,
    area: f64,
    parts: Vec<Polygon<f64>>,
}

/// Project a facet of a surface onto a plane.
pub fn projected(frame: &Frame, patch: &Patch, facet: usize) -> Planar<f64> {
    Planar { corners: patch.corners(facet).map(|corner| frame.project(corner)), count: patch.count(facet) }
}

impl Cover {
    /// Find what covers a slave facet; `None` if it has no area in its plane.
    pub fn new(
        facet: usize,
        slave: &Patch,
        (master, opposite): (&Patch, &OppositeFacets),
        along: Along,
    ) -> Option<Self> {
        let corners = slave.corners(facet);
        let corners = &corners[..slave.count(facet)];
        let frame = Frame::new(corners, along)?;
        let planar = projected(&frame, slave, facet);
        let whole = planar.tributary();
        let area: f64 = whole.iter().sum();
        let radius = circle(corners).1;
        let near = opposite.facing(&frame, radius).into_iter();
        let candidates = near.filter_map(|other| {
            let heights = [slave.corners(facet), master.corners(other)].map(|x| x.map(|y| frame.height(y)));
            Candidate::new(other, &planar, &projected(&frame, master, other), heights)
        });
        let accepted = nearest(candidates.collect(), area);
        let own = slave.curve(facet);
        let integrals = accepted.iter().map(|&other| {
            let curve = master.curve(other);
            let curves = own.as_ref().zip(curve.as_ref()).map(|(own, other)| [own, other]);
            (other, Raw::new(&planar, &projected(&frame, master, other), curves))
        });
        let mut cover = Self { frame, whole, basis: None, pairs: Vec::new() };
        cover.fill(integrals.collect(), area, slave.count(facet));
        Some(cover)
    }

    fn fill(&mut self, integrals: Vec<(usize, Raw<f64>)>, area: f64, count: usize) {
        let mut matrix = [[0.0; 4]; 4];
        for (_, raw) in &integrals {
            add(&mut matrix, &raw.matrix());
        }
        let sums = row_sums(&matrix);
        let covered: f64 = sums.iter().sum();
        if covered.is_nan() || covered <= UNCOVERED * area {
            return;
        }
        self.basis = Basis::new(sums, matrix, count);
        let Some(basis) = &self.basis else { return };
        let pair = |(master, raw): (usize, Raw<f64>)| Pair {
            master,
            mixed: raw.mixed,
            weights: product(&basis.dual, &raw.mixed),
            slots: [[0; 4]; 4],
        };
        self.pairs = integrals.into_iter().map(pair).collect();
        self.round_off(&sums);
    }

    /// Σ_j W_ij = D_i holds to the rounding of M⁻¹; spread the rest in proportion to P.
    fn round_off(&mut self, sums: &[f64; 4]) {
        for (row, &sum) in sums.iter().enumerate() {
            let total = |pick: fn(&Pair) -> &Wide<f64>| {
                self.pairs.iter().map(|pair| pick(pair)[row][..4].iter().sum::<f64>()).sum::<f64>()
            };
            let (rest, whole) = (sum - total(|pair| &pair.weights), total(|pair| &pair.mixed));
            if whole > 0.0 {
                for pair in &mut self.pairs {
                    (0..4).for_each(|j| pair.weights[row][j] += rest * (pair.mixed[row][j] / whole));
                }
            }
        }
    }
}

impl Candidate {
    fn new(master: usize, own: &Planar<f64>, other: &Planar<f64>, [low, high]: [[f64; 4]; 2]) -> Option<Self> {
        let mut candidate = Self { master, distance: 0.0, area: 0.0, parts: Vec::new() };
        visit(own, other, |common, own, other| {
            let (centre, area) = (common.centroid(), common.area());
            let height =
                |shape: [f64; 4], heights: [f64; 4]| shape.iter().zip(heights).map(|(n, h)| n * h).sum::<f64>();
            let distance = height(other.shape(centre), high) - height(own.shape(centre), low);
            candidate.distance += area * distance;
            candidate.area += area;
            candidate.parts.push(*common);
        });
        candidate.distance = (candidate.distance / candidate.area).abs();
        (!candidate.parts.is_empty()).then_some(candidate)
    }

    fn overlaps(&self, other: &Self, area: f64) -> bool {
        let pairs = self.parts.iter().flat_map(|a| other.parts.iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| a.overlap(b, 0.0)).sum::<f64>() > OVERLAP * area
    }
}

/// The master facets that no nearer one overlaps, ascending.
fn nearest(mut candidates: Vec<Candidate>, area: f64) -> Vec<usize> {
    candidates.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.master.cmp(&b.master)));
    let mut accepted: Vec<Candidate> = Vec::with_capacity(candidates.len());
    for candidate in candidates {
        if !accepted.iter().any(|other| candidate.overlaps(other, area)) {
            accepted.push(candidate);
        }
    }
    let mut masters: Vec<usize> = accepted.iter().map(|candidate| candidate.master).collect();
    masters.sort_unstable();
    masters
}

impl Basis {
    /// Invert M; `None` where it is singular.
    fn new(sums: [f64; 4], mut matrix: Square, count: usize) -> Option<Self> {
        (count..4).for_each(|missing| matrix[missing][missing] = 1.0);
        let diagonal: [f64; 4] = std::array::from_fn(|k| matrix[k][k]);
        if diagonal.iter().any(|&entry| entry.is_nan() || entry <= 0.0) {
            return None;
        }
        let scales = diagonal.map(|entry| 1.0 / entry.sqrt());
        let scaled = Matrix4::from_fn(|k, l| scales[k] * matrix[k][l] * scales[l]);
        let factors = scaled.cholesky()?;
        if factors.l_dirty().diagonal().iter().any(|&entry| entry.is_nan() || entry * entry <= PIVOT) {
            return None;
        }
        let raw = factors.inverse();
        let inverse: Square = std::array::from_fn(|k| std::array::from_fn(|l| scales[k] * raw[(k, l)] * scales[l]));
        let dual = std::array::from_fn(|k| inverse[k].map(|entry| sums[k] * entry));
        Some(Self { sums, inverse, dual })
    }
}

/// Add a matrix.
pub fn add<const C: usize>(sum: &mut [[f64; C]; 4], other: &[[f64; C]; 4]) {
    sum.iter_mut().flatten().zip(other.iter().flatten()).for_each(|(entry, &part)| *entry += part);
}

/// A B.
pub fn product<const C: usize>(a: &Square, b: &[[f64; C]; 4]) -> [[f64; C]; 4] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

/// A Bᵀ.
pub fn outer(a: &Wide<f64>, b: &Wide<f64>) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..COLUMNS).map(|k| a[i][k] * b[j][k]).sum()))
}

/// Aᵀ.
pub fn transposed(a: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}
