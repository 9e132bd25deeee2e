//! Nearly incompressible bodies take about as many products with F as compressible ones, and the two solvers agree on them.

use contact::body::elasticity::{Formulation, Material};
use contact::contact_shape::{ContactShape, SolverKind};
use contact::linear::vector::{add_scaled, norm};
use contact::scene::{Scene, hertz, signorini};
use nonsmooth::{Accuracy, StateSolver};

/// A preset with all bodies of one Poisson's ratio and formulation.
fn scene(preset: Scene, [mesh, subdomains]: [usize; 2], ratio: f64, formulation: Formulation) -> Scene {
    let mut scene = Scene { mesh: [mesh; 3], subdomains: [subdomains; 3], ..preset };
    for body in scene.bodies_mut() {
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
