//! What every two cuts of the bundle have in common, kept from step to step: a new cut costs one pass over the others.
//!
//! ```text
//! products   ⟨g_a, W⁻¹ g_b⟩        Gram matrix of the subgradients
//! distances  ‖y_a − y_b‖²
//! slopes     ⟨g_a, y_b − y_a⟩      change of cut a's linearization from its point to that of cut b
//! ```
//! Rows and columns belong to slots, which a cut keeps as long as it stays: removing one moves no numbers.

use super::cut::Cut;
use super::norm::ScaledNorm;
use crate::qp::kernels::{dot, pair_sums};
use std::borrow::Cow;

/// The tables; cuts are named by their position in the bundle.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pairs {
    /// The slot of each cut.
    slots: Vec<usize>,
    free: Vec<usize>,
    products: Vec<Vec<f64>>,
    distances: Vec<Vec<f64>>,
    slopes: Vec<Vec<f64>>,
}

impl Pairs {
    /// The slots of the cuts in their order.
    pub(crate) fn slots(&self) -> &[usize] {
        &self.slots
    }

    /// The Gram matrix by slots; rows and columns of free slots hold what is left of former cuts.
    pub(crate) fn products(&self) -> &[Vec<f64>] {
        &self.products
    }

    /// ‖y_i − y_j‖².
    pub(crate) fn distance(&self, i: usize, j: usize) -> f64 {
        self.distances[self.slots[i]][self.slots[j]]
    }

    /// ⟨g_i, y_j − y_i⟩.
    pub(crate) fn slope(&self, i: usize, j: usize) -> f64 {
        self.slopes[self.slots[i]][self.slots[j]]
    }

    /// Takes in the last cut.
    pub(crate) fn push(&mut self, cuts: &[Cut], norm: &ScaledNorm) {
        let Some(new) = cuts.last() else { return };
        let slot = self.free.pop().unwrap_or_else(|| self.add_slot());
        let (slope, point) = (new.subgradient.as_slice(), new.point.as_slice());
        let euclidean = norm.is_euclidean();
        let raised =
            if euclidean { Cow::Borrowed(&new.subgradient) } else { Cow::Owned(norm.raise_index(&new.subgradient)) };
        for (cut, &other) in cuts.iter().zip(&self.slots) {
            let own = (cut.subgradient.as_slice(), cut.point.as_slice());
            let [ahead, behind, product, squared] = pair_sums(own.0, own.1, slope, point, raised.as_slice());
            let distance = if euclidean { squared } else { norm.squared_distance(&cut.point, &new.point) };
            self.products[slot][other] = product;
            self.products[other][slot] = product;
            self.distances[slot][other] = distance;
            self.distances[other][slot] = distance;
            self.slopes[other][slot] = ahead;
            self.slopes[slot][other] = -behind;
        }
        self.products[slot][slot] = dot(slope, raised.as_slice());
        self.distances[slot][slot] = 0.0;
        self.slopes[slot][slot] = 0.0;
        self.slots.push(slot);
    }

    /// Forgets the cut at a position.
    pub(crate) fn remove(&mut self, position: usize) {
        self.free.push(self.slots.remove(position));
    }

    /// One more row and column in every table.
    fn add_slot(&mut self) -> usize {
        let slot = self.products.len();
        for table in [&mut self.products, &mut self.distances, &mut self.slopes] {
            table.iter_mut().for_each(|row| row.push(0.0));
            table.push(vec![0.0; slot + 1]);
        }
        slot
    }
}
