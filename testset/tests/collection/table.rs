//! The table: completeness, dimensions, feasibility of the starts.

use testset::{Family, all, find};

#[test]
fn the_collection_is_complete() {
    let problems = all();
    let constrained = problems.iter().filter(|p| p.family == Family::LinearlyConstrained).count();
    assert_eq!((problems.len() - constrained, constrained), (37, 7));
    for problem in &problems {
        assert_eq!(problem.family == Family::LinearlyConstrained, problem.group == "linear", "{}", problem.name);
        let found = find(&problem.name).map(|found| found.name);
        assert_eq!(found.as_ref(), Some(&problem.name));
    }
    let mut names: Vec<&str> = problems.iter().map(|p| p.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 44, "names are unique");
    assert!(find("no such problem").is_none());
}

#[test]
fn names_are_those_of_the_table() {
    let table: serde_json::Value = serde_json::from_str(include_str!("../../data/reference.json")).expect("valid JSON");
    let records = table["problems"].as_array().expect("an array of problems");
    let names: Vec<&str> = records.iter().filter_map(|record| record["name"].as_str()).collect();
    let problems = all();
    assert_eq!(problems.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), names);
}

#[test]
fn dimensions_agree() {
    for p in all() {
        let n = p.dimension;
        assert_eq!([p.start.len(), p.lower.len(), p.upper.len(), p.convex_lower.len()], [n; 4], "{}", p.name);
        assert_eq!([p.row_lower.len(), p.row_upper.len()], [p.rows.len(); 2], "{}", p.name);
        assert!(p.rows.iter().all(|row| row.len() == n), "{}", p.name);
        assert!(p.lower.iter().zip(&p.upper).all(|(l, u)| l <= u), "{}", p.name);
        assert!(p.row_lower.iter().zip(&p.row_upper).all(|(l, u)| l <= u), "{}", p.name);
    }
}

#[test]
fn starts_are_finite_and_their_feasibility_is_known() {
    for p in all() {
        let (value, subgradient) = p.evaluate(&p.start);
        assert!(value.is_finite() && subgradient.iter().all(|g| g.is_finite()), "{}", p.name);
        assert_eq!(subgradient.len(), p.dimension, "{}", p.name);
        // Two starts violate a row: the corner (1, 1) outside the pentagon, and the balance 1.22 x₄ = x₁ + x₅.
        let expected = match p.name.as_str() {
            "PENTAGON" => (0.4 * std::f64::consts::PI).sin() + (0.4 * std::f64::consts::PI).cos() - 1.0,
            "HS114" => 0.44,
            _ => 0.0,
        };
        assert!((p.violation(&p.start) - expected).abs() < 1e-12, "{}: {}", p.name, p.violation(&p.start));
    }
}

#[test]
fn violation_sees_bounds_and_rows() {
    let problem = find("MAD4").expect("MAD4 is in the table");
    assert_eq!(problem.violation(&[0.0, 0.01]), 0.0);
    assert_eq!(problem.violation(&[0.0, -0.99]), 1.0);
    assert!((problem.violation(&[0.0, 2.5]) - 2.0).abs() < 1e-15);
}

#[test]
fn every_problem_has_the_counts_of_its_solvers() {
    let solvers = ["bfgs", "lmbm", "mpbngc", "nonoptCP", "nonoptG", "pbun", "pvar", "rolBT", "solvopt"];
    for p in all() {
        // Three of the nine take linear constraints.
        let constrained = p.family == Family::LinearlyConstrained;
        let expected: Vec<&str> =
            solvers.into_iter().filter(|solver| !constrained || ["mpbngc", "pbun", "pvar"].contains(solver)).collect();
        assert_eq!(p.peers.keys().map(String::as_str).collect::<Vec<_>>(), expected, "{}", p.name);
    }
    let cb2 = find("CB2").expect("CB2 is in the table");
    assert_eq!((cb2.peers["mpbngc"], cb2.peers["rolBT"]), (Some(14), Some(65)));
    assert_eq!(find("PENTAGON").expect("PENTAGON is in the table").peers["pbun"], Some(17));
    assert_eq!(find("HS114").expect("HS114 is in the table").peers["pbun"], None);
}
