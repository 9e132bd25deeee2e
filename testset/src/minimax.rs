//! Outputs of small problems, nearly all maxima of explicit pieces.

use crate::dual::Dual;

/// 100 (x₂ − x₁²)² + (1 − x₁)², the smooth control case.
pub fn rosenbrock(x: &[Dual]) -> Dual {
    100.0 * (&x[1] - x[0].square()).square() + (1.0 - &x[0]).square()
}

/// Charalambous and Bandler's second problem.
pub fn cb2(x: &[Dual]) -> Vec<Dual> {
    vec![x[0].square() + x[1].powi(4), (2.0 - &x[0]).square() + (2.0 - &x[1]).square(), 2.0 * (&x[1] - &x[0]).exp()]
}

/// Charalambous and Bandler's third problem.
pub fn cb3(x: &[Dual]) -> Vec<Dual> {
    cb3_pieces(&x[0], &x[1]).into()
}

/// The three pieces of the third problem in one pair of variables.
pub fn cb3_pieces(a: &Dual, b: &Dual) -> [Dual; 3] {
    [a.powi(4) + b.square(), (2.0 - a).square() + (2.0 - b).square(), 2.0 * (b - a).exp()]
}

/// Demyanov and Malozemov.
pub fn dem(x: &[Dual]) -> Vec<Dual> {
    vec![5.0 * &x[0] + &x[1], -5.0 * &x[0] + &x[1], x[0].square() + x[1].square() + 4.0 * &x[1]]
}

/// A quadratic with two linear penalties.
pub fn ql(x: &[Dual]) -> Vec<Dual> {
    let square = x[0].square() + x[1].square();
    let first = &square + 10.0 * (4.0 - 4.0 * &x[0] - &x[1]);
    let second = &square + 10.0 * (6.0 - &x[0] - 2.0 * &x[1]);
    vec![square, first, second]
}

/// Mifflin's first problem, 20 max(c₁, 0) + c₂: a steep penalty outside the unit disk.
pub fn mifflin1(x: &[Dual]) -> Vec<Dual> {
    vec![x[0].square() + x[1].square() - 1.0, -&x[0]]
}

/// Mifflin's second problem, c₁ + 1.75 |c₂| + c₃: a curved kink on the unit circle.
pub fn mifflin2(x: &[Dual]) -> Vec<Dual> {
    let circle = x[0].square() + x[1].square() - 1.0;
    vec![2.0 * &circle, circle, -&x[0]]
}

/// max bᵢ Σ (xⱼ − aᵢⱼ)².
pub fn shor(a: Vec<Vec<f64>>, b: Vec<f64>) -> impl Fn(&[Dual]) -> Vec<Dual> {
    move |x| {
        let squares = |row: &Vec<f64>| Dual::sum(x.iter().zip(row).map(|(x, &a)| (x - a).square()));
        a.iter().zip(&b).map(|(row, &b)| b * squares(row)).collect()
    }
}

/// Lemaréchal's maximum of five quadratics in ten variables.
pub fn maxquad() -> impl Fn(&[Dual]) -> Vec<Dual> {
    let n = 10;
    let pieces: Vec<(Vec<Vec<f64>>, Vec<f64>)> = (1..=5).map(|k| maxquad_piece(n, f64::from(k))).collect();
    move |x| {
        let piece = |(a, b): &(Vec<Vec<f64>>, Vec<f64>)| {
            // xᵀ A x − bᵀ x = Σ xᵢ ((A x)ᵢ − bᵢ)
            let row = |(row, &b): (&Vec<f64>, &f64)| Dual::combination(row.iter().copied().zip(x)) - b;
            Dual::sum(a.iter().zip(b).map(row).zip(x).map(|(row, x)| row * x))
        };
        pieces.iter().map(piece).collect()
    }
}

/// A symmetric, diagonally dominant matrix and a vector; indices count from one.
fn maxquad_piece(n: usize, k: f64) -> (Vec<Vec<f64>>, Vec<f64>) {
    let index = |i: usize| (i + 1) as f64;
    let off_diagonal = |i: usize, j: usize| {
        let (i, j) = (index(i), index(j));
        (i.min(j) / i.max(j)).exp() * (i * j).cos() * k.sin()
    };
    let entry = |i: usize, j: usize| {
        if i != j {
            return off_diagonal(i, j);
        }
        let others: f64 = (0..n).filter(|&j| j != i).map(|j| off_diagonal(i, j).abs()).sum();
        k.sin().abs() * index(i) / 10.0 + others
    };
    let a = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    let b = (0..n).map(|i| (index(i) / k).exp() * (index(i) * k).sin()).collect();
    (a, b)
}

/// Womersley and Fletcher, with a pole at x₁ = −0.1.
pub fn wf(x: &[Dual]) -> Vec<Dual> {
    let fraction = 10.0 * &x[0] / (&x[0] + 0.1);
    let square = 2.0 * x[1].square();
    vec![0.5 * (&x[0] + &fraction + &square), 0.5 * (&fraction - &x[0] + &square), 0.5 * (&x[0] - &fraction + &square)]
}

/// Six pieces in three variables.
pub fn evd52(x: &[Dual]) -> Vec<Dual> {
    let disk = x[0].square() + x[1].square();
    vec![
        &disk + x[2].square() - 1.0,
        &disk + (&x[2] - 2.0).square(),
        &x[0] + &x[1] + &x[2] - 1.0,
        &x[0] + &x[1] - &x[2] + 1.0,
        2.0 * (x[0].powi(3) + 3.0 * x[1].square() + (5.0 * &x[2] - &x[0] + 1.0).square()),
        x[0].square() - 9.0 * &x[2],
    ]
}

/// max (x₁ + x₂ t − eᵗ)² + (x₃ + x₄ sin t − cos t)² over t = 0.2, …, 4.
pub fn davidon2(x: &[Dual]) -> Vec<Dual> {
    (1..=20)
        .map(|i| {
            let t = 0.2 * f64::from(i);
            (&x[0] + t * &x[1] - t.exp()).square() + (&x[2] + t.sin() * &x[3] - t.cos()).square()
        })
        .collect()
}

/// max Σ exp((xᵢ − sin(2i + k − 3))²) / (i + k − 1) over k = 1, …, 10.
pub fn polak3(x: &[Dual]) -> Vec<Dual> {
    (1..=10)
        .map(|k| {
            Dual::sum(x.iter().zip(1..).map(|(x, i)| {
                let centre = f64::from(2 * i + k - 3).sin();
                (x - centre).square().exp() / f64::from(i + k - 1)
            }))
        })
        .collect()
}

/// Madsen and Schjær-Jacobsen's first problem.
pub fn mad1(x: &[Dual]) -> Vec<Dual> {
    vec![x[0].square() + x[1].square() + &x[0] * &x[1] - 1.0, x[0].sin(), -x[1].cos()]
}

/// Madsen and Schjær-Jacobsen's fourth problem, defined for x₂ > 0.
pub fn mad4(x: &[Dual]) -> Vec<Dual> {
    vec![-(&x[0] - &x[1]).exp(), (&x[0] - 1.0).sinh() - 1.0, -x[1].ln() - 1.0]
}
