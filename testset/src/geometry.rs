//! Points in the plane and an exchange economy.

use std::sync::Arc;

use crate::dual::Dual;
use crate::dual::Function;

/// The smallest of the three distances of three points, with a minus; each point stays in a pentagon.
pub fn pentagon(x: &[Dual]) -> Dual {
    let distance = |i: usize, j: usize| (&x[i] - &x[j]).hypot(&(&x[i + 1] - &x[j + 1]));
    Dual::max([-distance(0, 2), -distance(2, 4), -distance(4, 0)])
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

/// Length of a network: a chain of free points from the origin to (5.5, −1), each tied to a fixed point.
pub fn steiner(data: Steiner) -> Function {
    Arc::new(move |x| {
        let (u, v) = x.split_at(data.x.len());
        let last = u.len() - 1;
        let ends = u[0].hypot(&v[0]) + (&u[last] - 5.5).hypot(&(&v[last] + 1.0));
        let fixed = (0..=last).map(|j| data.to_fixed[j] * (&u[j] - data.x[j]).hypot(&(&v[j] - data.y[j])));
        let chain = (0..last).map(|j| data.to_next[j] * (&u[j] - &u[j + 1]).hypot(&(&v[j] - &v[j + 1])));
        Dual::sum(fixed.chain(chain).chain([ends]))
    })
}

/// Largest excess demand of an exchange economy at the prices x: consumer i owns wᵢₖ of the good k.
///
/// ```text
/// f_k = Σᵢ ( aᵢₖ Σⱼ wᵢⱼ xⱼ / (x_k^bᵢ Σⱼ aᵢⱼ xⱼ^(1−bᵢ)) − wᵢₖ )
/// ```
pub fn equilibrium(a: Vec<Vec<f64>>, w: Vec<Vec<f64>>, b: Vec<f64>) -> Function {
    Arc::new(move |x| {
        let consumers = a.iter().zip(&w).zip(&b);
        // Income over price level of each consumer.
        let budgets: Vec<Dual> = consumers
            .map(|((a, w), &b)| {
                let powers: Vec<Dual> = x.iter().map(|x| x.powf(1.0 - b)).collect();
                Dual::combination(w.iter().copied().zip(x)) / Dual::combination(a.iter().copied().zip(&powers))
            })
            .collect();
        Dual::max(
            x.iter()
                .enumerate()
                .map(|(k, price)| Dual::sum((0..b.len()).map(|i| a[i][k] * &budgets[i] / price.powf(b[i]) - w[i][k]))),
        )
    })
}
