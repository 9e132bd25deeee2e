//! Hertz: a rigid sphere on an elastic half-space, here a quarter of a block three and a half contact radii wide.
//!
//! ```text
//! a³ = 3PR/(4E*),   p₀ = 3P/(2πa²),   E* = E/(1 − ν²),   ∫ p r² / ∫ p = 2a²/5
//! ```
//! P is the resultant of the computed forces, so that the depth of the block does not matter much.

use super::setting::{FIRST, SECOND, THIRD, block, pressures, solve, support, torn};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::SolverKind;
use contact::scene::{CounterSurface, Scene};
use std::f64::consts::PI;

const SIDE: f64 = 10.0;
const RADIUS: f64 = 100.0;
const MODULUS: f64 = 1.0e4;
const POISSON: f64 = 0.3;

fn indented(bricks: usize, depth: f64) -> Scene {
    let material = Material::new(MODULUS, POISSON).unwrap();
    let sphere = CounterSurface::Sphere { apex: SIDE - depth, radius: RADIUS, centre: [0.0; 2] };
    let mut scene = torn(block([SIDE, SIDE], SIDE, [bricks; 3], material, sphere), [2; 3]);
    scene.bodies[0].supports =
        vec![support(BlockFace::X1Min, FIRST), support(BlockFace::X2Min, SECOND), support(BlockFace::Bottom, THIRD)];
    scene
}

/// Relative errors of p₀ and of a (by the second moment), a in bricks.
fn measure(bricks: usize) -> (f64, f64, f64) {
    let (shape, state) = solve(&indented(bricks, 0.06), SolverKind::Newton);
    let nodes = pressures(&shape, &state);
    let quarter: f64 = nodes.iter().map(|node| node.2).sum();
    let contact_modulus = MODULUS / (1.0 - POISSON * POISSON);
    let a = (3.0 * 4.0 * quarter * RADIUS / (4.0 * contact_modulus)).cbrt();
    let p0 = 3.0 * 4.0 * quarter / (2.0 * PI * a * a);
    let moment: f64 = nodes.iter().map(|([x, y], _, force)| force * (x * x + y * y)).sum();
    let radius = (2.5 * moment / quarter).sqrt();
    let peak = nodes[0].2 / nodes[0].1;
    (peak / p0 - 1.0, radius / a - 1.0, a * bricks as f64 / SIDE)
}

#[test]
fn peak_pressure_and_contact_radius() {
    let mut found = Vec::new();
    for bricks in [8, 16, 20] {
        let (pressure, radius, resolution) = measure(bricks);
        println!(
            "Hertz, {bricks}³ bricks, a = {resolution:.2} bricks: p₀ off by {:.2} %, a by {:.2} %",
            100.0 * pressure,
            100.0 * radius
        );
        found.push((pressure.abs(), radius.abs(), resolution));
    }
    let (first, last) = (found[0], found[found.len() - 1]);
    let rate = (first.1 / last.1).ln() / (last.2 / first.2).ln();
    println!("rate of the error of a: {rate:.2}");
    // Found: 0.16 %, 0.46 % and 2.4. Most of what is left of p₀'s error is the distance of a block to a half-space.
    assert!(last.0 < 0.0018 && last.1 < 0.005, "{found:?}");
    assert!(rate > 2.2, "{rate:.2}: {found:?}");
}
