//! Points in the plane and an exchange economy.

use crate::composition::{Outer, Term};
use crate::dual::Dual;

/// The smallest of the three distances of three points, with a minus; each point stays in a pentagon.
pub fn pentagon(x: &[Dual]) -> Vec<Dual> {
    let distance = |i: usize, j: usize| (&x[i] - &x[j]).hypot(&(&x[i + 1] - &x[j + 1]));
    vec![-distance(0, 2), -distance(2, 4), -distance(4, 0)]
}

/// Data of the Steiner network: fixed points and the weights of the edges.
pub struct Steiner {
    /// Abscissae of the fixed points.
    pub x: Vec<f64>,
    /// Ordinates of the fixed points.
    pub y: Vec<f64>,
    /// Weights of the edges to the fixed points.
    pub to_fixed: Vec<f64>,
    /// Weights of the edges between neighbours.
    pub to_next: Vec<f64>,
}

/// Edges of a network: a chain of free points from the origin to (5.5, −1), each tied to a fixed point.
pub fn steiner(data: Steiner) -> impl Fn(&[Dual]) -> Vec<Dual> {
    move |x| {
        let (u, v) = x.split_at(data.x.len());
        let last = u.len() - 1;
        let fixed = (0..=last).map(|j| [&u[j] - data.x[j], &v[j] - data.y[j]]);
        let chain = (0..last).map(|j| [&u[j] - &u[j + 1], &v[j] - &v[j + 1]]);
        let ends = [[u[0].clone(), v[0].clone()], [&u[last] - 5.5, &v[last] + 1.0]];
        fixed.chain(chain).chain(ends).flatten().collect()
    }
}

/// The length of the network: the weighted lengths of its edges.
pub fn steiner_outer(data: &Steiner) -> Outer {
    let weights = data.to_fixed.iter().chain(&data.to_next).chain(&[1.0, 1.0]);
    Outer::Sum(weights.map(|&weight| (weight, Term::Length)).collect())
}

/// Excess demands of an exchange economy at the prices x, the largest of which counts: consumer i owns wᵢₖ of the good
/// k.
///
/// ```text
/// f_k = Σᵢ ( aᵢₖ Σⱼ wᵢⱼ xⱼ / (x_k^bᵢ Σⱼ aᵢⱼ xⱼ^(1−bᵢ)) − wᵢₖ )
/// ```
pub fn equilibrium(a: Vec<Vec<f64>>, w: Vec<Vec<f64>>, b: Vec<f64>) -> impl Fn(&[Dual]) -> Vec<Dual> {
    move |x| {
        let consumers = a.iter().zip(&w).zip(&b);
        // Income over price level of each consumer.
        let budgets: Vec<Dual> = consumers
            .map(|((a, w), &b)| {
                let powers: Vec<Dual> = x.iter().map(|x| x.powf(1.0 - b)).collect();
                Dual::combination(w.iter().copied().zip(x)) / Dual::combination(a.iter().copied().zip(&powers))
            })
            .collect();
        let excess = |(k, price): (usize, &Dual)| {
            Dual::sum((0..b.len()).map(|i| a[i][k] * &budgets[i] / price.powf(b[i]) - w[i][k]))
        };
        x.iter().enumerate().map(excess).collect()
    }
}
