//! The proof of the composite model computed again, beside the certificate that rests on it.

use super::{Certificate, CompositeProof};
use crate::checks::check_size;
use crate::composite::{OuterFunction, OuterPart};
use crate::{InputError, Vector};
use serde::{Deserialize, Serialize};

/// Differences between a certificate and its proof computed again, relative to the sizes of what is compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ProofCheck {
    /// |h(c) − Θ(x̂)|/|Θ(x̂)|.
    pub value: f64,
    /// h(c_j) and w_j against the outer function; ⟨w_j, c_j⟩ − h*(w_j), where h is built from cones.
    pub outer: f64,
    /// Gᵀw_j against the subgradients of the certificate's cuts, and e_j against their errors (relative to Θ(x̂)).
    pub cuts: f64,
}

impl ProofCheck {
    /// The largest of the differences.
    pub fn largest(&self) -> f64 {
        self.value.max(self.outer).max(self.cuts)
    }
}

impl CompositeProof {
    /// Computes the cuts of a certificate again, from outputs, Jacobian and outer function alone.
    ///
    /// # Errors
    /// [`InputError::Dimension`] if the parts do not fit together.
    pub fn recheck(&self, certificate: &Certificate, outer: &dyn OuterFunction) -> Result<ProofCheck, InputError> {
        let (m, n) = (self.outputs.len(), certificate.point.len());
        check_size("rows of the Jacobian", m, self.jacobian.nrows())?;
        check_size("columns of the Jacobian", n, self.jacobian.ncols())?;
        check_size("cuts of the outer function", certificate.cuts.len(), self.cuts.len())?;
        let relative = |difference: f64, size: f64| if difference == 0.0 { 0.0 } else { difference / size };
        let distance = |a: &Vector, b: &Vector| relative((a - b).norm(), a.norm().max(b.norm()));
        let value = outer.value(&self.outputs);
        let theta = certificate.value.abs();
        let mut check = ProofCheck { value: relative((value - certificate.value).abs(), theta), outer: 0.0, cuts: 0.0 };
        let raise =
            |largest: &mut f64, found: f64| *largest = if found.is_nan() { f64::INFINITY } else { largest.max(found) };
        for (own, cut) in self.cuts.iter().zip(&certificate.cuts) {
            check_size("outputs of a cut", m, own.outputs.len())?;
            check_size("subgradient of the outer function", m, own.subgradient.len())?;
            match outer.epigraph(m) {
                Some(epigraph) => {
                    let (product, conjugate) =
                        (own.subgradient.dot(&own.outputs), epigraph.conjugate(&own.subgradient));
                    let size = product.abs() + conjugate.abs();
                    raise(&mut check.outer, relative((product - conjugate - own.value).abs(), size));
                }
                None => {
                    let at = OuterPart { value: outer.value(&own.outputs), gradient: outer.subgradient(&own.outputs) };
                    let off = |part: &OuterPart| {
                        let sizes = part.value.abs().max(own.value.abs());
                        let value = relative((part.value - own.value).abs(), sizes);
                        value.max(distance(&part.gradient, &own.subgradient))
                    };
                    // A cut may be that of any of the functions whose maximum h is.
                    let parts = outer.parts(&own.outputs);
                    let nearest = parts.iter().chain([&at]).map(off).fold(f64::INFINITY, f64::min);
                    raise(&mut check.outer, if off(&at).is_nan() { f64::NAN } else { nearest });
                }
            }
            raise(&mut check.cuts, distance(&self.jacobian.tr_mul(&own.subgradient), &cut.subgradient));
            let seen = cut.linearization_error(&certificate.point, certificate.value);
            raise(&mut check.cuts, relative((own.error(&self.outputs, value) - seen).abs(), theta));
            raise(&mut check.cuts, (own.multiplier - cut.multiplier).abs());
        }
        Ok(check)
    }
}
