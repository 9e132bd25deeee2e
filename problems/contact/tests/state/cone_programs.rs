//! The last resort of direct condensation, driven alone: cone programs lead to the states that Newton's method finds.

use crate::common::{change_counter_surface, start_height};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::direct::{DirectSolver, by_cone_programs};
use contact::equilibrium::{ContactProblem, ContactRows};
use contact::scene::{CounterSurface, Load, Scene, hertz, signorini};
use contact::shape::{LatticeShape, ShapedFace};
use std::sync::Arc;
use testset::kit::wavy;

/// Steps that no scene of these tests needs.
const MANY_STEPS: usize = 10_000;

fn problem(scene: Scene, bricks: usize, friction: f64) -> Arc<ContactProblem> {
    let scene = scene.with_bricks([bricks; 3], [1; 3]).with_friction(friction);
    Arc::new(ContactProblem::new(scene).unwrap())
}

/// Σσ⁴ over the contact nodes.
fn objective(rows: &ContactRows, normal: &[f64]) -> f64 {
    rows.pressures(normal).iter().map(|pressure| pressure.max(0.0).powi(4)).sum()
}

#[test]
fn cone_programs_lead_to_the_states_of_newtons_method() {
    for (scene, name) in [(signorini().unwrap(), "signorini"), (hertz().unwrap(), "hertz")] {
        for friction in [0.0, 0.3, 1.0] {
            let problem = problem(scene.clone(), 5, friction);
            let controls = wavy(start_height(&problem.scene), 36);
            let solver = DirectSolver::new(Arc::clone(&problem)).unwrap();
            let state = solver.solve(&controls, None, 0.0).unwrap();
            let mut contact = solver.contact(&controls).unwrap();
            let found = by_cone_programs(&mut contact, 0.0, MANY_STEPS);
            let (forces, _) = contact.dimensional(found.unknowns.as_ref().unwrap());
            let expected = objective(&state.rows, &state.forces.normal);
            let normal: Vec<f64> = problem.boundary.points.iter().map(|point| forces[point.start]).collect();
            let difference = (objective(&state.rows, &normal) / expected - 1.0).abs();
            println!(
                "{name}, friction {friction}: {} programs, {} steps, {difference:.1e}",
                found.count,
                found.steps()
            );
            assert!(difference < 1e-7, "{name}, friction {friction}: {difference:.1e}");
            // Each program takes some iterations, and Newton's method some steps from the last one.
            assert!(found.count >= 1 && found.steps() > 5 * found.count, "{} {}", found.count, found.steps());
        }
    }
}

/// Without a step nothing is tried, and the problem is left as it was.
#[test]
fn cone_programs_keep_within_their_work() {
    let problem = problem(signorini().unwrap(), 4, 0.3);
    let mut contact = DirectSolver::new(problem).unwrap().contact(&[100.0; 36]).unwrap();
    let before = contact.constant().to_vec();
    for steps in [0, 3] {
        let found = by_cone_programs(&mut contact, 0.0, steps);
        assert!(found.unknowns.is_none() && found.steps() <= steps, "{}", found.steps());
        assert_eq!(contact.constant(), before);
    }
}

/// Scene 1401 of seed 3 of the random study: a thin plate that contact holds against a push. In the unit of its mean
/// compliance, which bending makes large, the continuation ended at a fold for some of 20 shapes that differ by 1e-9.
#[test]
fn continuation_finds_the_states_of_a_thin_plate() {
    let height = 1.9529823602574257;
    let size = [1.0869691108670812e1, 1.5321819622461916e-1];
    let traction = [-1.3464520863463144e-3, 4.64168935388694e-3, 1.2777216699740348e-2];
    let mut scene = signorini().unwrap().with_friction(1.5489828758814062).with_bricks([8, 4, 8], [1; 3]);
    scene = scene.with_blocks(|block| block.size = size);
    change_counter_surface(&mut scene, |_| CounterSurface::Plane { height });
    scene.bodies[0].material = Material::new(2.625089606217722e5, 4.9751755389752494e-1).unwrap();
    scene.bodies[0].loads = vec![Load::traction(BlockFace::Bottom, traction)];
    let scene = scene.with_shapes(|heights| {
        *heights = LatticeShape::heights(ShapedFace::Top, [4, 4], [3, 3], height);
    });
    let solver = DirectSolver::new(Arc::new(ContactProblem::new(scene).unwrap())).unwrap();
    for seed in 0..20 {
        let wave = |control: usize| (1.3 * control as f64 + f64::from(seed)).sin();
        let controls: Vec<f64> = (0..16).map(|control| height * (1.0 + 1e-9 * wave(control))).collect();
        let state = solver.solve(&controls, None, 1e-12).unwrap();
        assert_eq!(state.reason, None, "{seed}");
        assert!(state.forces.residuals.largest() < 1e-8, "{}", state.forces.residuals);
    }
}
