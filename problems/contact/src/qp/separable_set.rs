//! Ω: free entries, half-lines, discs; projection and reduced gradient.
//!
//! ```text
//! half-line:  x_i ≥ bound          disc:  |x_T − centre| ≤ radius, one or two entries
//! reduced gradient:  g̃_α(x) = (x − P_Ω(x − α g))/α
//! ```

use crate::qp::QpError;

/// One constrained part of x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Block {
    /// A lower bound: `x[index]` ≥ bound.
    HalfLine {
        /// Index of the bounded entry.
        index: usize,
        /// Lower bound of the entry.
        bound: f64,
    },
    /// |`x[first .. first + size]` − centre| ≤ radius.
    Disc {
        /// Index of the first entry.
        first: usize,
        /// One or two entries.
        size: usize,
        /// Centre; the second number is not read if there is one entry.
        centre: [f64; 2],
        /// Radius of the disc, ≥ 0.
        radius: f64,
    },
}

impl Block {
    /// The indices of the entries in the block.
    pub fn range(&self) -> std::ops::Range<usize> {
        match *self {
            Self::HalfLine { index, .. } => index..index + 1,
            Self::Disc { first, size, .. } => first..first + size,
        }
    }

    fn check(&self) -> Result<(), &'static str> {
        match *self {
            Self::HalfLine { bound, .. } if !bound.is_finite() => Err("the bound is not finite"),
            Self::Disc { size, .. } if size != 1 && size != 2 => Err("a disc has one or two entries"),
            Self::Disc { radius, .. } if !(radius >= 0.0 && radius.is_finite()) => {
                Err("the radius must be finite and ≥ 0")
            }
            Self::Disc { centre, .. } if !centre.iter().all(|entry| entry.is_finite()) => {
                Err("the centre is not finite")
            }
            _ => Ok(()),
        }
    }
}

/// A point of a disc in polar form: unit vector from the centre and distance.
pub(crate) fn polar(x: &[f64], centre: &[f64; 2]) -> ([f64; 2], f64) {
    let offset = [x[0] - centre[0], if x.len() > 1 { x[1] - centre[1] } else { 0.0 }];
    let length = offset[0].hypot(offset[1]);
    if length > 0.0 { ([offset[0] / length, offset[1] / length], length) } else { ([0.0; 2], 0.0) }
}

/// A product of half-lines, discs and free entries.
///
/// ```
/// use contact::qp::{Block, SeparableSet};
/// let disc = Block::Disc { first: 1, size: 2, centre: [0.0; 2], radius: 5.0 };
/// let set = SeparableSet::new(4, vec![Block::HalfLine { index: 0, bound: 0.0 }, disc])?;
/// let mut x = vec![-1.0, 6.0, 8.0, 7.0];
/// set.project(&mut x);
/// assert_eq!(x, [0.0, 3.0, 4.0, 7.0]);
/// # Ok::<(), contact::qp::QpError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SeparableSet {
    dimension: usize,
    blocks: Vec<Block>,
}

impl SeparableSet {
    /// The set of all x with `dimension` entries that obey the blocks; entries of no block are free.
    ///
    /// # Errors
    /// [`QpError::Set`] when a block is no convex set, leaves the vector, or shares an entry with another block.
    pub fn new(dimension: usize, blocks: Vec<Block>) -> Result<Self, QpError> {
        let mut taken = vec![false; dimension];
        for (block, data) in blocks.iter().enumerate() {
            data.check().map_err(|reason| QpError::Set { block, reason })?;
            for index in data.range() {
                match taken.get_mut(index) {
                    Some(taken) if !*taken => *taken = true,
                    Some(_) => return Err(QpError::Set { block, reason: "an entry belongs to two blocks" }),
                    None => return Err(QpError::Set { block, reason: "an entry lies outside the vector" }),
                }
            }
        }
        Ok(Self { dimension, blocks })
    }

    /// Number of entries of x.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// The blocks with a constraint; all other entries are free.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// P_Ω(x) in place; returns whether anything moved.
    pub fn project(&self, x: &mut [f64]) -> bool {
        let mut moved = false;
        for block in &self.blocks {
            match *block {
                Block::HalfLine { index, bound } if x[index] < bound => {
                    x[index] = bound;
                    moved = true;
                }
                Block::HalfLine { .. } => {}
                Block::Disc { first, size, centre, radius } => {
                    let part = &mut x[first..first + size];
                    let (direction, length) = polar(part, &centre);
                    if length > radius * (1.0 + ON_CIRCLE) || (radius == 0.0 && length > 0.0) {
                        for ((entry, e), centre) in part.iter_mut().zip(direction).zip(centre) {
                            *entry = centre + radius * e;
                        }
                        moved = true;
                    }
                }
            }
        }
        moved
    }

    /// The largest t ≤ `limit` with x + t·d in the set, for x in the set.
    pub(crate) fn feasible_step(&self, x: &[f64], direction: &[f64], limit: f64) -> f64 {
        let mut step = limit;
        for block in &self.blocks {
            match *block {
                Block::HalfLine { index, bound } => {
                    if direction[index] < 0.0 {
                        step = step.min(((bound - x[index]) / direction[index]).max(0.0));
                    }
                }
                Block::Disc { first, size, centre, radius } => {
                    let d = &direction[first..first + size];
                    let square: f64 = d.iter().map(|d| d * d).sum();
                    if square > 0.0 {
                        let offsets = x[first..first + size].iter().zip(centre).map(|(x, centre)| x - centre);
                        let (mut along, mut rest) = (0.0, radius * radius);
                        for (offset, d) in offsets.zip(d) {
                            along += offset * d;
                            rest -= offset * offset;
                        }
                        // Positive root of |offset + t d|² = radius², written without cancellation.
                        let root = (along * along + square * rest.max(0.0)).sqrt();
                        let root = if along > 0.0 { rest.max(0.0) / (along + root) } else { (root - along) / square };
                        step = step.min(root);
                    }
                }
            }
        }
        step
    }

    /// The reduced gradient g̃_α(x).
    pub fn reduced_gradient(&self, x: &[f64], gradient: &[f64], alpha: f64) -> Vec<f64> {
        let mut target: Vec<f64> = x.iter().zip(gradient).map(|(x, g)| x - alpha * g).collect();
        let mut reduced = gradient.to_vec();
        self.project(&mut target);
        for block in &self.blocks {
            for index in block.range() {
                reduced[index] = (x[index] - target[index]) / alpha;
            }
        }
        reduced
    }

    /// Splits a reduced gradient at x: squares of the norms of its free part (inside the face, sliding along circles
    /// included) and of its chopped part (leaving active constraints).
    pub fn split(&self, x: &[f64], gradient: &[f64], reduced: &[f64]) -> (f64, f64) {
        let (square, mut chopped): (f64, f64) = (reduced.iter().map(|g| g * g).sum(), 0.0);
        for block in &self.blocks {
            match *block {
                Block::HalfLine { index, bound } if x[index] <= bound => chopped += reduced[index] * reduced[index],
                Block::HalfLine { .. } => {}
                Block::Disc { first, size, centre, radius } => {
                    let range = first..first + size;
                    let (direction, length) = polar(&x[range.clone()], &centre);
                    if on_circle(length, radius) {
                        let outward: f64 = gradient[range.clone()].iter().zip(direction).map(|(g, e)| g * e).sum();
                        let radial: f64 = reduced[range].iter().zip(direction).map(|(g, e)| g * e).sum();
                        if outward > 0.0 {
                            chopped += radial * radial;
                        }
                    }
                }
            }
        }
        ((square - chopped).max(0.0), chopped)
    }
}

/// Relative distance to the circle that counts as being on it.
const ON_CIRCLE: f64 = 1e-14;

/// Whether a point at this distance from the centre counts as active.
pub(crate) fn on_circle(length: f64, radius: f64) -> bool {
    length >= radius * (1.0 - 100.0 * ON_CIRCLE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(radius: f64) -> SeparableSet {
        let blocks = vec![
            Block::HalfLine { index: 0, bound: -1.0 },
            Block::Disc { first: 1, size: 2, centre: [1.0, 0.0], radius },
            Block::Disc { first: 3, size: 1, centre: [0.0, 0.0], radius },
        ];
        SeparableSet::new(4, blocks).expect("valid")
    }

    #[test]
    fn feasible_step_ends_on_the_boundary() {
        let set = disc(2.0);
        let x = [0.0, 1.0, 0.0, 0.0];
        assert_eq!(set.feasible_step(&x, &[-1.0, 0.0, 0.0, 0.0], 9.0), 1.0);
        assert!((set.feasible_step(&x, &[0.0, 3.0, 4.0, 0.0], 9.0) - 0.4).abs() < 1e-15);
        assert_eq!(set.feasible_step(&x, &[0.0, 0.0, 0.0, -4.0], 9.0), 0.5);
        assert_eq!(set.feasible_step(&x, &[1.0, 0.0, 0.0, 0.0], 9.0), 9.0);
        assert_eq!(set.feasible_step(&[0.0, 3.0, 0.0, 0.0], &[0.0, 1.0, 0.0, 0.0], 9.0), 0.0);
    }

    #[test]
    fn bad_blocks_are_refused() {
        let refused = |blocks: Vec<Block>| matches!(SeparableSet::new(2, blocks), Err(QpError::Set { .. }));
        assert!(refused(vec![Block::HalfLine { index: 2, bound: 0.0 }]));
        assert!(refused(vec![Block::HalfLine { index: 0, bound: f64::NAN }]));
        assert!(refused(vec![Block::Disc { first: 0, size: 2, centre: [0.0; 2], radius: -1.0 }]));
        assert!(refused(vec![Block::Disc { first: 0, size: 3, centre: [0.0; 2], radius: 1.0 }]));
        let half = Block::HalfLine { index: 1, bound: 0.0 };
        assert!(refused(vec![Block::Disc { first: 0, size: 2, centre: [0.0; 2], radius: 1.0 }, half]));
    }

    #[test]
    fn reduced_gradient_vanishes_at_a_minimiser() {
        let set = disc(2.0);
        // The negative gradient points out of every active constraint: nothing can move.
        let reduced = set.reduced_gradient(&[-1.0, 3.0, 0.0, -2.0], &[5.0, -1.0, 0.0, 1.0], 0.1);
        assert!(reduced.iter().all(|g| g.abs() < 1e-14), "{reduced:?}");
        let (free, chopped) = set.split(&[-1.0, 3.0, 0.0, -2.0], &[-1.0, 2.0, 3.0, 0.0], &[-1.0, 2.0, 3.0, 0.0]);
        assert_eq!((free, chopped), (9.0, 5.0));
    }

    #[test]
    fn zero_radius_freezes_the_entries() {
        let set = disc(0.0);
        let mut x = vec![0.0, 5.0, 5.0, 5.0];
        assert!(set.project(&mut x));
        assert_eq!(x, [0.0, 1.0, 0.0, 0.0]);
        let reduced = set.reduced_gradient(&x, &[1.0; 4], 1.0);
        assert_eq!(reduced, [1.0, 0.0, 0.0, 0.0]);
    }
}
