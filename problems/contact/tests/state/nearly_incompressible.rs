//! Nearly incompressible bodies take about as many products with F as compressible ones, and both solvers agree.

use crate::common::{change_counter_surface, set_top};
use contact::body::elasticity::{Formulation, Material};
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::linear::vector::{add_scaled, norm};
use contact::plausibility::Warning;
use contact::scene::{CounterSurface, Load, Scene, Support, hertz, signorini};
use nonsmooth::{Accuracy, StateSolver};

/// A preset with all bodies of one Poisson's ratio and formulation.
fn scene(preset: Scene, [bricks, subdomains]: [usize; 2], ratio: f64, formulation: Formulation) -> Scene {
    let mut scene = preset.with_bricks([bricks; 3], [subdomains; 3]);
    for body in &mut scene.bodies {
        let young = body.material.young_modulus();
        body.material = Material::new(young, ratio).unwrap().with_formulation(formulation);
    }
    scene
}

/// Products with F that a state takes.
fn products(scene: Scene) -> usize {
    let shape = ContactShape::new(scene, SolverKind::Newton).unwrap();
    shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap().work().dual_operator_applications
}

#[test]
fn mean_dilatation_takes_tens_of_products_whatever_the_ratio() {
    // Before the compressible neighbour: 8756, and beyond 10 000.
    let limits = [(12, 2, 0.4999, 75), (12, 2, 0.499_999, 75), (12, 4, 0.4999, 100)];
    for (mesh, subdomains, ratio, allowed) in limits {
        let scene = scene(signorini().unwrap(), [mesh, subdomains], ratio, Formulation::MeanDilatation);
        let found = products(scene);
        assert!(found <= allowed, "ν = {ratio}, {mesh}/{subdomains}: {found} products, allowed: {allowed}");
    }
    let found = products(scene(hertz().unwrap(), [12, 2], 0.4999, Formulation::MeanDilatation));
    assert!(found <= 105, "two bodies: {found}");
}

#[test]
fn standard_bricks_take_hundreds_of_products() {
    // 784 before the compressible neighbour.
    let found = products(scene(signorini().unwrap(), [12, 2], 0.4999, Formulation::Standard));
    assert!(found <= 260, "{found}");
}

#[test]
fn forces_agree_with_those_of_direct_condensation() {
    for preset in [signorini().unwrap(), hertz().unwrap()] {
        for formulation in [Formulation::Standard, Formulation::MeanDilatation] {
            let forces = |kind| {
                let shape = ContactShape::new(scene(preset.clone(), [6, 2], 0.4999, formulation), kind).unwrap();
                shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap().forces.normal
            };
            let (mut difference, direct) = (forces(SolverKind::Newton), forces(SolverKind::Direct));
            add_scaled(&mut difference, -1.0, &direct);
            let relative = norm(&difference) / norm(&direct);
            assert!(relative < 1e-9, "{formulation:?}: {relative:e}");
        }
    }
}

#[test]
fn ordinary_materials_have_no_compressible_neighbour() {
    for formulation in [Formulation::Standard, Formulation::MeanDilatation] {
        let material = |ratio| Material::new(2.0, ratio).unwrap().with_formulation(formulation);
        assert!(material(0.49).compressible_neighbour().is_none());
        let (near, neighbour) = (material(0.4999), material(0.4999).compressible_neighbour().unwrap());
        assert!((neighbour.shear_modulus() / near.shear_modulus() - 1.0).abs() < 1e-14);
        assert!(neighbour.poisson_ratio() <= 0.49 && neighbour.formulation() == formulation);
        assert!(neighbour.compressible_neighbour().is_none());
    }
}

/// A soft layer, bonded to its base, under a steel sphere: `problems/scenes/thin_layer.toml`.
fn layer(ratio: f64, formulation: Formulation) -> Scene {
    let scene = hertz().unwrap().with_bricks([12, 12, 4], [2, 2, 1]).with_friction(0.1);
    let mut scene = scene.with_shapes(|heights| {
        (heights.start, heights.thickness, heights.volume) = (1.0, Some(0.5), Some([80.0, 120.0]));
    });
    scene.bodies[0].material = Material::new(100.0, ratio).unwrap().with_formulation(formulation);
    for support in scene.bodies[0].supports.iter_mut().filter(|support| support.face == BlockFace::Bottom.name()) {
        *support = Support::new(BlockFace::Bottom, [true; 3]);
    }
    change_counter_surface(&mut scene, |_| CounterSurface::Sphere { apex: 1.0, radius: 100.0, centre: [0.0; 2] });
    set_top(&mut scene, 8.0);
    scene.bodies[1].loads = vec![Load::traction(BlockFace::Top, [0.0, 0.0, -1.0])];
    scene
}

/// Peak pressure, and the warnings about locking.
fn peak(ratio: f64, formulation: Formulation) -> (f64, Vec<Warning>) {
    let shape = ContactShape::new(layer(ratio, formulation), SolverKind::default()).unwrap();
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    let pressures = state.rows.pressures(&state.forces.normal);
    let warnings = shape.warnings(&state).unwrap().into_iter().filter(|warning| warning.code == "volume-locking");
    (pressures.iter().copied().fold(0.0, f64::max), warnings.collect())
}

#[test]
fn standard_bricks_that_lock_are_named() {
    // Peaks of standard bricks in those of mean dilatation: 1.01, 1.04, 1.10, 4.0.
    for (ratio, least, most) in [(0.45, 0.98, 1.02), (0.47, 1.0, 1.05), (0.49, 1.08, 1.12), (0.4999, 3.5, 4.5)] {
        let (standard, warnings) = peak(ratio, Formulation::Standard);
        let (right, none) = peak(ratio, Formulation::MeanDilatation);
        assert!((least..=most).contains(&(standard / right)), "{ratio}: {standard} {right}");
        assert_eq!((warnings.len(), none.len()), (usize::from(ratio > 0.47), 0), "{ratio}: {warnings:?}");
        for warning in warnings {
            let words = ["of the lower body", "lower.material.formulation = \"mean-dilatation\""];
            assert!(words.iter().all(|word| warning.text.contains(word)), "{warning}");
        }
    }
}
