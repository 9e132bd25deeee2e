//! Pairs of bodies at random: tilted, partly overlapping, grids from 1 : 1 to 1 : 8. Both solvers agree, and the forces
//! on every body are in equilibrium. `PAIRS` sets the number of pairs.

use crate::grid::{KINDS, Point, mesh};
use crate::setting::{body, lattice, pair};
use contact::contact_shape::{ContactShape, SolverKind};
use contact::equilibrium::ContactStatus;
use contact::scene::{Geometry, Held, NormalKind, Scene, Support};
use nonsmooth::{Accuracy, StateSolver, Vector};

/// Numbers as good as at random, the same each time.
struct Numbers(u64);

impl Numbers {
    /// A number between two others.
    fn between(&mut self, least: f64, most: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        least + (most - least) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }
}

/// A rotation by small angles about x₁ and x₂, about a point.
fn tilted([a, b]: [f64; 2], centre: Point, x: Point) -> Point {
    let y: Point = std::array::from_fn(|axis| x[axis] - centre[axis]);
    let z = [y[0], a.cos() * y[1] - a.sin() * y[2], a.sin() * y[1] + a.cos() * y[2]];
    let turned = [b.cos() * z[0] + b.sin() * z[2], z[1], b.cos() * z[2] - b.sin() * z[0]];
    std::array::from_fn(|axis| turned[axis] + centre[axis])
}

/// A body that is held below and one that is pressed into it, tilted and moved aside.
fn scene(seed: u64) -> Scene {
    let mut n = Numbers(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(7));
    (0..5).for_each(|_| {
        n.between(0.0, 1.0);
    });
    let kinds = [KINDS[n.below(2)], KINDS[n.below(2)]];
    let coarse = 1 + n.below(2);
    let fine = (coarse * (1 + n.below(8))).min(9);
    let counts = if n.below(2) == 0 { [coarse, fine] } else { [fine, coarse] };
    let angles = [n.between(-0.3, 0.3), n.between(-0.3, 0.3)];
    let aside = [n.between(-5.0, 5.0), n.between(-5.0, 5.0)];
    let (curvature, distortion) = (n.between(-0.01, 0.03), n.between(0.0, 0.2));
    let below = |[s, t, r]: Point| [10.0 * s, 10.0 * t, 5.0 * r];
    let above = |[s, t, r]: Point| {
        let [x1, x2] = [2.0 + 6.0 * s, 2.0 + 7.0 * t];
        let height = 5.0 + curvature * ((x1 - 5.0).powi(2) + (x2 - 5.5).powi(2));
        let x = [x1, x2, height + r * (10.0 - height)];
        let [y1, y2, y3] = tilted(angles, [5.0, 5.5, 5.0], x);
        [y1 + aside[0], y2 + aside[1], y3]
    };
    let layers = [1 + n.below(2), 1 + n.below(2)];
    let boxes = |body: usize| [counts[body], counts[body], layers[body]];
    let mut lower = body("lower", mesh(kinds[0], boxes(0), distortion, below), [1000.0, 0.3]);
    let mut upper = body("upper", mesh(kinds[1], boxes(1), distortion, above), [n.between(300.0, 5000.0), 0.25]);
    lower.shape = lattice([0.0; 3], [10.0, 10.0, 5.0], [true; 3]);
    lower.supports = vec![Support::new("bottom", [true; 3])];
    let held = Held::Components([Some(0.0), Some(0.0), Some(-n.between(0.05, 0.4))]);
    upper.supports = vec![Support { face: "top".into(), held }];
    let friction = [0.0, 0.3][n.below(2)];
    let mut scene = pair(vec![lower, upper], n.below(2), friction);
    scene.contacts[0].normal = [NormalKind::Surface, NormalKind::X3][n.below(2)];
    for body in &mut scene.bodies {
        if let Geometry::Mesh(geometry) = &mut body.geometry {
            geometry.pieces = Some(1 + n.below(4));
        }
    }
    scene
}

/// What is wrong with the states of a scene; none where bodies miss each other, which is refused.
fn wrong(scene: &Scene) -> Result<bool, String> {
    let at = Vector::from_fn(scene.control_count(), |k, _| 0.02 * (2.0 * k as f64 + 1.0).cos());
    let mut found = Vec::new();
    for kind in [SolverKind::Direct, SolverKind::Newton] {
        let shape = match ContactShape::new(scene.clone(), kind) {
            Ok(shape) => shape,
            Err(error) if error.to_string().contains("opposite to each other") => return Ok(false),
            Err(error) => return Err(format!("{kind:?}: {error}")),
        };
        let state = shape.solve(&at, None, Accuracy::TIGHTEST).map_err(|error| format!("{kind:?}: {error}"))?;
        // Forces of 1 N are small beside those that bend these bodies: where they miss each other, all is rounding.
        let load = state.forces.total_normal_force().max(1.0);
        for body in shape.resultants(&state).unwrap().bodies {
            let off = body.imbalance().iter().fold(0.0, |off: f64, force| off.max(force.abs()));
            let contact = body.contact.iter().fold(0.0, |size: f64, force| size.max(force.abs()));
            if off > 1e-7 * contact.max(load) {
                return Err(format!("{kind:?}: {} is out of balance by {off:e} of {contact:e}", body.body));
            }
        }
        let closed = state.forces.status.iter().filter(|status| **status != ContactStatus::Open).count();
        let displacement: Vec<[f64; 3]> =
            shape.bodies(&state).unwrap().into_iter().flat_map(|body| body.displacement).collect();
        found.push((displacement, closed));
    }
    let size = found[0].0.iter().flatten().fold(0.0, |size: f64, u| size.max(u.abs()));
    let pairs = found[0].0.iter().flatten().zip(found[1].0.iter().flatten());
    let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if off > 1e-7 * size {
        return Err(format!("solvers differ by {:e}", off / size));
    }
    Ok(found[0].1 > 0)
}

#[test]
fn random_pairs_have_states_that_both_solvers_agree_on() {
    let count: u64 = std::env::var("PAIRS").ok().and_then(|text| text.parse().ok()).unwrap_or(40);
    let (mut touching, mut failures) = (0, Vec::new());
    for seed in 0..count {
        match wrong(&scene(seed)) {
            Ok(touches) => touching += u64::from(touches),
            Err(reason) => failures.push(format!("{seed}: {reason}")),
        }
    }
    println!("{touching} of {count} pairs touch; wrong: {failures:?}");
    assert!(failures.is_empty(), "{failures:?}");
    assert!(2 * touching > count, "{touching} of {count}");
}
