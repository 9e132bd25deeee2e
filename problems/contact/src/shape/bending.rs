//! How much a height surface bends.
//!
//! ```text
//! αᵀBα = ∫ (∂₁₁F)² + 2 (∂₁₂F)² + (∂₂₂F)²     for the control net: divided differences between Greville abscissae
//! ```
//! The net of a plane lies in that plane, and nothing bends; the net exists for every degree, where second derivatives
//! do not.

use crate::shape::SplineSurface;
use nonsmooth::Matrix;

/// B of the controls of a surface over a base of `size` mm.
pub fn bending(surface: &SplineSurface, size: [f64; 2]) -> Matrix {
    let parts = bending_parts(surface, size).map(|rows| rows.tr_mul(&rows));
    parts.into_iter().reduce(|sum, part| sum + part).unwrap_or_default()
}

/// Rows R with B = RᵀR: the bending is |Rα|².
pub(crate) fn bending_rows(surface: &SplineSurface, size: [f64; 2]) -> Matrix {
    let parts = bending_parts(surface, size);
    let mut rows = Matrix::zeros(parts.iter().map(Matrix::nrows).sum(), parts[0].ncols());
    let mut first = 0;
    for part in &parts {
        rows.rows_mut(first, part.nrows()).copy_from(part);
        first += part.nrows();
    }
    rows
}

/// The rows of ∂₁₁, √2 ∂₁₂ and ∂₂₂.
fn bending_parts(surface: &SplineSurface, size: [f64; 2]) -> [Matrix; 3] {
    let places = surface.control_places(size);
    let [shares, slopes, curvatures] = [shares, slopes, curvatures].map(|rows| [rows(&places[0]), rows(&places[1])]);
    [
        curvatures[0].kronecker(&shares[1]),
        slopes[0].kronecker(&slopes[1]) * std::f64::consts::SQRT_2,
        shares[0].kronecker(&curvatures[1]),
    ]
}

/// Roots of the lengths that belong to the places, on the diagonal.
fn shares(places: &[f64]) -> Matrix {
    let gap = |i: usize| places.get(i + 1).map_or(0.0, |next| next - places[i]);
    let lengths = (0..places.len()).map(|i| 0.5 * (gap(i) + i.checked_sub(1).map_or(0.0, gap)));
    Matrix::from_diagonal(&nonsmooth::Vector::from_iterator(places.len(), lengths.map(f64::sqrt)))
}

/// Slopes between neighbours, times the roots of their distances.
fn slopes(places: &[f64]) -> Matrix {
    let mut rows = Matrix::zeros(places.len() - 1, places.len());
    for (i, pair) in places.windows(2).enumerate() {
        let weight = (pair[1] - pair[0]).sqrt().recip();
        (rows[(i, i)], rows[(i, i + 1)]) = (-weight, weight);
    }
    rows
}

/// Second divided differences, times the roots of the lengths that belong to the places in the middle.
fn curvatures(places: &[f64]) -> Matrix {
    let mut rows = Matrix::zeros(places.len().saturating_sub(2), places.len());
    for (i, three) in places.windows(3).enumerate() {
        let (before, after) = (three[1] - three[0], three[2] - three[1]);
        let weight = 2.0 / (before + after) * (0.5 * (before + after)).sqrt();
        rows[(i, i)] = weight / before;
        rows[(i, i + 1)] = -weight * (1.0 / before + 1.0 / after);
        rows[(i, i + 2)] = weight / after;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::SplineKind;
    use nonsmooth::Vector;

    #[test]
    fn planes_do_not_bend_and_a_bowl_bends_as_its_integral_says() {
        let (size, surface) = ([3.0, 5.0], SplineSurface::new(SplineKind::BSpline(2), [40, 40]).expect("valid"));
        let [first, second] = surface.control_places(size);
        let energy = |height: &dyn Fn(f64, f64) -> f64| {
            let heights = first.iter().flat_map(|&x| second.iter().map(move |&y| (x, y)));
            let controls = Vector::from_vec(heights.map(|(x, y)| height(x, y)).collect());
            let (rows, whole) = (bending_rows(&surface, size), bending(&surface, size));
            let (squares, form) = ((rows * &controls).norm_squared(), controls.dot(&(whole * &controls)));
            // The quadratic form loses the digits of 1/h⁴, the squares of differences do not.
            assert!((form - squares).abs() < 1e-8 * (1.0 + squares), "{form} {squares}");
            squares
        };
        assert!(energy(&|x, y| 2.0 + 0.3 * x - 0.7 * y) < 1e-18);
        // (2² + 2·0.5² + 0.6²)·15 mm², but for the half intervals at the edges.
        let exact = (4.0 + 0.5 + 0.36) * 15.0;
        let found = energy(&|x, y| x * x + 0.5 * x * y + 0.3 * y * y);
        assert!((found / exact - 1.0).abs() < 0.05, "{found} {exact}");
    }
}
