//! Linear objectives with limits on the largest eigenvalue of A₀ + Σ xᵢ Aᵢ, which has kinks where eigenvalues coincide.

use super::problem::{ConstrainedProblem, Kind, smooth};
use crate::dual::Dual;
use std::f64::consts::PI;

type Matrix = Vec<Vec<f64>>;

/// The problems of this file.
pub fn problems() -> Vec<ConstrainedProblem> {
    vec![max_cut(), lovasz(), connectivity(), educational_testing(), two_spectra()]
}

/// A symmetric matrix that depends affinely on the variables.
struct Affine {
    constant: Matrix,
    slopes: Vec<Matrix>,
}

impl Affine {
    /// The largest eigenvalue. Each eigenvalue is qᵀ A q with its eigenvector q, and qᵀ Aᵢ q are its derivatives.
    fn largest_eigenvalue(&self, x: &[Dual]) -> Dual {
        let mut matrix = self.constant.clone();
        for (slope, x) in self.slopes.iter().zip(x) {
            for (row, slopes) in matrix.iter_mut().zip(slope) {
                row.iter_mut().zip(slopes).for_each(|(entry, slope)| *entry += slope * x.value());
            }
        }
        let linear = |q: &Vec<f64>| {
            let slopes = self.slopes.iter().map(|slope| form(slope, q));
            Dual::combination(slopes.zip(x)) + form(&self.constant, q)
        };
        Dual::max(eigenvectors(matrix).iter().map(linear))
    }
}

/// qᵀ A q.
fn form(matrix: &Matrix, q: &[f64]) -> f64 {
    let product = |row: &Vec<f64>| row.iter().zip(q).map(|(a, q)| a * q).sum::<f64>();
    matrix.iter().zip(q).map(|(row, q)| q * product(row)).sum()
}

/// The eigenvectors of a symmetric matrix, by Jacobi's rotations.
fn eigenvectors(mut a: Matrix) -> Vec<Vec<f64>> {
    let n = a.len();
    let mut vectors = matrix(n, |i, j| f64::from(u8::from(i == j)));
    for _ in 0..60 {
        for (p, q) in (0..n).flat_map(|p| (p + 1..n).map(move |q| (p, q))) {
            if a[p][q] == 0.0 {
                continue;
            }
            let ratio = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let tangent = 1_f64.copysign(ratio) / (ratio.abs() + ratio.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            let rotate = |u: f64, v: f64| (cosine * (u - tangent * v), cosine * (tangent * u + v));
            for row in &mut a {
                (row[p], row[q]) = rotate(row[p], row[q]);
            }
            for k in 0..n {
                (a[p][k], a[q][k]) = rotate(a[p][k], a[q][k]);
                (vectors[p][k], vectors[q][k]) = rotate(vectors[p][k], vectors[q][k]);
            }
            (a[p][q], a[q][p]) = (0.0, 0.0);
        }
    }
    vectors
}

fn matrix(n: usize, entry: impl Fn(usize, usize) -> f64) -> Matrix {
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

/// Weight · (eᵢ − eⱼ)(eᵢ − eⱼ)ᵀ.
fn edge(n: usize, (i, j): (usize, usize), weight: f64) -> Matrix {
    let sign = |k: usize| f64::from(u8::from(k == i)) - f64::from(u8::from(k == j));
    matrix(n, |k, l| weight * sign(k) * sign(l))
}

/// Weight at the entries (i, j) and (j, i).
fn entry(n: usize, (i, j): (usize, usize), weight: f64) -> Matrix {
    matrix(n, |k, l| if (k, l) == (i, j) || (k, l) == (j, i) { weight } else { 0.0 })
}

fn linear(cost: Vec<f64>) -> impl Fn(&[Dual]) -> Dual {
    move |x| Dual::combination(cost.iter().copied().zip(x))
}

fn problem<const M: usize>(
    name: (&str, &'static str),
    start: Vec<f64>,
    cost: Vec<f64>,
    matrices: [Affine; M],
) -> ConstrainedProblem {
    let limits = move |x: &[Dual]| matrices.iter().map(|matrix| matrix.largest_eigenvalue(x)).collect();
    ConstrainedProblem::new(name, start, smooth(linear(cost)), [Kind::Nonsmooth; M], limits)
}

/// Bound of the largest cut of Petersen's graph: Σ xᵢ with L/4 − diag(x) negative semidefinite. The largest eigenvalue
/// at the solution has multiplicity four.
fn max_cut() -> ConstrainedProblem {
    let ring = (0..5).map(|i| (i, (i + 1) % 5));
    let edges = ring.chain((0..5).map(|i| (i, i + 5))).chain((0..5).map(|i| (5 + i, 5 + (i + 2) % 5)));
    let edges: Vec<Matrix> = edges.map(|pair| edge(10, pair, 0.25)).collect();
    let constant = matrix(10, |i, j| edges.iter().map(|edge| edge[i][j]).sum());
    let slopes = (0..10).map(|i| entry(10, (i, i), -1.0)).collect();
    let source = "C. Delorme, S. Poljak, Math. Program. 62 (1993), largest cut; Petersen's graph";
    problem(("MaxCutPetersen", source), vec![3.0; 10], vec![1.0; 10], [Affine { constant, slopes }])
        .solved(12.5, 1, 15.0)
}

/// Lovász' number of the heptagon, the smallest largest eigenvalue x₁ of J + Σ xₖ (eᵢ eⱼᵀ + eⱼ eᵢᵀ) over its edges.
fn lovasz() -> ConstrainedProblem {
    let identity = matrix(7, |i, j| if i == j { -1.0 } else { 0.0 });
    let edges = (0..7).map(|i| entry(7, (i, (i + 1) % 7), 1.0));
    let slopes = [identity].into_iter().chain(edges).collect();
    let unit: Vec<f64> = (0..8).map(|i| f64::from(u8::from(i == 0))).collect();
    let start = unit.iter().map(|entry| 8.0 * entry).collect();
    let source = "L. Lovász, IEEE Trans. Inf. Theory 25 (1979), the heptagon";
    let cosine = (PI / 7.0).cos();
    problem(("LovaszHeptagon", source), start, unit, [Affine { constant: matrix(7, |_, _| 1.0), slopes }]).solved(
        7.0 * cosine / (1.0 + cosine),
        1,
        1.5,
    )
}

/// Smallest sum of the weights of the cube's edges with algebraic connectivity one, an eigenvalue of multiplicity
/// three.
fn connectivity() -> ConstrainedProblem {
    let pairs = (0..8_usize).flat_map(|i| (0..3).map(move |bit| (i, i ^ (1 << bit)))).filter(|(i, j)| i < j);
    let slopes = pairs.map(|pair| edge(8, pair, -1.0)).collect();
    let constant = matrix(8, |i, j| if i == j { 0.0 } else { -1.0 });
    let source = "F. Göring, C. Helmberg, M. Wappler, SIAM J. Optim. 19 (2008), connectivity; the cube";
    problem(("ConnectivityCube", source), vec![1.0; 12], vec![1.0; 12], [Affine { constant, slopes }])
        .within([0.0; 12], [f64::INFINITY; 12])
        .solved(6.0, 1, 9.0)
}

/// The largest Σ xᵢ with x ≥ 0 and S − diag(x) positive semidefinite.
fn educational_testing() -> ConstrainedProblem {
    let distance = |i: usize, j: usize| i.abs_diff(j) as f64;
    let own = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
    let constant = matrix(6, |i, j| -(-0.5 * distance(i, j)).exp() - own(i, j) - 0.1 * ((i * j) as f64).cos());
    let slopes = (0..6).map(|i| entry(6, (i, i), 1.0)).collect();
    let source = "R. Fletcher, SIAM J. Sci. Stat. Comput. 2 (1981), educational testing; covariances added here";
    problem(("EducationalTesting6", source), vec![0.0; 6], vec![-1.0; 6], [Affine { constant, slopes }])
        .within([0.0; 6], [f64::INFINITY; 6])
        .solved(-7.320832406714, 1, 9.0)
}

/// Two matrices whose largest eigenvalues are at most one; both are double at the solution.
fn two_spectra() -> ConstrainedProblem {
    let affine = |scale: f64| {
        let slope = |k: usize| matrix(4, |i, j| (scale * ((k + 1) * (i.min(j) + 1)) as f64 + i.max(j) as f64).cos());
        let constant = matrix(4, |i, j| if i == j { -1.0 } else { 0.0 });
        Affine { constant, slopes: (0..6).map(slope).collect() }
    };
    let source = "M. L. Overton, SIAM J. Matrix Anal. Appl. 9 (1988), affine families; data added here";
    let cost = vec![-1.0, 0.0, 1.0, 0.0, -1.0, 1.0];
    problem(("TwoSpectra", source), vec![0.0; 6], cost, [affine(1.0), affine(0.8)]).solved(-1.304744523032, 2, 2.0)
}
