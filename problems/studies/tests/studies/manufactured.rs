//! A smooth solution: rate 2 of the displacements in L², rate 1 in the energy norm, rate 2 of the stress at the centres
//! of the bricks, where it is one order better than elsewhere.

use contact::body::elasticity::stiffness::stress;
use contact::body::elasticity::stress::{COMPONENTS, von_mises};
use contact::body::elasticity::{Formulation, Material};
use contact::equilibrium::SolvedBody;
use contact::fields::BodyFields;
use std::sync::Arc;
use studies::accuracy::{manufactured_errors, smooth_gradient, smooth_solution};

#[test]
fn smooth_solution_converges_at_the_rates_of_trilinear_bricks() {
    let errors = [3, 6, 12].map(|bricks| manufactured_errors(bricks).unwrap());
    for pair in errors.windows(2) {
        let rate = |first: f64, second: f64| (first / second).log2();
        let rates = [rate(pair[0].displacement, pair[1].displacement), rate(pair[0].energy, pair[1].energy)];
        println!(
            "{}³ bricks: L² {:.2e} (rate {:.2}), energy {:.2e} (rate {:.2})",
            pair[1].bricks, pair[1].displacement, rates[0], pair[1].energy, rates[1]
        );
        assert!((rates[0] - 2.0).abs() < 0.1 && (rates[1] - 1.0).abs() < 0.05, "{rates:?}");
    }
}

/// Relative errors of the stress recovered for pictures, where it is taken: √(Σ V|σ − σ_h|²/Σ V|σ|²) over the centres
/// of the bricks, and |σ_vM − σ_vM,h| over |σ_vM| over the nodes, Euclidean norms.
fn stress_errors(bricks: usize, formulation: Formulation) -> [f64; 2] {
    let material = Material::new(1.0, 0.3).unwrap().with_formulation(formulation);
    let (body, _, displacement) = smooth_solution(bricks, material).unwrap();
    let mesh = Arc::clone(&body.mesh);
    let solved = SolvedBody {
        positions: Arc::new(mesh.nodes().to_vec()),
        displacement,
        gluing_defect: 0.0,
        subdomains: vec![0; mesh.cell_count()],
        mesh: Arc::clone(&mesh),
    };
    let fields = BodyFields::new(solved, &body);
    let exact = |x: [f64; 3]| {
        let full = stress(&smooth_gradient(x), (material.lame_lambda(), material.shear_modulus()));
        COMPONENTS.map(|(row, column)| full[row][column])
    };
    let (mut centre, mut nodal) = ([0.0; 2], [0.0; 2]);
    for (brick, found) in fields.stress.iter().enumerate() {
        let volume = mesh.cell_nodes(brick, mesh.nodes()).volume();
        let exact = exact(mesh.centre(brick, mesh.nodes()));
        for ((found, exact), (row, column)) in found.iter().zip(exact).zip(COMPONENTS) {
            let weight = volume * if row == column { 1.0 } else { 2.0 };
            centre[0] += weight * (found - exact).powi(2);
            centre[1] += weight * exact.powi(2);
        }
    }
    for (node, found) in mesh.nodes().iter().zip(&fields.nodal_von_mises) {
        let exact = von_mises(&exact(*node));
        nodal[0] += (found - exact).powi(2);
        nodal[1] += exact.powi(2);
    }
    [centre, nodal].map(|sums| (sums[0] / sums[1]).sqrt())
}

#[test]
fn recovered_stress_converges_one_order_faster_at_the_centres() {
    for formulation in [Formulation::Standard, Formulation::MeanDilatation] {
        let errors = [3, 6, 12].map(|bricks| (bricks, stress_errors(bricks, formulation)));
        for pair in errors.windows(2) {
            let [(_, coarse), (bricks, fine)] = [pair[0], pair[1]];
            let rates = [0, 1].map(|index| (coarse[index] / fine[index]).log2());
            println!("{formulation:?}, {bricks}³ bricks: centres {:.2e}, von Mises at nodes {:.2e}", fine[0], fine[1]);
            assert!((rates[0] - 2.0).abs() < 0.1, "{rates:?}");
            // First order at the boundary, where a node has bricks on one side only: 3/2 in this norm, from below.
            assert!(rates[1] > 1.2, "{rates:?}");
        }
    }
}
