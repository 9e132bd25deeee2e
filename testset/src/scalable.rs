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

/// A function of any number of variables whose value and subgradient take work in proportion to that number; with
/// `Dual`, whose every operation carries a gradient, the work would grow with its square.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Scalable {
    /// The name of its kind.
    pub name: &'static str,
    /// Start point.
    pub start: Vec<f64>,
    /// Optimal value.
    pub optimal_value: f64,
    function: fn(&[f64]) -> (f64, Vec<f64>),
}

impl Scalable {
    /// ChainedLQ of n ≥ 2 variables.
    pub fn chained_lq(n: usize) -> Self {
        let optimal_value = -std::f64::consts::SQRT_2 * (n - 1) as f64;
        Self { name: "ChainedLQ", start: vec![-0.5; n], optimal_value, function: chained_lq_at }
    }

    /// ChainedCB3II of n ≥ 2 variables.
    pub fn chained_cb3_ii(n: usize) -> Self {
        Self {
            name: "ChainedCB3II",
            start: vec![2.0; n],
            optimal_value: 2.0 * (n - 1) as f64,
            function: chained_cb3_ii_at,
        }
    }

    /// MAXQ of n variables, max xᵢ², from ±i. Source: M. Haarala, K. Miettinen, M. Mäkelä, Optim. Methods Softw. 19
    /// (2004).
    pub fn maxq(n: usize) -> Self {
        let start = (1..=n).map(|i| if i <= n / 2 { i as f64 } else { -(i as f64) }).collect();
        Self { name: "MAXQ", start, optimal_value: 0.0, function: maxq_at }
    }

    /// Value and one subgradient.
    pub fn evaluate(&self, x: &[f64]) -> (f64, Vec<f64>) {
        (self.function)(x)
    }
}

fn chained_lq_at(x: &[f64]) -> (f64, Vec<f64>) {
    let (mut value, mut gradient) = (0.0, vec![0.0; x.len()]);
    for (k, pair) in x.windows(2).enumerate() {
        let (link, slopes, _) = Dual::max(chained_lq(&Dual::variables(pair))).into_parts();
        value += link;
        slopes.iter().enumerate().for_each(|(i, slope)| gradient[k + i] += slope);
    }
    (value, gradient)
}

fn chained_cb3_ii_at(x: &[f64]) -> (f64, Vec<f64>) {
    let mut sums = [0.0; 3].map(|zero| (zero, vec![zero; x.len()]));
    for (k, pair) in x.windows(2).enumerate() {
        let link = Dual::variables(pair);
        for (sum, piece) in sums.iter_mut().zip(cb3_pieces(&link[0], &link[1])) {
            let (value, slopes, _) = piece.into_parts();
            sum.0 += value;
            slopes.iter().enumerate().for_each(|(i, slope)| sum.1[k + i] += slope);
        }
    }
    let [first, second, third] = sums;
    let larger = if second.0 > first.0 { second } else { first };
    if third.0 > larger.0 { third } else { larger }
}

fn maxq_at(x: &[f64]) -> (f64, Vec<f64>) {
    let largest = (1..x.len()).fold(0, |best, i| if x[i] * x[i] > x[best] * x[best] { i } else { best });
    let mut gradient = vec![0.0; x.len()];
    gradient[largest] = 2.0 * x[largest];
    (x[largest] * x[largest], gradient)
}
