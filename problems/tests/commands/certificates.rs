//! The certificate of a run, read back from its files, is computed again with the admissible set of the scene.

use contact::equilibrium::ContactProblem;
use contact::scene;
use nonsmooth::Certificate;
use std::path::Path;
use std::process::Command;

fn read<T: serde::de::DeserializeOwned>(file: &Path) -> T {
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

fn check(binary: &str, scene: scene::Scene) {
    let folder = std::env::temp_dir().join(format!("nonsmooth-recheck-{}-{}", scene.name, std::process::id()));
    let arguments = ["optimize", "--mesh", "4", "--max-evaluations", "25", "--out"];
    let output = Command::new(binary).args(arguments).arg(&folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let certificate: Certificate = read(&folder.join("certificate.json"));
    let controls: Vec<Vec<f64>> = read(&folder.join("controls.json"));
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(certificate.point.as_slice(), controls.concat());

    let problem = ContactProblem::new(scene.with_bricks([4; 3], [2; 3])).unwrap();
    let recheck = certificate.recheck(problem.admissible.polyhedron()).unwrap();
    let near = |own: f64, again: f64| (own - again).abs() <= 1e-8 * own.abs();
    assert!(near(certificate.aggregate_norm, recheck.aggregate_norm), "{recheck:?} {certificate}");
    assert!(near(certificate.aggregate_error, recheck.aggregate_error), "{recheck:?} {certificate}");
    assert!(recheck.multiplier_defect <= 1e-9 && recheck.violation <= 1e-9, "{recheck:?}");
    assert_eq!(recheck.open_side_multiplier, 0.0);

    let mut forged = certificate.clone();
    forged.point[0] *= 1.01;
    let recheck = forged.recheck(problem.admissible.polyhedron()).unwrap();
    assert!(!near(certificate.aggregate_error, recheck.aggregate_error), "{recheck:?}");
}

#[test]
fn certificates_of_signorini_runs_are_rechecked() {
    check(env!("CARGO_BIN_EXE_signorini3d"), scene::signorini().unwrap());
}

#[test]
fn certificates_of_hertz_runs_are_rechecked() {
    check(env!("CARGO_BIN_EXE_hertz3d"), scene::hertz().unwrap());
}
