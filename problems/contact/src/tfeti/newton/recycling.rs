//! Recycling of dual directions: the least residual over everything a solve has seen, at no product with F.
//!
//! ```text
//! direction k:  v_k with G v_k = 0, its product F v_k, a change b_k of the rigid amplitudes,   dw_k = −F v_k + Gᵀ b_k
//! λ + Σ y_k v_k,  a + Σ y_k b_k   change the residual linearly:
//! c w_E by c Σ y_k (dw_k)_E,      λ − Π(x) by dλ − D (dλ + c dw)   on the contact rows
//! ```
//! y minimises the linearised residual, c w_E with full weight at first (normal equations; products of rows of B_E are
//! kept from step to step). The combination is taken if that residual falls, and repeated, with new derivatives D,
//! while it falls well: a change of status or of a slip direction invalidates nothing, because F v_k does not depend on
//! it.

use crate::equilibrium::certificate::projection_residual;
use crate::linear::dense::DenseCholesky;
use crate::linear::sums::Sums;
use crate::linear::vector::{add_scaled, dot, norm};
use crate::tfeti::dual::{Iterate, TornContact};
use crate::tfeti::torn::RowVector;
use faer::Mat;

/// Share of the residual that a round may leave for another one to be worth its dense algebra.
const MAX_SHARE_LEFT: f64 = 0.5;
/// Rounds of one combination.
const MAX_ROUNDS: usize = 4;
/// Weight of the jumps of B_E in the merit, against Coulomb's law, once the residual has stagnated with both alike.
/// These jumps fall with every direction, so that at full weight they may keep statuses from settling.
const SMALL_GLUE_SHARE: f64 = 0.5;
/// Smallest and largest relative ridge of the normal equations: combinations below it carry no digits.
const RIDGES: [f64; 2] = [1e-14, 1e-6];

/// A direction that iterates may move along.
#[derive(Debug)]
pub struct Direction {
    /// A change b of the rigid amplitudes.
    pub amplitudes: Vec<f64>,
    /// Multipliers v with G v = 0, and F v; none where the rigid amplitudes change alone.
    pub forces: Option<(RowVector, RowVector)>,
}

/// All directions of a solve.
#[derive(Debug)]
pub struct Recycled {
    /// Weight of the jumps of B_E in the merit.
    glue_share: f64,
    directions: Vec<Direction>,
    /// dw over all rows, per direction.
    jumps: Vec<RowVector>,
    /// (dw_k)_E · (dw_l)_E for l ≤ k.
    products: Vec<Vec<f64>>,
}

impl Default for Recycled {
    fn default() -> Self {
        Self { glue_share: 1.0, directions: vec![], jumps: vec![], products: vec![] }
    }
}

impl Recycled {
    /// Lets jumps of B_E weigh less than Coulomb's law from now on; whether they did not before.
    pub fn weigh_jumps_less(&mut self) -> bool {
        std::mem::replace(&mut self.glue_share, SMALL_GLUE_SHARE) > SMALL_GLUE_SHARE
    }

    pub fn len(&self) -> usize {
        self.directions.len()
    }

    /// Adds a direction, with the jumps Gᵀ b of its amplitudes.
    pub fn push(&mut self, contact: &TornContact<'_>, direction: Direction, mut jumps: RowVector) {
        if let Some((_, image)) = &direction.forces {
            add_scaled(&mut jumps, -1.0, image);
        }
        self.directions.push(direction);
        self.jumps.push(jumps);
        let last = self.jumps[self.jumps.len() - 1].split().0;
        self.products.push(self.equality_products(contact, last));
    }

    /// (dw_k)_E · v of every direction.
    fn equality_products(&self, contact: &TornContact<'_>, v: &[f64]) -> Vec<f64> {
        let sums: &dyn Sums = &contact.operator.model.sums();
        sums.dots(&self.jumps.iter().map(|jumps| jumps.split().0).collect::<Vec<_>>(), v)
    }

    /// Combines the directions, again while a round at least halves the residual; returns the residual.
    pub fn combine(&self, contact: &TornContact<'_>, iterate: &mut Iterate, residual: f64) -> f64 {
        let mut position = Position::of(self, contact, iterate);
        let start = position.residual(self, contact);
        let mut best = start;
        for _round in 0..MAX_ROUNDS {
            let Some(weights) = self.least_squares(contact, &position) else { break };
            let trial = position.moved(self, &weights);
            let value = trial.residual(self, contact);
            if value.is_nan() || value >= best {
                break;
            }
            let worthwhile = value < MAX_SHARE_LEFT * best;
            position = trial;
            best = value;
            if !worthwhile {
                break;
            }
        }
        if best >= start {
            return residual;
        }
        self.apply(&position.weights, iterate);
        contact.residual(iterate)
    }

    /// Adds the weighted directions to an iterate.
    fn apply(&self, weights: &[f64], iterate: &mut Iterate) {
        for ((&weight, direction), jumps) in weights.iter().zip(&self.directions).zip(&self.jumps) {
            if let Some((multipliers, image)) = &direction.forces {
                add_scaled(&mut iterate.multipliers, weight, multipliers);
                add_scaled(&mut iterate.image, weight, image);
            }
            add_scaled(&mut iterate.amplitudes, weight, &direction.amplitudes);
            add_scaled(&mut iterate.jumps, weight, jumps);
        }
    }

    /// Changes of the weights that minimise the residual linearised at a position.
    fn least_squares(&self, contact: &TornContact<'_>, position: &Position) -> Option<Vec<f64>> {
        let count = self.directions.len();
        if count == 0 {
            return None;
        }
        let square = (self.glue_share * contact.stiffness).powi(2);
        let mut normal = Mat::from_fn(count, count, |k, l| square * self.product(k, l));
        let slopes = position.equality_slopes(self);
        let mut right: Vec<f64> = slopes.iter().map(|slope| -square * slope).collect();
        let changes = self.contact_changes(contact, position);
        let law = projection_residual(contact.boundary, &position.forces, &position.jumps, contact.stiffness);
        for (k, left) in changes.iter().enumerate() {
            right[k] -= dot(left, &law);
            for (l, other) in changes.iter().enumerate().take(k + 1) {
                let product = normal[(k, l)] + dot(left, other);
                normal[(k, l)] = product;
                normal[(l, k)] = product;
            }
        }
        solve_scaled(&normal, &right)
    }

    /// The inner product (dw_k)_E · (dw_l)_E.
    fn product(&self, k: usize, l: usize) -> f64 {
        self.products[k.max(l)][k.min(l)]
    }

    /// Change of λ − Π(x) over the packed contact rows, per direction.
    fn contact_changes(&self, contact: &TornContact<'_>, position: &Position) -> Vec<Vec<f64>> {
        let boundary = contact.boundary;
        let blocks: Vec<[[f64; 3]; 3]> = boundary
            .points
            .iter()
            .map(|point| {
                let rows = point.rows();
                let x: Vec<f64> =
                    rows.map(|row| position.forces[row] + contact.stiffness * position.jumps[row]).collect();
                point.linearization(&x).derivative(x.len(), point.friction)
            })
            .collect();
        let change = |(direction, jumps): (&Direction, &RowVector)| {
            let forces = direction.forces.as_ref().map(|(multipliers, _)| multipliers.contact());
            let force = |row: usize| forces.map_or(0.0, |forces| forces[row]);
            let jumps = jumps.contact();
            let mut change = vec![0.0; boundary.row_count];
            for (point, block) in boundary.points.iter().zip(&blocks) {
                let count = point.row_count();
                for i in 0..count {
                    let mut sum = force(point.start + i);
                    for (j, entry) in block[i].iter().enumerate().take(count) {
                        let row = point.start + j;
                        sum -= entry * (force(row) + contact.stiffness * jumps[row]);
                    }
                    change[point.start + i] = sum;
                }
            }
            change
        };
        self.directions.iter().zip(&self.jumps).map(change).collect()
    }
}

/// An iterate moved by weighted directions, known by what its residual needs: contact rows, products of equality rows.
#[derive(Clone)]
struct Position {
    weights: Vec<f64>,
    forces: Vec<f64>,
    jumps: Vec<f64>,
    /// |w_E|² of the iterate it started from.
    start_square: f64,
    /// (dw_k)_E · w_E of the iterate it started from.
    start_slopes: Vec<f64>,
}

impl Position {
    fn of(recycled: &Recycled, contact: &TornContact<'_>, iterate: &Iterate) -> Self {
        let (glued, jumps) = iterate.jumps.split();
        Self {
            weights: vec![0.0; recycled.len()],
            forces: iterate.multipliers.contact().to_vec(),
            jumps: jumps.to_vec(),
            start_square: contact.norm(glued).powi(2),
            start_slopes: recycled.equality_products(contact, glued),
        }
    }

    fn moved(&self, recycled: &Recycled, change: &[f64]) -> Self {
        let mut to = self.clone();
        for (k, &change) in change.iter().enumerate() {
            to.weights[k] += change;
            if let Some((multipliers, _)) = &recycled.directions[k].forces {
                add_scaled(&mut to.forces, change, multipliers.contact());
            }
            add_scaled(&mut to.jumps, change, recycled.jumps[k].contact());
        }
        to
    }

    /// (dw_k)_E · w_E here.
    fn equality_slopes(&self, recycled: &Recycled) -> Vec<f64> {
        let moved =
            |k: usize| -> f64 { self.weights.iter().enumerate().map(|(l, y)| y * recycled.product(k, l)).sum() };
        self.start_slopes.iter().enumerate().map(|(k, start)| start + moved(k)).collect()
    }

    /// The relative residual here.
    fn residual(&self, recycled: &Recycled, contact: &TornContact<'_>) -> f64 {
        let slopes = self.equality_slopes(recycled);
        let pairs = self.weights.iter().zip(self.start_slopes.iter().zip(&slopes));
        let square = self.start_square + pairs.map(|(y, (start, here))| y * (start + here)).sum::<f64>();
        let law = projection_residual(contact.boundary, &self.forces, &self.jumps, contact.stiffness);
        (recycled.glue_share * contact.stiffness * square.max(0.0).sqrt()).hypot(norm(&law)) / contact.load
    }
}

/// Solves normal equations scaled to a unit diagonal, with a small ridge.
fn solve_scaled(normal: &Mat<f64>, right: &[f64]) -> Option<Vec<f64>> {
    let count = right.len();
    let scale: Vec<f64> =
        (0..count).map(|k| if normal[(k, k)] > 0.0 { 1.0 / normal[(k, k)].sqrt() } else { 0.0 }).collect();
    let [mut ridge, largest] = RIDGES;
    // Nearly dependent directions are normal late in a solve: a larger ridge leaves them out.
    while ridge < largest {
        let matrix = Mat::from_fn(count, count, |k, l| {
            scale[k] * scale[l] * normal[(k, l)] + if k == l { ridge.max(f64::from(scale[k] == 0.0)) } else { 0.0 }
        });
        if let Ok(factor) = DenseCholesky::new(matrix) {
            let mut solution: Vec<f64> = (0..count).map(|k| scale[k] * right[k]).collect();
            factor.solve_lower_in_place(&mut solution);
            factor.solve_upper_in_place(&mut solution);
            return Some((0..count).map(|k| scale[k] * solution[k]).collect());
        }
        ridge *= 10.0;
    }
    None
}
