//! Nodal normals of a smooth surface of unknown form, by fits of quadrics over two rings of facets.
//!
//! ```text
//! in the frame (a, b, n) of a node:   z − k z²/2 = s₁ x + s₂ y + (k₁₁ x² + 2 k₁₂ x y + k₂₂ y²)/2      least squares
//! k: principal curvature of largest modulus of the last sweep,   n ← n − s₁ a − s₂ b,   repeated
//! middle of an edge:  (x₀ + x₁)/2 + (L/2) s/(1 + √(1 − s²)) n̄,   s = (n₁ − n₀)·d/(2L),  d = x₁ − x₀, L = |d|
//! ```
//! The term k z²/2 makes the fit, and the middle, exact on circles.

use crate::mortar::vector::{across, dot, length, plus};
use nalgebra::{DMatrix, DVector};

/// Sweeps of the fit.
const SWEEPS: usize = 12;
/// Change of a slope that ends them.
const STILL: f64 = 1e-14;
/// Singular values of the scaled matrix, relative to the largest, below which a direction is not seen.
const UNSEEN: f64 = 0.03;

/// The normal of a node and the largest distance of the points from the quadric, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct FittedNormal {
    pub normal: [f64; 3],
    pub residual: f64,
}

/// Fits a quadric through a node with a first normal to the points around it; none with fewer than five.
pub(super) fn fitted_normal(node: [f64; 3], first: [f64; 3], points: &[[f64; 3]]) -> Option<FittedNormal> {
    if points.len() < 5 {
        return None;
    }
    let (mut normal, mut curvature, mut residual) = (first, 0.0, 0.0);
    for _ in 0..SWEEPS {
        let [a, b] = across(normal);
        let local: Vec<[f64; 3]> = points
            .iter()
            .map(|&x| {
                let from = plus(x, -1.0, node);
                [dot(a, from), dot(b, from), dot(normal, from)]
            })
            .collect();
        let [s1, s2, k11, k12, k22] = quadric(&local, curvature)?;
        let (half, difference) = (0.5 * (k11 + k22), (0.25 * (k11 - k22).powi(2) + k12 * k12).sqrt());
        let rest = |&[x, y, z]: &[f64; 3]| {
            let form = s1 * x + s2 * y + 0.5 * (k11 * x * x + 2.0 * k12 * x * y + k22 * y * y);
            (z - 0.5 * curvature * z * z - form).abs()
        };
        residual = local.iter().map(rest).fold(0.0, f64::max);
        curvature = if half < 0.0 { half - difference } else { half + difference };
        let turned = plus(plus(normal, -s1, a), -s2, b);
        let size = length(turned);
        normal = turned.map(|x| x / size);
        if s1.hypot(s2) < STILL {
            break;
        }
    }
    normal.iter().all(|x| x.is_finite()).then_some(FittedNormal { normal, residual })
}

/// s₁, s₂, k₁₁, k₁₂, k₂₂.
fn quadric(local: &[[f64; 3]], curvature: f64) -> Option<[f64; 5]> {
    let terms = |[x, y, _]: [f64; 3]| [x, y, 0.5 * x * x, x * y, 0.5 * y * y];
    let mut matrix = DMatrix::from_fn(local.len(), 5, |row, k| terms(local[row])[k]);
    let right = DVector::from_fn(local.len(), |row, _| local[row][2] - 0.5 * curvature * local[row][2].powi(2));
    let scales: Vec<f64> = matrix.column_iter().map(|column| column.norm()).collect();
    for (mut column, &scale) in matrix.column_iter_mut().zip(&scales) {
        if scale > 0.0 {
            column /= scale;
        }
    }
    let svd = matrix.svd(true, true);
    let cut = UNSEEN * svd.singular_values.max();
    let solution = svd.solve(&right, cut).ok()?;
    Some(std::array::from_fn(|k| if scales[k] > 0.0 { solution[k] / scales[k] } else { 0.0 }))
}

/// The middle of the arc between two nodes with their normals.
pub(super) fn middle([x0, x1]: [[f64; 3]; 2], [n0, n1]: [[f64; 3]; 2]) -> [f64; 3] {
    let d = plus(x1, -1.0, x0);
    let long = length(d);
    let chord: [f64; 3] = std::array::from_fn(|axis| 0.5 * (x0[axis] + x1[axis]));
    let sine = dot(plus(n1, -1.0, n0), d) / (2.0 * long);
    let sum = plus(n0, 1.0, n1);
    let normal = plus(sum, -dot(sum, d) / (long * long), d);
    let size = length(normal);
    if size.is_nan() || size <= 0.0 || sine.abs() >= 1.0 {
        return chord;
    }
    plus(chord, 0.5 * long * sine / (1.0 + (1.0 - sine * sine).sqrt()) / size, normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_and_middles_of_circles_are_exact() {
        let radius = 3.0;
        let at = |angle: f64, z: f64| [radius * angle.cos(), radius * angle.sin(), z];
        let points: Vec<[f64; 3]> =
            [-0.4, -0.2, 0.0, 0.2, 0.4].into_iter().flat_map(|s| [-0.5, 0.0, 0.5].map(|z| at(s, z))).collect();
        let node = at(0.0, 0.0);
        let points: Vec<[f64; 3]> = points.into_iter().filter(|x| *x != node).collect();
        let fit = fitted_normal(node, [0.98, 0.198_997_487_421_324, 0.0], &points).expect("enough points");
        assert!((fit.normal[0] - 1.0).abs() < 1e-12 && fit.residual < 1e-8, "{fit:?}");
        let found = middle([at(0.1, 0.0), at(0.5, 0.0)], [at(0.1, 0.0), at(0.5, 0.0)].map(|x| x.map(|y| y / radius)));
        let exact = at(0.3, 0.0);
        assert!((0..3).all(|axis| (found[axis] - exact[axis]).abs() < 1e-14), "{found:?}");
    }
}
