//! Residuals of data fitting in the maximum or the sum norm.

use crate::dual::Dual;

/// Σ |x₁ exp(−x₂ t) cos(x₃ t + x₄) + x₅ exp(−x₆ t) − y(t)| over t = 0, 0.1, …, 5.
pub fn el_attar(x: &[Dual]) -> Vec<Dual> {
    (0..=50)
        .map(|i| {
            let t = f64::from(i) / 10.0;
            let y = 0.5 * (-t).exp() - (-2.0 * t).exp()
                + 0.5 * (-3.0 * t).exp()
                + 1.5 * (-1.5 * t).exp() * (7.0 * t).sin()
                + (-2.5 * t).exp() * (5.0 * t).sin();
            let wave = &x[0] * (-t * &x[1]).exp() * (t * &x[2] + &x[3]).cos();
            wave + &x[4] * (-t * &x[5]).exp() - y
        })
        .collect()
}

/// max |(x₃/x₂) exp(−x₁ t) sin(x₂ t) − y(t)| over t = 0, 0.5, …, 10.
pub fn pbc3(x: &[Dual]) -> Vec<Dual> {
    (0..=20)
        .map(|i| {
            let t = 0.5 * f64::from(i);
            let (slow, fast) = (3.0 * (2.0 * t).sin(), 11.0 * (2.0 * t).cos());
            let y = 0.15 * (-t).exp() + (-5.0 * t).exp() / 52.0 - (-2.0 * t).exp() * (slow + fast) / 65.0;
            &x[2] / &x[1] * (-t * &x[0]).exp() * (t * &x[1]).sin() - y
        })
        .collect()
}

/// max |(x₁ + x₂ t + x₃ t²) / (1 + x₄ t + x₅ t²) − √((8t − 1)² + 1) arctan(8t) / (8t)| over 30 points of [−1, 1].
pub fn pbc1(x: &[Dual]) -> Vec<Dual> {
    (0..30)
        .map(|i| {
            let t = -1.0 + 2.0 * f64::from(i) / 29.0;
            let s = 8.0 * t;
            let y = (s - 1.0).hypot(1.0) * s.atan() / s;
            let numerator = &x[0] + t * &x[1] + t * t * &x[2];
            numerator / (1.0 + t * &x[3] + t * t * &x[4]) - y
        })
        .collect()
}

/// max |x₁ exp(x₃ t) + x₂ exp(x₄ t) − 1/(1 + t)| over t = −0.5, −0.45, …, 0.5.
pub fn oet6(x: &[Dual]) -> Vec<Dual> {
    (0..=20)
        .map(|i| {
            let t = -0.5 + f64::from(i) / 20.0;
            &x[0] * (t * &x[2]).exp() + &x[1] * (t * &x[3]).exp() - 1.0 / (1.0 + t)
        })
        .collect()
}

/// max |yᵢ − x₁ tᵢ (tᵢ + x₂) / (tᵢ² + x₃ tᵢ + x₄)|.
pub fn kowalik_osborne(y: Vec<f64>, t: Vec<f64>) -> impl Fn(&[Dual]) -> Vec<Dual> {
    move |x| {
        let rational = |t: f64| t * &x[0] * (t + &x[1]) / (t * t + t * &x[2] + &x[3]);
        y.iter().zip(&t).map(|(&y, &t)| y - rational(t)).collect()
    }
}

/// Watson's differential equation u' = u² + 1, u(0) = 0 for the polynomial u = Σ xⱼ tʲ⁻¹ at 29 points of (0, 1].
pub fn watson(x: &[Dual]) -> Vec<Dual> {
    let initial = [x[0].clone(), &x[1] - x[0].square() - 1.0];
    let residuals = (1..=29).map(|i| {
        let t = f64::from(i) / 29.0;
        let value = Dual::combination(x.iter().zip(0..).map(|(x, j)| (t.powi(j), x)));
        let slope = Dual::combination(x.iter().zip(0..).skip(1).map(|(x, j)| (f64::from(j) * t.powi(j - 1), x)));
        slope - value.square() - 1.0
    });
    initial.into_iter().chain(residuals).collect()
}
