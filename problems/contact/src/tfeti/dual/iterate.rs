//! What an iteration for the multipliers moves, and what it ends with.

use crate::equilibrium::law::Linearization;
use crate::tfeti::torn::RowVector;

/// Multipliers with their image under F, and what follows from them.
#[derive(Debug, Clone)]
pub struct Iterate {
    /// λ over all rows.
    pub(crate) multipliers: RowVector,
    /// The product F λ.
    pub(crate) image: RowVector,
    pub(crate) amplitudes: Vec<f64>,
    /// w = B u − g over all rows.
    pub(crate) jumps: RowVector,
}

impl Iterate {
    /// The iterate between this one (t = 0) and another (t = 1).
    pub fn towards(&self, other: &Self, t: f64) -> Self {
        let mut between = self.clone();
        let mix = |from: &mut [f64], to: &[f64]| from.iter_mut().zip(to).for_each(|(a, b)| *a += t * (b - *a));
        mix(&mut between.multipliers, &other.multipliers);
        mix(&mut between.image, &other.image);
        mix(&mut between.amplitudes, &other.amplitudes);
        mix(&mut between.jumps, &other.jumps);
        between
    }
}

/// The contact forces that a method has found.
#[derive(Debug, Clone)]
pub struct TornSolution {
    pub(crate) iterate: Iterate,
    /// The derivative selected at every contact node.
    pub(crate) linearizations: Vec<Linearization>,
    pub(crate) residual: f64,
    /// Steps of the method.
    pub(crate) steps: usize,
}
