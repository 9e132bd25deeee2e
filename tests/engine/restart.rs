//! Snapshots: the bundle is data.
use crate::common::{cb3, crescent, distance_1, plane, v};
use nonsmooth::{BundleTrust, BundleTrustConfig, NonsmoothObjective, OptimizeError, Polyhedron, Report, Snapshot};

fn method(set: &Polyhedron) -> BundleTrust<'static> {
    BundleTrust::new(BundleTrustConfig::default()).unwrap().constraints(set.clone())
}

fn bits(report: &Report) -> (Vec<u64>, u64, Vec<(u64, u64)>) {
    let point = report.solution.iter().map(|x| x.to_bits()).collect();
    let history = report.history.iter().map(|r| (r.value.unwrap().to_bits(), r.weight.to_bits())).collect();
    (point, report.value.to_bits(), history)
}

/// Interrupts after every number of steps, goes through JSON, resumes, and compares bit by bit.
fn resume_equals_uninterrupted<O: NonsmoothObjective>(theta: &O, set: &Polyhedron, start: &[f64]) {
    let whole = method(set).minimize(theta, v(start)).unwrap();
    for steps in 0..whole.counts.evaluations {
        let mut first = method(set);
        let mut run = first.start(theta, v(start)).unwrap();
        for _ in 0..steps {
            let _flow = run.step();
        }
        let text = run.snapshot().to_json().unwrap();
        let resumed = method(set).continue_from(theta, Snapshot::from_json(&text).unwrap()).unwrap();
        assert_eq!(bits(&resumed), bits(&whole), "interrupted after {steps} steps");
        assert_eq!(resumed.termination, whole.termination);
    }
}

#[test]
fn resume_equals_uninterrupted_convex() {
    resume_equals_uninterrupted(&cb3(), &Polyhedron::unbounded(2), &[2.0, 2.0]);
}

#[test]
fn resume_equals_uninterrupted_nonconvex() {
    resume_equals_uninterrupted(&crescent(), &Polyhedron::unbounded(2), &[-1.2, 1.0]);
}

#[test]
fn resume_equals_uninterrupted_constrained() {
    let set = plane(&[1.0, -2.0, 0.5], 1.0, 4.0);
    resume_equals_uninterrupted(&distance_1(v(&[0.3, 1.0, -2.0])), &set, &[3.0, -3.0, 1.0]);
}

#[test]
fn checkpoint_file_is_replaced_and_resumes() {
    let file = std::env::temp_dir().join(format!("nonsmooth-checkpoint-{}.json", std::process::id()));
    let whole = method(&Polyhedron::unbounded(2)).checkpoint(&file).minimize(&crescent(), v(&[-1.2, 1.0])).unwrap();
    assert!(whole.warnings.is_empty());
    let snapshot = Snapshot::read(&file).unwrap();
    assert_eq!(snapshot.value(), whole.value);
    let resumed = method(&Polyhedron::unbounded(2)).continue_from(&crescent(), snapshot).unwrap();
    assert_eq!(bits(&resumed), bits(&whole));
    std::fs::remove_file(&file).unwrap();
}

#[test]
fn checkpoint_that_cannot_be_written_is_a_warning() {
    let report = method(&Polyhedron::unbounded(2))
        .checkpoint("/nonexistent/dir/x.json")
        .minimize(&cb3(), v(&[2.0, 2.0]))
        .unwrap();
    assert!(!report.warnings.is_empty());
    assert!(report.value < 2.001);
}

#[test]
fn foreign_text_version_and_constraints_are_refused() {
    assert!(Snapshot::from_json("{}").is_err());
    let mut first = method(&Polyhedron::unbounded(2));
    let snapshot = first.start(&cb3(), v(&[2.0, 2.0])).unwrap().snapshot();
    let other = snapshot.to_json().unwrap().replacen("\"version\":3", "\"version\":99", 1);
    assert!(Snapshot::from_json(&other).unwrap_err().to_string().contains("99"));
    let mut boxed = method(&Polyhedron::boxed(v(&[0.0, 0.0]), v(&[1.0, 1.0])).unwrap());
    assert!(matches!(boxed.resume(&cb3(), snapshot), Err(OptimizeError::ChangedConstraints)));
}

#[test]
fn changed_problem_starts_from_the_old_center() {
    let unbounded = Polyhedron::unbounded(2);
    let old = distance_1(v(&[1.0, 2.0]));
    let mut method_old = method(&unbounded);
    let mut run = method_old.start(&old, v(&[50.0, 60.0])).unwrap();
    while run.step().is_continue() {}
    let snapshot = run.snapshot();
    let new = distance_1(v(&[1.0, 2.001]));
    let mut method_new = method(&unbounded);
    let mut run = method_new.warm_start(&new, &snapshot).unwrap();
    while run.step().is_continue() {}
    assert!(run.value() < 1e-6);
    assert!(run.history().len() < 30);
}
