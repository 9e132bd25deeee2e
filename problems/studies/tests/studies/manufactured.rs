//! A smooth solution: rate 2 of the displacements in L², rate 1 in the energy norm, rate 2 of the stress at the centres
//! of the bricks, where it is one order better than elsewhere.

use contact::body::elasticity::Formulation;
use studies::accuracy::{manufactured_errors, manufactured_stress_errors};

#[test]
fn smooth_solution_converges_at_the_rates_of_trilinear_bricks() {
    let errors = [4, 8, 16].map(|bricks| manufactured_errors(bricks).unwrap());
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

#[test]
fn recovered_stress_converges_one_order_faster_at_the_centres() {
    for formulation in [Formulation::Standard, Formulation::MeanDilatation] {
        let errors = [4, 8, 16].map(|bricks| manufactured_stress_errors(bricks, formulation).unwrap());
        for pair in errors.windows(2) {
            let rate = |first: f64, second: f64| (first / second).log2();
            let rates = [rate(pair[0].centre, pair[1].centre), rate(pair[0].nodal_von_mises, pair[1].nodal_von_mises)];
            println!(
                "{formulation:?}, {}³ bricks: stress at centres {:.2e} (rate {:.2}), von Mises at nodes {:.2e} (rate {:.2})",
                pair[1].bricks, pair[1].centre, rates[0], pair[1].nodal_von_mises, rates[1]
            );
            assert!((rates[0] - 2.0).abs() < 0.1, "{rates:?}");
            // First order at the boundary, where a node has bricks on one side only: 3/2 in this norm, from below.
            assert!(rates[1] > 1.2, "{rates:?}");
        }
    }
}
