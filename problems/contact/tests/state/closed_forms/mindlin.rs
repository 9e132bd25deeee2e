//! Cattaneo and Mindlin: a sphere pressed by P onto a block of the same material and pushed along by Q < 𝓕P slips
//! outside a circle of radius c.
//!
//! ```text
//! c/a = (1 − Q/(𝓕P))^(1/3) = k,    Σ|λ_T| r² / Σ|λ_T|  :  Σλ_N r² / Σλ_N  =  (1 − k⁵) : (1 − k³)
//! ```
//! Equal materials do not slip under P alone (no Dundurs coupling), so that the law in displacements gives the solution
//! of the law in velocities.

use super::setting::{ALL, SECOND, THIRD, block, load, pressures, solve, support, torn};
use crate::common::{length, set_upper_block};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::SolverKind;
use contact::equilibrium::ContactStatus;
use contact::scene::{CounterSurface, Scene};

const SIDE: f64 = 10.0;
const FRICTION: f64 = 0.3;

fn pushed(bricks: usize, traction: f64) -> Scene {
    let material = Material::new(1.0e4, 0.3).unwrap();
    let sphere = CounterSurface::Sphere { apex: SIDE - 0.15, radius: 100.0, centre: [SIDE, 0.0] };
    let scene = block([2.0 * SIDE, SIDE], SIDE, [2 * bricks, bricks, bricks], material, sphere);
    let mut scene = torn(scene, [4, 2, 2]).with_friction(FRICTION);
    let symmetry = support(BlockFace::X2Min, SECOND);
    scene.bodies[0].supports = vec![symmetry.clone(), support(BlockFace::Bottom, ALL)];
    let supports = vec![symmetry, support(BlockFace::Top, THIRD)];
    let loads = vec![load(BlockFace::Top, [traction, 0.0, 0.0])];
    set_upper_block(&mut scene, 2.0 * SIDE, material, supports, loads);
    scene
}

struct Measured {
    expected: f64,
    by_moment: f64,
    by_status: f64,
    resolution: f64,
}

fn measure(bricks: usize, traction: f64) -> Measured {
    let (shape, state) = solve(&pushed(bricks, traction), SolverKind::Newton);
    let nodes = pressures(&shape, &state);
    let (mut normal, mut tangential) = ([0.0; 2], [0.0; 2]);
    let (mut push, mut stick) = (0.0, 0.0);
    for (index, ([x, y], area, force)) in nodes.iter().enumerate() {
        let square = (x - SIDE).powi(2) + y * y;
        let traction = state.forces.tangential[index];
        let along = length(traction);
        push += traction[0];
        for (sums, value) in [(&mut normal, *force), (&mut tangential, along)] {
            sums[0] += value;
            sums[1] += value * square;
        }
        if state.forces.status[index] == ContactStatus::Stick {
            stick += area;
        }
    }
    let radius = (2.5 * normal[1] / normal[0]).sqrt();
    let expected = (1.0 - push.abs() / (FRICTION * normal[0])).cbrt();
    let ratio = tangential[1] / tangential[0] * normal[0] / normal[1];
    Measured {
        expected,
        by_moment: invert(ratio),
        by_status: (2.0 * stick / std::f64::consts::PI).sqrt() / radius,
        resolution: radius * bricks as f64 / SIDE,
    }
}

/// k with (1 − k⁵)/(1 − k³) = ratio.
fn invert(ratio: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0 - 1e-9);
    for _bisection in 0..60 {
        let k: f64 = 0.5 * (low + high);
        if (1.0 - k.powi(5)) / (1.0 - k.powi(3)) < ratio { low = k } else { high = k }
    }
    0.5 * (low + high)
}

#[test]
fn stick_radius() {
    for traction in [2.0, 3.0] {
        let mut errors = Vec::new();
        for bricks in [6, 14] {
            let found = measure(bricks, traction);
            println!(
                "Cattaneo–Mindlin, a = {:.2} bricks: c/a {:.4} expected, {:.4} by moments, {:.4} by status",
                found.resolution, found.expected, found.by_moment, found.by_status
            );
            // The status of a node stands for a ring as wide as a brick.
            assert!((found.by_status - found.expected).abs() < 0.5 / found.resolution);
            errors.push((found.by_moment - found.expected).abs());
        }
        assert!(errors[1] < 0.02, "{errors:?}");
    }
}
