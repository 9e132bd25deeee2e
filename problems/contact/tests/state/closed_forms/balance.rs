//! What every state must satisfy, whatever the mesh: balance, complementarity, friction cone, dissipation.

use super::setting::{ALL, block, load, places, solve, support, torn};
use crate::common::{change_counter_surface, length, set_upper_block};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::scene::{CounterSurface, Scene, hertz, signorini};
use nonsmooth::{Accuracy, StateSolver};

fn cross(x: [f64; 3], f: [f64; 3]) -> [f64; 3] {
    [x[1] * f[2] - x[2] * f[1], x[2] * f[0] - x[0] * f[2], x[0] * f[1] - x[1] * f[0]]
}

/// Loads of the plate, MPa.
const ON_TOP: [f64; 3] = [0.05, -0.03, -1.0];
const ON_SIDE: [f64; 3] = [0.02, 0.01, -0.1];

/// A plate on a block, held by contact and friction alone.
fn plate() -> Scene {
    let material = Material::new(1.0e3, 0.3).unwrap();
    let scene = block([10.0; 2], 10.0, [4; 3], material, CounterSurface::Plane { height: 10.0 });
    let mut scene = torn(scene, [2; 3]).with_friction(0.4);
    scene.bodies[0].supports = vec![support(BlockFace::Bottom, ALL)];
    let loads = vec![load(BlockFace::Top, ON_TOP), load(BlockFace::X1Max, ON_SIDE)];
    set_upper_block(&mut scene, 20.0, material, vec![], loads);
    scene
}

#[test]
fn contact_forces_balance_the_loads_of_a_free_body() {
    let scene = plate();
    // Both loaded faces measure 100 mm².
    let resultants = [([5.0, 5.0, 20.0], ON_TOP), ([10.0, 5.0, 15.0], ON_SIDE)];
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let (shape, state) = solve(&scene, kind);
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        let mut add = |x: [f64; 3], f: [f64; 3]| {
            let turning = cross(x, f);
            (0..3).for_each(|axis| force[axis] += f[axis]);
            (0..3).for_each(|axis| moment[axis] += turning[axis]);
        };
        for (x, traction) in resultants {
            add(x, traction.map(|t| 100.0 * t));
        }
        for (index, place) in places(&shape).into_iter().enumerate() {
            let [t1, t2, t3] = state.forces.tangential[index];
            add(place, [t1, t2, t3 + state.forces.normal[index]]);
        }
        let worst =
            |values: [f64; 3], scale: f64| values.into_iter().map(|value| value.abs() / scale).fold(0.0, f64::max);
        let (forces, moments) = (worst(force, 110.0), worst(moment, 110.0 * 10.0));
        println!("balance, {kind:?}: forces {forces:.1e}, moments {moments:.1e} of the load");
        assert!(forces < 1e-11 && moments < 1e-11, "{kind:?} {forces:.1e} {moments:.1e}");
    }
}

#[test]
fn complementarity_cone_and_dissipation_at_every_node() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        let scene = scene.with_bricks([6; 3], [2; 3]);
        for kind in [SolverKind::Newton, SolverKind::Direct] {
            let shape = ContactShape::new(scene.clone(), kind).unwrap();
            let bend = nonsmooth::verify::seeded_direction(36, 3);
            let control = shape.start().zip_map(&bend, |height, bend| height * (0.99 + 0.005 * bend));
            let forces = shape.solve(&control, None, Accuracy::TIGHTEST).unwrap().forces;
            let largest = |values: &[f64]| values.iter().map(|value| value.abs()).fold(0.0, f64::max);
            let (force, gap) = (largest(&forces.normal), largest(&forces.opening));
            let slip = forces.slip.iter().map(|slip| length(*slip)).fold(0.0, f64::max);
            let (mut complementarity, mut cone, mut dissipated, mut least) = (0.0_f64, 0.0_f64, 0.0, 0.0_f64);
            for (index, &normal) in forces.normal.iter().enumerate() {
                assert!(normal >= -1e-11 * force && forces.opening[index] <= 1e-10 * gap);
                complementarity = complementarity.max((normal * forces.opening[index]).abs() / (force * gap));
                let (tangential, jump) = (forces.tangential[index], forces.slip[index]);
                cone = cone.max((length(tangential) - scene.friction() * normal) / force);
                let power: f64 = tangential.iter().zip(jump).map(|(force, slip)| force * slip).sum();
                least = least.min(power / (force * slip));
                dissipated += power;
            }
            println!(
                "{} {kind:?}: complementarity {complementarity:.1e}, cone {cone:.1e}, least dissipation {least:.1e}",
                scene.name
            );
            assert!(complementarity < 1e-11 && cone < 1e-11, "{complementarity:.1e} {cone:.1e}");
            assert!(least > -1e-11 && dissipated > 0.0, "{least:.1e} {dissipated}");
        }
    }
}

#[test]
fn bodies_that_just_touch_without_a_load_have_no_forces_and_no_displacements() {
    let material = Material::new(2.1e5, 0.3).unwrap();
    // Overlaps by two roundings of the height, and a body that stands on supports alone.
    let plane = CounterSurface::Plane { height: 20.0 * (1.0 - 2.0 * f64::EPSILON) };
    let mut scene = torn(block([20.0; 2], 20.0, [4; 3], material, plane), [2; 3]).with_friction(0.3);
    scene.bodies[0].supports = vec![support(BlockFace::Bottom, ALL)];
    let kinds = [SolverKind::Auto, SolverKind::Newton, SolverKind::Direct, SolverKind::AugmentedLagrangian];
    for kind in kinds {
        let (shape, state) = solve(&scene, kind);
        let forces = &state.forces;
        assert!(forces.normal.iter().all(|force| *force == 0.0), "{kind:?}: {:?}", forces.normal);
        assert!(forces.tangential.iter().flatten().all(|force| *force == 0.0), "{kind:?}");
        assert_eq!(forces.counts().open, forces.status.len(), "{kind:?}");
        for body in shape.bodies(&state).unwrap() {
            assert!(body.displacement.iter().flatten().all(|component| *component == 0.0), "{kind:?}");
        }
    }
    // An overlap of a nanometre is one that the bodies feel: uniform compression between plane and support.
    change_counter_surface(&mut scene, |_| CounterSurface::Plane { height: 20.0 - 1e-6 });
    for kind in kinds {
        let (_, state) = solve(&scene, kind);
        let force = state.forces.total_normal_force();
        let bar = 2.1e5 * 400.0 * 1e-6 / 20.0;
        assert!(force > bar && force < 1.35 * bar, "{kind:?}: {force} N, a bar {bar} N");
    }
}
