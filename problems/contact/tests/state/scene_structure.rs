//! What a scene does not need is not there; what cannot be in equilibrium is refused; certificates hold.

use crate::common::{change_counter_surface, set_top};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::equilibrium::{Configuration, ContactProblem, ContactStatus};
use contact::error::{ContactError, SceneError};
use contact::linear::vector::norm;
use contact::scene::{CounterSurface, Load, Scene, Support, hertz, signorini};
use contact::tfeti::{TornOptions, TotalFeti};
use nonsmooth::{Accuracy, StateSolver, Vector};
use std::sync::Arc;

fn small(scene: Scene, bricks: usize, subdomains: usize) -> Scene {
    scene.with_bricks([bricks; 3], [subdomains; 3])
}

#[test]
fn no_friction_means_no_tangential_multipliers() {
    let scene = small(signorini().unwrap(), 6, 2).with_friction(0.0);
    let shape = ContactShape::new(scene, SolverKind::Newton).unwrap();
    let boundary = &shape.problem().boundary;
    assert_eq!(boundary.row_count, boundary.points.len());
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    assert!(state.forces.tangential.is_empty() && state.forces.slip.is_empty());
    assert!(shape.left_out().iter().any(|text| text.contains("tangential")));
}

#[test]
fn one_subdomain_means_no_gluing_and_more_mean_the_known_rows() {
    let problem = Arc::new(ContactProblem::new(small(signorini().unwrap(), 6, 1)).unwrap());
    let whole = TotalFeti::new(Arc::clone(&problem), TornOptions::default()).unwrap();
    assert_eq!(whole.model().constraints.gluing_count, 0);
    // Two components of the 7 × 7 nodes on x₁ = 0.
    assert_eq!(whole.model().constraints.equality_count, 98);
    let problem = Arc::new(ContactProblem::new(small(signorini().unwrap(), 12, 2)).unwrap());
    let torn = TotalFeti::new(Arc::clone(&problem), TornOptions::default()).unwrap();
    assert_eq!(torn.sizes()[0], 8232);
    assert_eq!(torn.model().constraints.equality_count, 1979);
}

#[test]
fn rows_are_orthonormal_and_weights_invert_them() {
    let problem = Arc::new(ContactProblem::new(small(hertz().unwrap(), 4, 2)).unwrap());
    let solver = TotalFeti::new(Arc::clone(&problem), TornOptions::default()).unwrap();
    let system = solver.model().factorize(&Configuration::new(&problem, &[9.9; 36]).unwrap()).unwrap();
    let dense = |row: usize, weighted: bool| {
        let mut values = vec![0.0; solver.sizes()[0]];
        let source = if weighted { &system.rows.weighted } else { &system.rows.rows };
        source.row(row).for_each(|(dof, value)| values[dof] += value);
        values
    };
    let count = solver.model().constraints.row_count();
    for row in 0..count {
        let left = dense(row, false);
        assert!((norm(&left) - 1.0).abs() < 1e-14);
        for other in 0..count {
            let product: f64 = left.iter().zip(dense(other, true)).map(|(a, b)| a * b).sum();
            let expected = f64::from(u8::from(row == other));
            assert!((product - expected).abs() < 1e-14, "rows {row}, {other}: {product}");
        }
    }
}

#[test]
fn rigid_modes_are_the_kernel_and_the_inverse_is_a_generalised_one() {
    let problem = Arc::new(ContactProblem::new(small(signorini().unwrap(), 6, 2)).unwrap());
    let solver = TotalFeti::new(Arc::clone(&problem), TornOptions::default()).unwrap();
    let system = solver.model().factorize(&Configuration::new(&problem, &[99.0; 36]).unwrap()).unwrap();
    for (index, factors) in system.parts.iter().enumerate() {
        let pattern = &solver.model().piece(index).1.pattern.lower;
        let size = pattern.dimension();
        let scale = factors.stiffness.iter().map(|value| value.abs()).fold(0.0, f64::max);
        let mut image = vec![0.0; size];
        for mode in &factors.modes {
            pattern.multiply(&factors.stiffness, mode, &mut image);
            assert!(norm(&image) < 1e-12 * scale, "{}", norm(&image) / scale);
        }
        let probe: Vec<f64> = (0..size).map(|i| (0.37 * i as f64).sin()).collect();
        pattern.multiply(&factors.stiffness, &probe, &mut image);
        let mut solution = image.clone();
        factors.inverse.solve_in_place(&mut solution);
        let mut again = vec![0.0; size];
        pattern.multiply(&factors.stiffness, &solution, &mut again);
        let difference: Vec<f64> = again.iter().zip(&image).map(|(a, b)| a - b).collect();
        assert!(norm(&difference) < 1e-12 * norm(&image), "{}", norm(&difference) / norm(&image));
    }
}

#[test]
fn unchanged_body_is_factored_once() {
    let scene = small(hertz().unwrap(), 4, 2);
    for (kind, first, later) in [(SolverKind::Newton, 32, 16), (SolverKind::Direct, 2, 1)] {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let counts = [0.0, 0.01].map(|shift| {
            let control = shape.start().map(|height| height - shift);
            shape.solve(&control, None, Accuracy::TIGHTEST).unwrap().work().factorizations
        });
        assert_eq!(counts, [first, later], "{kind:?}");
    }
}

#[test]
fn a_load_that_pulls_away_is_refused_naming_the_direction() {
    let mut scene = small(signorini().unwrap(), 4, 2);
    scene.bodies[0].loads[0] = scene.bodies[0].loads[0].scaled(-1.0);
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let error = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap_err().to_string();
        assert!(error.contains("no equilibrium") && error.contains("translation along x3"), "{error}");
        assert!(error.contains("3.0000"), "{error}");
    }
}

/// Two blocks of equal size, the upper one pressed onto the lower, whose base is fixed. Contact holds the upper one.
fn plates(friction: f64, push: f64) -> Scene {
    let material = Material::new(1000.0, 0.0).unwrap();
    let mut scene = small(hertz().unwrap(), 4, 2).with_friction(friction);
    change_counter_surface(&mut scene, |_| CounterSurface::Plane { height: 10.0 });
    let supports = [vec![Support::new(BlockFace::Bottom, [true; 3])], vec![]];
    let loads = [vec![], vec![Load::traction(BlockFace::Top, [push, 0.0, -1.0])]];
    for (body, (supports, loads)) in scene.bodies.iter_mut().zip(supports.into_iter().zip(loads)) {
        (body.material, body.supports, body.loads) = (material, supports, loads);
    }
    scene
}

#[test]
fn friction_carries_a_push_below_its_limit_only() {
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let shape = ContactShape::new(plates(0.3, 0.05), kind).unwrap();
        let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
        assert!((state.forces.total_normal_force() - 100.0).abs() < 1e-7);
        let push: f64 = state.forces.tangential.iter().map(|force| force[0]).sum();
        assert!((push + 5.0).abs() < 1e-7, "{push}");
        let shape = ContactShape::new(plates(0.3, 0.3003), kind).unwrap();
        let error = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap_err().to_string();
        assert!(error.contains("no equilibrium") && error.contains("translation along x1"), "{error}");
    }
}

#[test]
fn unloaded_free_motions_are_grounded() {
    // Without friction nothing holds the upper plate's translations and its rotation about x₃; no load drives them.
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let shape = ContactShape::new(plates(0.0, 0.0), kind).unwrap();
        let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
        for pressure in state.rows.pressures(&state.forces.normal) {
            assert!((pressure - 1.0).abs() < 1e-9, "{pressure}");
        }
        let shape = ContactShape::new(plates(0.0, 0.01), kind).unwrap();
        assert!(shape.solve(&shape.start(), None, Accuracy::TIGHTEST).is_err());
    }
}

/// Supports hold the motions that contact holds as well, and leave two free, unloaded and grounded.
#[test]
fn motions_that_neither_supports_nor_contact_hold_are_grounded() {
    for (bricks, subdomains) in [([3; 3], 1), ([4, 4, 2], 2)] {
        let mut scene = signorini().unwrap().with_bricks(bricks, [subdomains; 3]).with_friction(0.0);
        scene.bodies[0].supports = vec![
            Support::new(BlockFace::Bottom, [false, false, true]),
            Support::new(BlockFace::X2Min, [true, false, false]),
        ];
        scene.bodies[0].loads = vec![Load::traction(BlockFace::X1Min, [0.0, 0.0, 3000.0])];
        change_counter_surface(&mut scene, |_| CounterSurface::Plane { height: 100.001 });
        let force = |kind| {
            let shape = ContactShape::new(scene.clone(), kind).unwrap();
            shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap().forces.total_normal_force()
        };
        let direct = force(SolverKind::Direct);
        for kind in [SolverKind::Newton, SolverKind::AugmentedLagrangian] {
            let torn = force(kind);
            assert!((torn / direct - 1.0).abs() < 1e-8, "{bricks:?} {kind:?}: {torn} {direct}");
        }
    }
}

/// Blocks that only friction between them holds, pulled by forces in balance, whatever the gap between them.
#[test]
fn forces_in_balance_are_never_refused() {
    for index in 0..24 {
        let scene = small(hertz().unwrap(), 3, 1).with_blocks(|blocks| blocks.size = [1.0; 2]);
        let mut scene = scene.with_shapes(|heights| {
            (heights.start, heights.thickness, heights.volume) = (1.0, Some(0.5), Some([0.0, 10.0]));
        });
        let gap = 1e-6 * 10.0_f64.powf(f64::from(index) / 6.0);
        change_counter_surface(&mut scene, |_| CounterSurface::Plane { height: 1.0 + gap });
        scene.bodies[0].supports.clear();
        scene.bodies[0].loads = vec![Load::traction(BlockFace::Bottom, [0.0, 0.0, 1.0])];
        scene.bodies[1].supports.clear();
        scene.bodies[1].loads = vec![Load::traction(BlockFace::Top, [0.0, 0.0, -1.0])];
        set_top(&mut scene, 2.0 + gap);
        let problem = ContactProblem::new(scene).unwrap();
        if let Err(error) = Configuration::new(&problem, &[1.0; 36]) {
            panic!("gap {gap:e}: {error}");
        }
    }
}

/// A free block that is pushed with nearly as much as friction can hold: the projection onto the cone of contact forces
/// converges slowly there.
#[test]
fn statics_refuse_what_is_beyond_friction_alone() {
    for (friction, bricks) in [(0.02, [2, 3, 5]), (1e-3, [1; 3]), (0.3, [3; 3])] {
        for share in [1.0 - 1e-4, 1.0 - 1e-6, 1.0 + 1e-3] {
            let mut scene = hertz().unwrap().with_bricks(bricks, [1; 3]).with_friction(friction);
            change_counter_surface(&mut scene, |_| CounterSurface::Plane { height: 10.0 });
            scene.bodies[0].supports = vec![Support::new(BlockFace::Bottom, [true; 3])];
            scene.bodies[1].supports.clear();
            scene.bodies[1].loads = vec![Load::traction(BlockFace::Top, [100.0 * friction * share, 0.0, -100.0])];
            let problem = ContactProblem::new(scene).unwrap();
            let refused = Configuration::new(&problem, &[10.0; 36]).map(|_| ());
            let refused = matches!(refused, Err(ContactError::NoEquilibrium { .. }));
            assert_eq!(refused, share > 1.0, "friction {friction}, {share}");
        }
    }
}

#[test]
fn patch_test_uniform_pressure_with_edge_and_corner_weights() {
    let mut scene = small(signorini().unwrap(), 6, 3);
    change_counter_surface(&mut scene, |_| CounterSurface::Plane { height: 100.0 });
    scene.bodies[0].material = Material::new(1.1e5, 0.0).unwrap();
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
        for pressure in state.rows.pressures(&state.forces.normal) {
            assert!((pressure / 3000.0 - 1.0).abs() < 1e-11, "{kind:?} {pressure}");
        }
        assert!(state.forces.status.iter().all(|status| *status == ContactStatus::Stick));
    }
}

#[test]
fn certificates_hold() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        let shape = ContactShape::new(small(scene, 6, 2), SolverKind::Newton).unwrap();
        let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
        let residuals = state.forces.residuals;
        for value in [residuals.equilibrium, residuals.complementarity, residuals.friction_cone, residuals.dissipation]
        {
            assert!(value < 1e-11, "{residuals:?}");
        }
    }
}

#[test]
fn bad_scenes_are_refused_naming_the_field() {
    let refused = |scene: Scene, text: &str| match ContactShape::new(scene, SolverKind::Newton) {
        Err(error) => assert!(error.to_string().contains(text), "{error}"),
        Ok(_) => panic!("{text} was accepted"),
    };
    refused(small(signorini().unwrap(), 0, 1), "lower.block.bricks[0]");
    refused(small(signorini().unwrap(), 6, 4), "lower.block.subdomains[0]");
    refused(signorini().unwrap().with_friction(-0.1), "friction");
    refused(signorini().unwrap().with_friction(f64::NAN), "friction");
    refused(signorini().unwrap().with_shapes(|heights| heights.control_points = [3, 3, 2]), "degree");
    assert!(matches!(Material::new(1.0, 0.5), Err(SceneError::OutOfRange { .. })));
    assert!(matches!(Material::new(-1.0, 0.3), Err(SceneError::OutOfRange { .. })));
}

#[test]
fn folded_shape_is_refused_naming_the_element() {
    let problem = ContactProblem::new(small(signorini().unwrap(), 4, 1)).unwrap();
    let mut controls = vec![100.0; 36];
    for height in [0.0, -50.0] {
        controls[0] = height;
        match problem.positions(&controls) {
            Err(ContactError::InvertedElement { body, cell: 0, .. }) if body == "lower" => {}
            other => panic!("{other:?}"),
        }
    }
    let shape = ContactShape::new(small(signorini().unwrap(), 4, 1), SolverKind::Newton).unwrap();
    assert!(shape.solve(&Vector::from_vec(controls), None, Accuracy::TIGHTEST).is_err());
}
