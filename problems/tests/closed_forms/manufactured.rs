//! A smooth solution: rate 2 of the displacements in L², rate 1 in the energy norm.

use problems::accuracy::manufactured_errors;

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
