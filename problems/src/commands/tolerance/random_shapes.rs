//! Random form errors of an amplitude: amplitudes of waves with normal distribution, scaled to the largest deviation.

use contact::equilibrium::ContactProblem;
use nonsmooth::Vector;
use nonsmooth::verify::seeded_direction;
use rayon::prelude::*;
use std::f64::consts::PI;

/// The amplitudes of the waves of so many shapes, of which no node of any deviates by more than `amplitude`, and one
/// does by that. They depend on the seed alone.
pub fn random_shapes(problem: &ContactProblem, amplitude: f64, (count, seed): (usize, u64)) -> Vec<Vector> {
    let waves = problem.map.control_count();
    let uniform = seeded_direction(2 * waves * count, seed);
    let nominal = problem.map.positions(&vec![0.0; waves]);
    let shape = |index: usize| {
        let own = &uniform.as_slice()[2 * waves * index..2 * waves * (index + 1)];
        let normal = Vector::from_iterator(waves, own.chunks_exact(2).map(|pair| normal([pair[0], pair[1]])));
        let moved = problem.map.positions(normal.as_slice());
        let nodes = nominal.iter().zip(&moved).flat_map(|(from, to)| from.iter().zip(to.iter()));
        let deviation = |(from, to): (&[f64; 3], &[f64; 3])| (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum();
        let largest = nodes.map(deviation).fold(0.0, f64::max).sqrt();
        normal * (amplitude / largest)
    };
    (0..count).into_par_iter().map(shape).collect()
}

/// A number of normal distribution from two that are uniform in (−1, 1): the transformation of Box and Muller.
fn normal([first, second]: [f64; 2]) -> f64 {
    (-2.0 * (0.5 * (1.0 + first)).ln()).sqrt() * (PI * second).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_moments_of_the_normal_distribution() {
        let count = 20_000;
        let uniform = seeded_direction(2 * count, 3);
        let all: Vec<f64> = uniform.as_slice().chunks_exact(2).map(|pair| normal([pair[0], pair[1]])).collect();
        let moment = |power: i32| all.iter().map(|x| x.powi(power)).sum::<f64>() / count as f64;
        // Four standard deviations of the mean: of x 1, of x² √2, of x⁴ √96.
        let bound = 4.0 / (count as f64).sqrt();
        for (power, expected, deviation) in [(1, 0.0, 1.0), (2, 1.0, 2.0_f64.sqrt()), (4, 3.0, 96.0_f64.sqrt())] {
            assert!((moment(power) - expected).abs() < bound * deviation, "{}", moment(power));
        }
    }
}
