//! Limits of sequences over meshes, and the rates at which they are approached.
//!
//! ```text
//! Q_n ≈ Q* + C n^(−p)      least squares over (Q*, C) for p on a grid, weights n²       (Richardson's extrapolation for meshes
//!                                                                                      that do not double)
//! ```

use serde::Serialize;

/// A limit and the rate of approach.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extrapolation {
    /// Q*, the value extrapolated to n = ∞.
    pub limit: f64,
    /// p of the best fit.
    pub rate: f64,
}

/// Rates p that are tried: the first, the last, and their distance.
const RATES: (f64, f64, f64) = (0.5, 3.0, 0.02);

/// Fits the model to the values of three meshes or more; none for fewer, and where a value is not finite.
pub fn extrapolate(meshes: &[f64], values: &[f64]) -> Option<Extrapolation> {
    if meshes.len() < 3 || meshes.len() != values.len() || values.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let (first, last, step) = RATES;
    let count = ((last - first) / step).round() as usize;
    let fits = (0..=count).filter_map(|index| fit(meshes, values, first + step * index as f64));
    fits.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(fit, _)| fit)
}

/// The weighted straight line Q* + C x over x = n^(−p), and the mean square of its misfit.
fn fit(meshes: &[f64], values: &[f64], rate: f64) -> Option<(Extrapolation, f64)> {
    let points: Vec<[f64; 3]> = meshes.iter().zip(values).map(|(n, &q)| [n * n, n.powf(-rate), q]).collect();
    let (slope, limit) = line(&points)?;
    let weight: f64 = points.iter().map(|[w, _, _]| w).sum();
    let misfit = points.iter().map(|[w, x, q]| w * (q - limit - slope * x).powi(2)).sum::<f64>() / weight;
    Some((Extrapolation { limit, rate }, misfit))
}

/// Slope and intercept of the line of least squares through points (weight, x, y); none if all x are equal.
fn line(points: &[[f64; 3]]) -> Option<(f64, f64)> {
    let weight: f64 = points.iter().map(|[w, _, _]| w).sum();
    let mean = |axis: usize| points.iter().map(|point| point[0] * point[axis]).sum::<f64>() / weight;
    let (x, y) = (mean(1), mean(2));
    let square: f64 = points.iter().map(|point| point[0] * (point[1] - x).powi(2)).sum();
    let product: f64 = points.iter().map(|point| point[0] * (point[1] - x) * (point[2] - y)).sum();
    let slope = product / square;
    (square > 0.0).then_some((slope, y - slope * x))
}

/// Exponent p of the power law y = C x^p of least squares in logarithms; none for fewer than two places x.
pub fn exponent(points: impl Iterator<Item = [f64; 2]>) -> Option<f64> {
    let logs: Vec<[f64; 3]> = points.map(|[x, y]| [1.0, x.ln(), y.ln()]).collect();
    line(&logs).map(|(slope, _)| slope)
}

/// log(e₁/e₂)/log(n₂/n₁); none where an error is zero.
pub fn observed(meshes: [f64; 2], errors: [f64; 2]) -> Option<f64> {
    let rate = (errors[0] / errors[1]).ln() / (meshes[1] / meshes[0]).ln();
    Some(rate).filter(|rate| rate.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limit_and_rate_of_a_known_sequence() {
        let meshes = [6.0, 8.0, 12.0, 16.0, 24.0];
        let values = meshes.map(|n: f64| 3.0 - 5.0 * n.powf(-1.5));
        let found = extrapolate(&meshes, &values).expect("five meshes");
        assert!((found.limit - 3.0).abs() < 1e-9 && (found.rate - 1.5).abs() < 1e-9);
        assert!(extrapolate(&meshes[..2], &values[..2]).is_none());
        let powers = [1.0_f64, 3.0, 10.0, 50.0].map(|x| [x, 7.0 * x.powf(1.25)]);
        assert!((exponent(powers.into_iter()).expect("four points") - 1.25).abs() < 1e-12);
        assert_eq!(exponent([[2.0, 3.0]].into_iter()), None);
        let rate = observed([6.0, 12.0], [4.0, 1.0]).expect("positive errors");
        assert!((rate - 2.0).abs() < 1e-12);
    }
}
