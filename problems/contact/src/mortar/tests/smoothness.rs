//! Slopes of the weights while the master slides over the slave.

use super::super::Along;
use super::super::derivative::NodeChange;
use super::surface::{Surface, mortar};

/// Derivatives of all weights (a dense matrix, so that zero entries may come and go) and areas along the slide.
fn slopes(slave: &Surface, master: &Surface, direction: [f64; 3], along: Along) -> Vec<f64> {
    let coupled = mortar(slave, master, along);
    let changes: Vec<NodeChange> = coupled.changes(&|side, _| if side == 1 { direction } else { [0.0; 3] });
    let width = master.positions.len() + 1;
    let mut dense = vec![0.0; coupled.nodes.len() * width];
    for (row, (node, change)) in coupled.nodes.iter().zip(&changes).enumerate() {
        dense[row * width] = change.area;
        for (&(column, _), &weight) in node.weights.iter().zip(&change.weights) {
            dense[row * width + 1 + column as usize] = weight;
        }
    }
    dense
}

/// The largest jump of a slope between s − ε and s + ε for the given s, in parts of the largest slope. The slope
/// itself changes by O(ε).
fn largest_jump(surfaces: [&Surface; 2], direction: [f64; 3], places: &[f64], epsilon: f64, along: Along) -> f64 {
    let at = |s: f64| slopes(surfaces[0], &surfaces[1].clone().shifted(direction.map(|c| c * s)), direction, along);
    let mut worst = 0.0_f64;
    for &place in places {
        let (before, on, after) = (at(place - epsilon), at(place), at(place + epsilon));
        let size = before.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for ((a, b), c) in before.iter().zip(&on).zip(&after) {
            worst = worst.max((a - b).abs().max((b - c).abs()) / size);
        }
    }
    worst
}

/// The master covers the slave during the whole slide.
fn wide(n: usize) -> Surface {
    Surface::grid([n, n], [-1.0, 2.0, -1.0, 2.0], 0.0, false)
}

#[test]
fn slopes_are_continuous_where_edges_of_regular_grids_pass_each_other() {
    // Edges of the master (9 on 3 units, spacing 1/3) meet those of the slave (spacing 1/4) at multiples of 1/12.
    let places: Vec<f64> = (-4..5).map(|k| f64::from(k) / 12.0).collect();
    let slave = Surface::unit(4, 0.0, true);
    for master in [wide(9), wide(12)] {
        for direction in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 0.5, 0.0]] {
            for along in [Along::X3, Along::Normals] {
                let jump = largest_jump([&slave, &master], direction, &places, 1e-8, along);
                assert!(jump < 1e-6, "{direction:?} {along:?}: {jump:e}");
            }
        }
    }
}

#[test]
fn slopes_are_continuous_on_distorted_grids() {
    let slave = Surface::unit(4, 0.0, true).distorted(0.05, 3);
    let noise = |k: usize| super::surface::noise(k) / 15.0;
    let master = wide(9).moved(|k, x| [x[0] + noise(70 + 2 * k), x[1] + noise(71 + 2 * k), x[2]]);
    let direction = [1.0, 0.3, 0.0];
    let at = |s: f64| slopes(&slave, &master.clone().shifted(direction.map(|c| c * s)), direction, Along::X3);
    let step = 0.4 / 600.0;
    let all: Vec<Vec<f64>> = (0..600).map(|k| at(step * f64::from(k))).collect();
    let size = all.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    // The largest second differences show where slopes may jump; some of them belong to kinks of the slope.
    let second = |k: usize, entry: usize| (all[k - 2][entry] - 2.0 * all[k - 1][entry] + all[k][entry]).abs();
    let largest = |k: usize| {
        let entries = (0..all[k].len()).max_by(|&a, &b| second(k, a).total_cmp(&second(k, b)));
        entries.map_or((0.0, k, 0), |entry| (second(k, entry), k, entry))
    };
    let mut suspects: Vec<(f64, usize, usize)> = (2..600).map(largest).collect();
    suspects.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut worst = 0.0_f64;
    for &(_, k, entry) in &suspects[..20] {
        let [mut low, mut high] = [k - 2, k].map(|k| step * k as f64);
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            let [a, b, c] = [low, middle, high].map(|s| at(s)[entry]);
            if (a - b).abs() > (b - c).abs() {
                high = middle;
            } else {
                low = middle;
            }
        }
        worst = worst.max((at(high)[entry] - at(low)[entry]).abs() / size);
    }
    println!("distorted: largest jump of a slope over 1e-9: {worst:.1e} of the largest slope");
    assert!(worst < 1e-6);
}
