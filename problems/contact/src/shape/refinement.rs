//! Coarser splines whose surfaces are surfaces of a finer one too: fewer knots, or a lower degree where one polynomial
//! is left.
//!
//! ```text
//! N^coarse_j = Σ_i P_ij N_i,     F_β = F_{Pβ}     exactly: knot insertion and degree elevation
//! ```
//! P is found by interpolation at the Greville abscissae of the fine basis, where that is always possible.

use crate::error::SceneError;
use crate::shape::SplineSurface;
use crate::shape::bspline::Basis;
use nonsmooth::Matrix;

impl SplineSurface {
    /// The coarser surface with about so many control points per axis, at most those of this one, whose surfaces this
    /// one has too.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for fewer than two control points.
    pub fn coarser(&self, count: usize) -> Result<Self, SceneError> {
        let [first, second] = self.bases();
        Ok(Self::of_bases([coarser(first, count)?, coarser(second, count)?]))
    }

    /// P from the controls of a coarser surface to those of this one for the same heights.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] where a system of equations is singular.
    pub fn refinement(&self, coarse: &Self) -> Result<Matrix, SceneError> {
        let ([first, second], [coarse_first, coarse_second]) = (self.bases(), coarse.bases());
        Ok(refinement(first, coarse_first)?.kronecker(&refinement(second, coarse_second)?))
    }
}

/// A basis of about so many functions within the span of a fine one.
fn coarser(fine: &Basis, count: usize) -> Result<Basis, SceneError> {
    if count >= fine.count() {
        return Ok(fine.clone());
    }
    if count <= fine.degree() + 1 {
        return Basis::clamped_uniform(count.saturating_sub(1), count);
    }
    let (spans, wanted) = (fine.count() - fine.degree(), count - fine.degree());
    let kept = |index: usize| fine.knots()[fine.degree() + (index * spans + wanted / 2) / wanted];
    Ok(Basis::clamped_at(fine.degree(), (1..wanted).map(kept)))
}

/// P along one axis.
fn refinement(fine: &Basis, coarse: &Basis) -> Result<Matrix, SceneError> {
    let places = fine.greville();
    let values = |basis: &Basis| {
        let rows: Vec<f64> = places.iter().flat_map(|&place| basis.values(place)).collect();
        Matrix::from_row_slice(places.len(), basis.count(), &rows)
    };
    let solved = values(fine).lu().solve(&values(coarse));
    solved.ok_or_else(|| SceneError::out_of_range("surface.control_points", fine.count(), "a basis that interpolates"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::SplineKind;

    /// The heights of a coarse surface are those of the fine one, at places that are no knots.
    #[test]
    fn refinement_is_exact() {
        let kinds =
            [(SplineKind::BSpline(3), [6, 9]), (SplineKind::BSpline(2), [7, 5]), (SplineKind::BSpline(1), [6, 5])];
        for (kind, counts) in kinds.into_iter().chain([(SplineKind::Bezier, [7, 5])]) {
            let fine = SplineSurface::new(kind, counts).expect("valid");
            for count in 2..9 {
                let coarse = fine.coarser(count).expect("valid");
                assert!((0..2).all(|axis| coarse.counts()[axis] == count.min(counts[axis])), "{:?}", coarse.counts());
                let controls: Vec<f64> = (0..coarse.control_count()).map(|k| (1.0 + 7.0 * k as f64).sin()).collect();
                let refined =
                    fine.refinement(&coarse).expect("regular") * nonsmooth::Vector::from_vec(controls.clone());
                let places: [Vec<f64>; 2] = std::array::from_fn(|_| (0..=40).map(|k| f64::from(k) / 40.0).collect());
                let there = coarse.height_map_at(places.clone()).heights(&controls);
                let here = fine.height_map_at(places).heights(refined.as_slice());
                let off = there.iter().zip(&here).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-14, "{kind:?} {counts:?} from {count}: {off:e}");
            }
        }
    }
}
