//! A contact node with its rows and the nodes that may be in them.

use std::ops::Range;

/// Part of a prescribed jump, relative to the displacements that it is the difference of, that is rounding.
const ROUNDING: f64 = 1e-13;

/// A node of a body that may be in the rows of a contact node; its weight depends on the shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// The body.
    pub body: usize,
    /// The node of its mesh.
    pub node: u32,
    /// The displacement that supports prescribe to it along its held directions, mm.
    pub prescribed: [f64; 3],
}

/// A node of a slave face with its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPoint {
    /// The contact, by its place in the scene.
    pub contact: usize,
    /// The slave body.
    pub body: usize,
    /// The node of its mesh.
    pub node: u32,
    /// The nodes in its rows, its own first, then those of the master that have weights at some shape.
    pub sides: Vec<Side>,
    /// Position of its normal row in a packed contact vector.
    pub start: usize,
    /// Number of its tangential rows.
    pub tangents: usize,
    /// Whether any tangential direction is free, with or without a row.
    pub can_slide: bool,
    /// Friction coefficient 𝓕.
    pub friction: f64,
    /// Whether it is glued to the master.
    pub is_tied: bool,
    /// Orthonormal directions in which it is free.
    pub free: Vec<[f64; 3]>,
}

impl ContactPoint {
    /// Number of rows of this node.
    pub fn row_count(&self) -> usize {
        1 + self.tangents
    }

    /// Its rows in a packed contact vector.
    pub fn rows(&self) -> Range<usize> {
        self.start..self.start + self.row_count()
    }

    /// Σ weight · prescribed displacement of its nodes, mm, for the weights of a shape: the jump where nothing else
    /// moves.
    pub fn prescribed_jump(&self, weights: &[f64]) -> [f64; 3] {
        let sides = || self.sides.iter().zip(weights);
        std::array::from_fn(|axis| sides().map(|(side, weight)| weight * side.prescribed[axis]).sum())
    }

    /// The part of the prescribed jump across the directions in which it is free, which no row has, mm.
    pub(crate) fn imposed(&self, weights: &[f64]) -> [f64; 3] {
        let mut jump = self.prescribed_jump(weights);
        let size = |vector: [f64; 3]| vector.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        let largest = self.sides.iter().map(|side| size(side.prescribed)).fold(0.0, f64::max);
        for direction in &self.free {
            let share: f64 = (0..3).map(|axis| direction[axis] * jump[axis]).sum();
            (0..3).for_each(|axis| jump[axis] -= share * direction[axis]);
        }
        if size(jump) > ROUNDING * largest { jump } else { [0.0; 3] }
    }
}
