//! A rigid flat strip punch of half-width a on an elastic half-plane (plane strain, half of a symmetric block).
//!
//! ```text
//! p(x) = P/(π √(a² − x²)),    ∫ p x² / ∫ p = a²/2
//! ```

use super::setting::{FIRST, SECOND, THIRD, block, pressures, solve, support};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::SolverKind;
use contact::scene::{CounterSurface, Scene};
use std::f64::consts::PI;

const HALF_WIDTH: f64 = 1.0;
const SIDE: f64 = 8.0;
const THICKNESS: f64 = 0.5;

fn punched(bricks: usize) -> Scene {
    let material = Material::new(1.0e4, 0.3).unwrap();
    let punch = CounterSurface::Punch { height: SIDE - 0.01, half_width: HALF_WIDTH, relief: 1.0, centre: 0.0 };
    let mut scene = block([SIDE, THICKNESS], SIDE, [bricks, 1, bricks], material, punch);
    scene.bodies[0].supports = vec![
        support(BlockFace::X1Min, FIRST),
        support(BlockFace::X2Min, SECOND),
        support(BlockFace::X2Max, SECOND),
        support(BlockFace::Bottom, THIRD),
    ];
    scene
}

/// Relative errors of the pressure under the centre and of the second moment.
fn measure(bricks: usize) -> (f64, f64) {
    let (shape, state) = solve(&punched(bricks), SolverKind::Direct);
    let nodes = pressures(&shape, &state);
    let half: f64 = nodes.iter().map(|node| node.2).sum();
    let centre = nodes[0].2 / nodes[0].1;
    let moment: f64 = nodes.iter().map(|([x, _], _, force)| force * x * x).sum();
    let exact = 2.0 * half / THICKNESS / (PI * HALF_WIDTH);
    (centre / exact - 1.0, moment / half / (0.5 * HALF_WIDTH * HALF_WIDTH) - 1.0)
}

#[test]
fn pressure_and_moment() {
    let found = [16, 32, 64, 128].map(measure);
    for ((pressure, moment), bricks) in found.iter().zip([2, 4, 8, 16]) {
        println!(
            "flat punch, a = {bricks} bricks: p(0) off by {:.2} %, second moment by {:.2} %",
            100.0 * pressure,
            100.0 * moment
        );
    }
    let rate = |first: f64, last: f64| (first / last).log2() / 3.0;
    let rates = [rate(found[0].0, found[3].0), rate(found[0].1, found[3].1)];
    println!("rates {:.2} and {:.2}", rates[0], rates[1]);
    assert!(found[3].0.abs() < 0.02 && found[3].1.abs() < 0.04, "{found:?}");
    assert!(rates.iter().all(|rate| *rate > 0.9), "{rates:?}");
}
