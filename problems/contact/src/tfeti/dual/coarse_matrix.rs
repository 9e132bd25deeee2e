//! The coarse matrix of one active set: its constant part is factored once per shape, the rest is dense and small.
//!
//! ```text
//! G_T Gqᵀ = [ K_II  K_IC ]     C: amplitudes of subdomains with contact rows,  U: what the contact rows of the active set add
//!           [ K_CI  K_CC + U ]
//! S = K_CC − K_CI K_II⁻¹ K_IC once per shape;    method.md (4.9)
//! b_C ← b_C − K_CI K_II⁻¹ b_I,   (S + U) a_C = b_C,   K_II a_I = b_I − K_IC a_C
//! ```
//! K = G_E G_Eᵀ is symmetric and sparse, and singular where contact alone holds a body. K + w I_C is positive definite.
//! Its factor serves both ends: its leading columns eliminate I, and its trailing block L₂₂ gives S = L₂₂L₂₂ᵀ − w I_C.
//! w is the mean of the diagonal of K_CC, so that the difference keeps its digits; where K_CC is zero, w is one,
//! because G is dimensionless.

use crate::error::ContactError;
use crate::linear::cholesky::NumericFactor;
use crate::linear::dense::{DenseLu, multiply_columns};
use crate::linear::right_side::RightSide;
use crate::tfeti::torn::CoarsePattern;
use faer::Mat;

/// The part of the coarse matrix that all active sets of a shape share, without the subdomains away from contact.
#[derive(Debug)]
pub struct CondensedCoarse {
    /// Factor of K + w I_C.
    factor: NumericFactor,
    /// S, and what holds the grounded motions.
    schur: Mat<f64>,
    interior_count: usize,
}

impl CondensedCoarse {
    /// Condenses K, given by its lower values over `pattern.lower`. `grounded`: amplitudes of motions that nothing
    /// holds and no load works on; they are held by their part on C.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the rows of B_E leave more motions of a body free than its contact nodes
    /// see.
    pub fn new(pattern: &CoarsePattern, mut values: Vec<f64>, grounded: &[Vec<f64>]) -> Result<Self, ContactError> {
        let contact = pattern.contact_amplitudes();
        let diagonal = |&amplitude: &usize| pattern.lower.starts()[amplitude];
        let mean = contact.iter().map(|amplitude| values[diagonal(amplitude)]).sum::<f64>() / contact.len() as f64;
        let weight = if mean > 0.0 { mean } else { 1.0 };
        contact.iter().for_each(|amplitude| values[diagonal(amplitude)] += weight);
        let factor = pattern.symbolic.factorize(&values).map_err(|error| ContactError::Factorization {
            what: "constant part of the coarse matrix".into(),
            reason: error.reason,
        })?;
        let trailing = factor.trailing_block(contact.len());
        let mut schur = multiply_columns(&trailing, &trailing.transpose().to_owned());
        for (p, &row) in contact.iter().enumerate() {
            schur[(p, p)] -= weight;
            for (q, &column) in contact.iter().enumerate() {
                // Amplitudes of unit length are of the size of G Gᵀ.
                schur[(p, q)] += grounded.iter().map(|motion| motion[row] * motion[column]).sum::<f64>();
            }
        }
        Ok(Self { factor, schur, interior_count: pattern.interior_count() })
    }

    /// Factors S + U; `add_contact` hands over row, column and value of every term of U, in places within C.
    pub fn with_contact(&self, add_contact: impl FnOnce(&mut dyn FnMut(usize, usize, f64))) -> CoarseFactor<'_> {
        let mut matrix = self.schur.clone();
        add_contact(&mut |row, column, value| matrix[(row, column)] += value);
        CoarseFactor { constant: self, contact: DenseLu::new(&matrix) }
    }
}

/// The factored coarse matrix of one active set.
#[derive(Debug)]
pub struct CoarseFactor<'a> {
    constant: &'a CondensedCoarse,
    /// The factors of S + U.
    contact: DenseLu,
}

impl CoarseFactor<'_> {
    /// Smallest over largest pivot of S + U: near 0 where a rigid motion is free.
    pub fn pivot_ratio(&self) -> f64 {
        self.contact.pivot_ratio()
    }

    /// Solves G_T Gqᵀ a = b in place, in double precision.
    pub fn solve_in_place<V: RightSide>(&self, b: &mut [V]) {
        self.solve_by(b, V::Double::solve_dense);
    }

    /// Solves Gq G_Tᵀ a = b in place.
    pub fn solve_transpose_in_place(&self, b: &mut [f64]) {
        self.solve_by(b, |contact, b| contact.solve_transpose_in_place(b));
    }

    fn solve_by<V: RightSide>(&self, b: &mut [V], solve_contact: impl FnOnce(&DenseLu, &mut [V::Double])) {
        let CondensedCoarse { factor, interior_count, .. } = self.constant;
        let mut ordered: Vec<V::Double> = factor.order().iter().map(|&old| b[old].double()).collect();
        factor.eliminate(*interior_count, &mut ordered);
        solve_contact(&self.contact, &mut ordered[*interior_count..]);
        factor.substitute(*interior_count, &mut ordered);
        for (&old, entry) in factor.order().iter().zip(ordered) {
            b[old] = V::rounded(entry);
        }
    }
}
