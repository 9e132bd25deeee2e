//! The largest force that friction can build up: a proof that bodies held by friction alone have no equilibrium.
//!
//! ```text
//! λ in the friction cones,   Rᵀ λ = e,   λ_Nᵀ w_N = 0   ⇒   q(λ) := λ_Nᵀ (C λ)_N − d_Nᵀ λ_N = 0
//! T ≥ 0 entry by entry       ⇒   λᵀ M λ ≤ d_Nᵀ λ_N,   λᵀ M λ := λ_Nᵀ (C λ)_N + Σ T_ij (λ_T,i·λ_T,j − 𝓕_i 𝓕_j λ_N,i λ_N,j)
//! 2 M v − d_N − R y in the dual cones   ⇒   eᵀ y ≤ vᵀ M v
//! ```
//! The implications hold at every equilibrium, provided that no free motion moves contact nodes along their normals
//! and, for the last one, that M is positive definite: 2vᵀMλ − vᵀMv ≤ λᵀMλ ≤ d_Nᵀλ_N. A motion y with eᵀ y > vᵀ M v is
//! therefore a proof that there is no equilibrium, whatever the solvers tried: the load drives y by more than contact
//! can build up. y and v are multipliers and minimiser of λᵀMλ − d_Nᵀλ_N over the cones with Rᵀλ = e; what they prove
//! is computed again from C, R, d and e.

use crate::direct::compliant_contact::CompliantContact;
use crate::equilibrium::{ContactPoint, NodeRows};
use crate::error::ContactError;
use crate::linear::dense::{DenseCholesky, multiply};
use crate::linear::vector::{add_scaled, dot};
use crate::qp::{Cone, ConeProgram, MAX_ITERATIONS};
use faer::Mat;

/// Normal part of an orthonormal motion that is rounding.
const TANGENTIAL: f64 = 1e-12;
/// Share of the largest row sum of M by which M must be definite: condensation may lose as much.
const DEFINITE: f64 = 1e-8;
/// Shares 𝓕_i 𝓕_j T_ij/C_NN⁺ that are tried until M is positive definite.
const SHARES: [f64; 5] = [0.5, 0.3, 0.7, 0.15, 0.85];
/// Largest share of the resultant that friction may build up in a proof.
const MAX_SHARE: f64 = 0.999;
/// Rounding of the products that a proof consists of, relative to their terms.
const ROUNDING: f64 = 1e-11;
/// Least work on a motion, in units of the load: below it the resultant may be rounding of loads in equilibrium.
const LEAST_WORK: f64 = 1e-6;
/// Largest difference of C_ij and C_ji, relative to the largest entry: more: condensation has lost half the digits.
const LARGEST_SKEW: f64 = 1e-6;
/// Most rows of a program: beyond, it would cost far more than the solvers that failed.
pub(super) const MAX_ROWS: usize = 900;
/// Programs for one bound, each for the share of the load that the last one allows.
const MAX_PROGRAMS: usize = 2;
/// Relative decrease of the share that ends them.
const SMALLEST_DECREASE: f64 = 0.01;

/// A motion that the load drives, and what friction can hold against it.
#[derive(Debug, Clone, PartialEq)]
pub struct Resistance {
    /// Amplitudes y of the rigid motions, with slip of length 1 in the root mean square.
    pub motion: Vec<f64>,
    /// The resultant eᵀy, N.
    pub resultant: f64,
    /// The largest eᵀy that contact forces can balance, N: an upper bound.
    pub largest: f64,
}

/// What the bound is made of.
struct Bound<'a> {
    contact: &'a CompliantContact,
    /// The Hessian 2 M.
    hessian: Mat<f64>,
    /// Its Cholesky factor, less a shift.
    factor: DenseCholesky,
    /// Largest row sum of |2 M|.
    norm: f64,
    /// d over the normal rows, 0 over the tangential ones.
    constant: Vec<f64>,
}

/// The motion by which the load exceeds most what friction can build up, with the largest resistance to it. None
/// without friction or free motions, where free motions open the contact, for large problems, and without a bound.
///
/// There is an equilibrium only if `resultant ≤ largest`.
pub fn resistance(contact: &CompliantContact) -> Option<Resistance> {
    let bound = Bound::new(contact)?;
    let mut best: Option<Resistance> = None;
    let mut share = 1.0;
    for _program in 0..MAX_PROGRAMS {
        let Some(found) = bound.at(share) else { break };
        let new = found.largest / found.resultant;
        let converged = new >= (1.0 - SMALLEST_DECREASE) * share;
        if best.as_ref().is_none_or(|best| new < best.largest / best.resultant) {
            best = Some(found);
        }
        if converged || new <= 0.0 {
            break;
        }
        share = new;
    }
    best
}

/// The refusal that the bound proves, if it does.
pub(super) fn refusal(contact: &CompliantContact) -> Option<ContactError> {
    // The bound counts friction cones alone, no glued nodes.
    if contact.problem.boundary.has_ties() {
        return None;
    }
    let found = resistance(contact).filter(|found| found.largest <= MAX_SHARE * found.resultant)?;
    let Resistance { resultant, largest, .. } = found;
    Some(ContactError::FrictionTooWeak { direction: in_words(contact, &found.motion), resultant, largest })
}

/// The slip of every node in a motion.
fn slips(contact: &CompliantContact, motion: &[f64]) -> Vec<[f64; 3]> {
    let jumps = multiply(&contact.motions, motion);
    let slip = |(point, node): (&ContactPoint, &NodeRows)| {
        let parts = || node.directions[1..].iter().zip(&jumps[point.start + 1..]);
        std::array::from_fn(|axis| parts().map(|(tangent, jump)| tangent[axis] * jump).sum())
    };
    contact.problem.boundary.points.iter().zip(&contact.rows.nodes).map(slip).collect()
}

/// The parts of a motion that make up most of its slip.
fn in_words(contact: &CompliantContact, motion: &[f64]) -> String {
    let slips = slips(contact, motion);
    let count = slips.len() as f64;
    let mean: [f64; 3] = std::array::from_fn(|axis| slips.iter().map(|slip| slip[axis]).sum::<f64>() / count);
    let turning: f64 = slips.iter().map(|slip| square(std::array::from_fn(|axis| slip[axis] - mean[axis]))).sum();
    let [x1, x2, x3] = mean.map(|part| part + 0.0);
    let sliding = format!("sliding along ({x1:.2}, {x2:.2}, {x3:.2})");
    let turning = (turning / count).sqrt() > 0.3;
    match (square(mean).sqrt() > 0.3, turning) {
        (true, true) => format!("{sliding} with turning on the contact surface"),
        (true, false) => sliding,
        _ => "turning on the contact surface".into(),
    }
}

impl<'a> Bound<'a> {
    fn new(contact: &'a CompliantContact) -> Option<Self> {
        let (boundary, motions) = (&contact.problem.boundary, contact.resultant.len());
        let points = &boundary.points;
        let tangential = |k: usize| points.iter().all(|point| contact.motions[(point.start, k)].abs() <= TANGENTIAL);
        let slides = boundary.has_friction() && motions > 0 && (0..motions).all(tangential);
        if !slides || boundary.row_count > MAX_ROWS || !is_accurate(&contact.compliance) {
            return None;
        }
        let mut constant = vec![0.0; boundary.row_count];
        points.iter().for_each(|point| constant[point.start] = contact.constant()[point.start]);
        SHARES.into_iter().find_map(|share| {
            let hessian = hessian(contact, share);
            let sums = (0..hessian.ncols()).map(|j| hessian.col_as_slice(j).iter().map(|entry| entry.abs()).sum());
            let norm = sums.fold(0.0, f64::max);
            let mut shifted = hessian.clone();
            (0..shifted.nrows()).for_each(|i| shifted[(i, i)] -= DEFINITE * norm);
            let factor = DenseCholesky::new(shifted).ok()?;
            Some(Self { contact, hessian, factor, norm, constant: constant.clone() })
        })
    }

    /// What is proved by the multipliers for a share of the load; none where they do not come close enough.
    fn at(&self, share: f64) -> Option<Resistance> {
        let boundary = &self.contact.problem.boundary;
        let cones = boundary.points.iter();
        let cones = cones.map(|point| Cone { first: point.start, size: point.row_count(), slope: point.friction });
        let program = ConeProgram {
            hessian: &self.hessian,
            linear: self.constant.iter().map(|d| -d).collect(),
            equalities: &self.contact.motions,
            right_side: self.contact.resultant.iter().map(|e| share * e).collect(),
            cones: cones.collect(),
        };
        let minimiser = program.minimise(MAX_ITERATIONS).filter(|minimiser| minimiser.solved)?;
        self.proof(&minimiser.multipliers, minimiser.entries)
    }

    /// The bound that a motion y and forces v prove, in double precision.
    fn proof(&self, motion: &[f64], mut v: Vec<f64>) -> Option<Resistance> {
        let (contact, boundary) = (self.contact, &self.contact.problem.boundary);
        let driven = multiply(&contact.motions, motion);
        // How far 2 M v − d − R y is outside the dual cones.
        let missing = |v: &[f64]| {
            let product = multiply(&self.hessian, v);
            let rest = |row: usize| product[row] - self.constant[row] - driven[row];
            let outside = |point: &ContactPoint| {
                let tangential = point.rows().skip(1).map(rest).fold(0.0, f64::hypot);
                let outside = point.friction * tangential - rest(point.start);
                if outside.is_nan() { f64::INFINITY } else { outside }
            };
            boundary.points.iter().map(outside).fold(f64::NEG_INFINITY, f64::max)
        };
        let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let sizes = |v: &[f64]| self.norm * largest(v) + largest(&self.constant) + largest(&driven);
        // 2 M h = 1 over the normal rows, but for the shift: what is missing is made up along h.
        let mut h = vec![0.0; v.len()];
        boundary.points.iter().for_each(|point| h[point.start] = 1.0);
        self.factor.solve_lower_in_place(&mut h);
        self.factor.solve_upper_in_place(&mut h);
        let length = 2.0 * (missing(&v).max(0.0) + ROUNDING * sizes(&v));
        add_scaled(&mut v, length, &h);
        let squares: f64 = slips(contact, motion).into_iter().map(square).sum();
        let slip = (squares / boundary.points.len() as f64).sqrt();
        let work = dot(&contact.resultant, motion);
        let pushed = work > LEAST_WORK * largest(motion);
        let proved = missing(&v) <= -ROUNDING * sizes(&v) && pushed && slip > 0.0;
        proved.then(|| Resistance {
            motion: motion.iter().map(|y| y / slip).collect(),
            resultant: work * contact.load / slip,
            largest: 0.5 * dot(&v, &multiply(&self.hessian, &v)) * contact.load / slip,
        })
    }
}

/// The square of the length of a vector.
fn square(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum()
}

/// Whether a compliance is symmetric, which its factorisation does not enforce, far beyond the margin of the proof.
fn is_accurate(compliance: &Mat<f64>) -> bool {
    let pairs = || (0..compliance.nrows()).flat_map(|i| (0..=i).map(move |j| (i, j)));
    let largest = pairs().map(|(i, j)| compliance[(i, j)].abs()).fold(0.0, f64::max);
    pairs().all(|(i, j)| (compliance[(i, j)] - compliance[(j, i)]).abs() <= LARGEST_SKEW * largest)
}

/// 2 M with T_ij = share·C_NN⁺/(𝓕_i 𝓕_j), C_NN⁺ the positive entries of C_NN.
fn hessian(contact: &CompliantContact, share: f64) -> Mat<f64> {
    let (boundary, compliance) = (&contact.problem.boundary, &contact.compliance);
    let mut hessian = Mat::<f64>::zeros(boundary.row_count, boundary.row_count);
    // Where 𝓕 is 0, λ_T is 0, and any other coefficient bounds it as well.
    let largest = boundary.points.iter().map(|point| point.friction).fold(0.0, f64::max);
    let friction = |point: &ContactPoint| if point.friction > 0.0 { point.friction } else { largest };
    let nodes = || boundary.points.iter().zip(&contact.rows.nodes);
    for (first, of_first) in nodes() {
        for (second, of_second) in nodes() {
            let (i, j) = (first.start, second.start);
            let normal = 0.5 * (compliance[(i, j)] + compliance[(j, i)]);
            let weight = share * normal.max(0.0);
            hessian[(i, j)] = 2.0 * (normal - weight);
            let weight = 2.0 * weight / (friction(first) * friction(second));
            for (a, tangent) in of_first.directions[1..].iter().enumerate() {
                hessian[(i + 1 + a, j)] = compliance[(j, i + 1 + a)];
                hessian[(j, i + 1 + a)] = compliance[(j, i + 1 + a)];
                for (b, other) in of_second.directions[1..].iter().enumerate() {
                    let cosine: f64 = (0..3).map(|axis| tangent[axis] * other[axis]).sum();
                    hessian[(i + 1 + a, j + 1 + b)] = weight * cosine;
                }
            }
        }
    }
    hessian
}
