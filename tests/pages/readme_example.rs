//! The README's example of the framework, as it stands there.

use nonsmooth::composite::Maximum;
use nonsmooth::{
    BundleTrust, BundleTrustConfig, CompositeFunction, Convexity, FnObjective, Matrix, Polyhedron, Vector,
};

#[test]
fn closure_over_a_box() -> Result<(), Box<dyn std::error::Error>> {
    let theta = FnObjective::new(2, |x: &Vector| {
        let (bowl, plane) = (x.norm_squared(), 4.0 - x[0] - x[1]);
        if bowl > plane { (bowl, x * 2.0) } else { (plane, Vector::from_element(2, -1.0)) }
    });
    let set = Polyhedron::boxed(Vector::zeros(2), Vector::from_element(2, 3.0))?;
    let config = BundleTrustConfig { convexity: Convexity::Convex, ..BundleTrustConfig::default() };
    let report = BundleTrust::new(config)?.constraints(set).minimize(&theta, Vector::zeros(2))?;
    // x = y with 2x² = 4 − 2x: x = 1, Θ = 2.
    assert!((report.value - 2.0).abs() < 1e-6, "{report}");
    assert!(report.termination.is_confirmed(), "{report}");
    Ok(())
}

#[test]
fn both_pieces_at_once() -> Result<(), Box<dyn std::error::Error>> {
    let theta = CompositeFunction::new(2, Maximum, |x: &Vector| {
        let outputs = Vector::from_vec(vec![x.norm_squared(), 4.0 - x[0] - x[1]]);
        (outputs, Matrix::from_row_slice(2, 2, &[2.0 * x[0], 2.0 * x[1], -1.0, -1.0]))
    });
    let report = BundleTrust::new(BundleTrustConfig::default())?.minimize(&theta, Vector::zeros(2))?;
    assert!((report.value - 2.0).abs() < 1e-6, "{report}");
    assert!(report.termination.is_confirmed() && report.counts.evaluations < 10, "{report}");
    Ok(())
}
