//! Changing variables changes neither minimiser nor admissible set.

use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Matrix, Polyhedron, Reparametrized, Vector};

fn valley(x: &Vector) -> (f64, Vector) {
    // Steep across, slowly falling along (1, 1).
    let (across, along) = (x[0] - x[1], x[0] + x[1]);
    let value = 1e3 * across.abs() + 1e-2 * along;
    let side = 1e3 * across.signum();
    (value, Vector::from_vec(vec![side + 1e-2, -side + 1e-2]))
}

#[test]
fn minimiser_and_feasibility_are_those_of_the_original() -> Result<(), Box<dyn std::error::Error>> {
    let set = Polyhedron::boxed(Vector::from_element(2, -5.0), Vector::from_element(2, 5.0))?;
    let stretch = Matrix::from_row_slice(2, 2, &[50.5, 49.5, 49.5, 50.5]);
    let scaled = Reparametrized::new(FnObjective::new(2, valley), stretch)?;
    let start = Vector::from_vec(vec![3.0, 1.0]);
    assert!((scaled.original(&scaled.transformed(&start)) - &start).norm() < 1e-12);
    let report = BundleTrust::new(BundleTrustConfig::default())?
        .constraints(scaled.transformed_set(&set)?)
        .minimize(&scaled, scaled.transformed(&start))?;
    let solution = scaled.original(&report.solution);
    assert!((solution - Vector::from_element(2, -5.0)).norm() < 1e-6, "{report}");
    assert!(set.violation(&scaled.original(&report.solution)) < 1e-9);
    Ok(())
}

#[test]
fn singular_matrices_are_refused() {
    assert!(Reparametrized::new(FnObjective::new(2, valley), Matrix::zeros(2, 2)).is_err());
    assert!(Reparametrized::new(FnObjective::new(2, valley), Matrix::zeros(3, 2)).is_err());
}
