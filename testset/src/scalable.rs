//! Problems of any dimension.

use crate::composition::{Outer, Term};
use crate::dual::Dual;
use crate::minimax::cb3_pieces;

/// max |xᵢ|.
pub fn maxl(x: &[Dual]) -> Vec<Dual> {
    x.to_vec()
}

/// n max xᵢ − Σ xᵢ, the maximum of n xᵢ − Σ xⱼ.
pub fn goffin(x: &[Dual]) -> Vec<Dual> {
    let total = total(x);
    x.iter().map(|u| x.len() as f64 * u - &total).collect()
}

/// The Hilbert matrix times x, whose entries count with their magnitudes.
pub fn hilbert(x: &[Dual]) -> Vec<Dual> {
    let row = |i: usize| Dual::combination(x.iter().enumerate().map(|(j, x)| (1.0 / (i + j + 1) as f64, x)));
    (0..x.len()).map(row).collect()
}

/// Σ max(−xᵢ − xᵢ₊₁, −xᵢ − xᵢ₊₁ + xᵢ² + xᵢ₊₁² − 1).
pub fn chained_lq(x: &[Dual]) -> Vec<Dual> {
    let pieces = |pair: &[Dual]| {
        let linear = -&pair[0] - &pair[1];
        let quadratic = &linear + pair[0].square() + pair[1].square() - 1.0;
        [linear, quadratic]
    };
    x.windows(2).flat_map(pieces).collect()
}

/// The three sums of the pieces of CB3 along the chain.
pub fn chained_cb3_ii(x: &[Dual]) -> Vec<Dual> {
    sums(x.windows(2).map(|pair| cb3_pieces(&pair[0], &pair[1])).collect())
}

/// max of ln(1 + |Σ xᵢ|) and all ln(1 + |xᵢ|), the magnitudes of smooth functions.
pub fn active_faces(x: &[Dual]) -> Vec<Dual> {
    x.iter().chain([&total(x)]).map(Dual::signed_ln_1p).collect()
}

/// The two sums of the crescent's pieces along the chain.
pub fn chained_crescent_i(x: &[Dual]) -> Vec<Dual> {
    sums(x.windows(2).map(crescent_pieces).collect())
}

/// The pieces of the crescents along the chain.
pub fn chained_crescent_ii(x: &[Dual]) -> Vec<Dual> {
    x.windows(2).flat_map(crescent_pieces).collect()
}

/// Σ |xᵢ₊₁ − 2 xᵢ² + 1| + ¼ (x₁ − 1)².
pub fn chebyshev_rosenbrock(x: &[Dual]) -> Vec<Dual> {
    let links = x.windows(2).map(|pair| &pair[1] - 2.0 * pair[0].square() + 1.0);
    links.chain([0.25 * (&x[0] - 1.0).square()]).collect()
}

/// The terms of [`chebyshev_rosenbrock`] for n variables.
pub fn chebyshev_rosenbrock_outer(n: usize) -> Outer {
    let links = vec![(1.0, Term::Magnitude); n - 1];
    Outer::Sum([links, vec![(1.0, Term::Itself)]].concat())
}

/// L max xᵢ + ½ μ |x|² with L = 10, μ = 1, which the optimal value −L²/(2 μ n) of the table confirms.
pub fn nesterov_worst(x: &[Dual]) -> Vec<Dual> {
    let square = 0.5 * Dual::sum(x.iter().map(Dual::square));
    x.iter().map(|u| 10.0 * u + &square).collect()
}

/// The sums over the links of each of their pieces.
fn sums<const K: usize>(links: Vec<[Dual; K]>) -> Vec<Dual> {
    (0..K).map(|k| Dual::combination(links.iter().map(|pieces| (1.0, &pieces[k])))).collect()
}

/// ±(x₁² + (x₂ − 1)² − 1) + x₂.
fn crescent_pieces(pair: &[Dual]) -> [Dual; 2] {
    let circle = pair[0].square() + (&pair[1] - 1.0).square() - 1.0;
    [&pair[1] + &circle, &pair[1] - &circle]
}

fn total(x: &[Dual]) -> Dual {
    Dual::combination(x.iter().map(|x| (1.0, x)))
}
