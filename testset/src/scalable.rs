//! Problems of any dimension.

use crate::dual::Dual;
use crate::minimax::cb3_pieces;

/// max |xᵢ|.
pub fn maxl(x: &[Dual]) -> Dual {
    Dual::max(x.iter().map(Dual::abs))
}

/// n max xᵢ − Σ xᵢ.
pub fn goffin(x: &[Dual]) -> Dual {
    x.len() as f64 * Dual::max(x.iter().cloned()) - total(x)
}

/// Σ of the absolute values of the Hilbert matrix times x.
pub fn l1_hilbert(x: &[Dual]) -> Dual {
    Dual::sum(hilbert(x).map(|row| row.abs()))
}

/// The largest absolute value of the Hilbert matrix times x.
pub fn max_hilbert(x: &[Dual]) -> Dual {
    Dual::max(hilbert(x).map(|row| row.abs()))
}

/// Σ max(−xᵢ − xᵢ₊₁, −xᵢ − xᵢ₊₁ + xᵢ² + xᵢ₊₁² − 1).
pub fn chained_lq(x: &[Dual]) -> Dual {
    Dual::sum(x.windows(2).map(|pair| {
        let linear = -&pair[0] - &pair[1];
        let quadratic = &linear + pair[0].square() + pair[1].square() - 1.0;
        Dual::max([linear, quadratic])
    }))
}

/// The largest of the three sums of the pieces of CB3 along the chain.
pub fn chained_cb3_ii(x: &[Dual]) -> Dual {
    let pieces: Vec<[Dual; 3]> = x.windows(2).map(|pair| cb3_pieces(&pair[0], &pair[1])).collect();
    Dual::max((0..3).map(|k| Dual::combination(pieces.iter().map(|piece| (1.0, &piece[k])))))
}

/// max of ln(1 + |Σ xᵢ|) and all ln(1 + |xᵢ|).
pub fn active_faces(x: &[Dual]) -> Dual {
    Dual::max(x.iter().chain([&total(x)]).map(|u| u.abs().ln_1p()))
}

/// The larger of the two sums of the crescent's pieces along the chain.
pub fn chained_crescent_i(x: &[Dual]) -> Dual {
    let pieces: Vec<[Dual; 2]> = x.windows(2).map(crescent_pieces).collect();
    Dual::max((0..2).map(|k| Dual::combination(pieces.iter().map(|piece| (1.0, &piece[k])))))
}

/// The sum of the crescents along the chain.
pub fn chained_crescent_ii(x: &[Dual]) -> Dual {
    Dual::sum(x.windows(2).map(|pair| Dual::max(crescent_pieces(pair))))
}

/// ¼ (x₁ − 1)² + Σ |xᵢ₊₁ − 2 xᵢ² + 1|.
pub fn chebyshev_rosenbrock(x: &[Dual]) -> Dual {
    let links = x.windows(2).map(|pair| (&pair[1] - 2.0 * pair[0].square() + 1.0).abs());
    Dual::sum(links.chain([0.25 * (&x[0] - 1.0).square()]))
}

/// L max xᵢ + ½ μ |x|² with L = 10, μ = 1, which the optimal value −L²/(2 μ n) of the table confirms.
pub fn nesterov_worst(x: &[Dual]) -> Dual {
    10.0 * Dual::max(x.iter().cloned()) + 0.5 * Dual::sum(x.iter().map(Dual::square))
}

/// ±(x₁² + (x₂ − 1)² − 1) + x₂.
fn crescent_pieces(pair: &[Dual]) -> [Dual; 2] {
    let circle = pair[0].square() + (&pair[1] - 1.0).square() - 1.0;
    [&pair[1] + &circle, &pair[1] - &circle]
}

/// Rows of the Hilbert matrix times x.
fn hilbert(x: &[Dual]) -> impl Iterator<Item = Dual> {
    (0..x.len()).map(|i| Dual::combination(x.iter().enumerate().map(|(j, x)| (1.0 / (i + j + 1) as f64, x))))
}

fn total(x: &[Dual]) -> Dual {
    Dual::combination(x.iter().map(|x| (1.0, x)))
}
