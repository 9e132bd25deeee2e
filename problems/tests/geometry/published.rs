//! States and gradients of an independent reference (numpy; confirmed by a second code): waves, sphere, tilted planes,
//! blocks and lugs of both kinds of cells.

use crate::scenes::{case, number, numbers, objective, published, solved, text_of, vectors};
use contact::solvers::SolverKind;
use nonsmooth::Vector;
use serde_json::Value;

/// Largest relative difference of objective and total force; of forces and gradient to their largest entry.
const OF_VALUES: f64 = 1e-10;
const OF_ENTRIES: f64 = 1e-9;

fn check(published: &Value, kind: SolverKind) {
    let name = published["name"].as_str().expect("a name");
    let case = case(&text_of(published));
    let objective = objective(&case, kind);
    let (value, gradient, state) = solved(&objective, &Vector::from_vec(numbers(&published["controls"])));
    let relative = |found: f64, expected: f64| (found - expected).abs() / expected.abs();
    let expected = number(&published["objective"]);
    assert!(relative(value, expected) < OF_VALUES, "{name}: Θ {:.1e}", relative(value, expected));
    let total = relative(state.forces.total_normal_force(), number(&published["total_normal_force"]));
    assert!(total < OF_VALUES, "{name}: total force {total:.1e}");
    let largest = |found: &[f64], expected: &[f64]| {
        assert_eq!(found.len(), expected.len(), "{name}");
        let size = expected.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size
    };
    let of_gradient = largest(gradient.as_slice(), &numbers(&published["gradient"]));
    assert!(of_gradient < OF_ENTRIES, "{name}: gradient {of_gradient:.1e}");
    let (nodes, points) = (&published["contact"], &objective.solver().problem().boundary.points);
    // Nodes that supports hold along their normal have no row here.
    let all = numbers(&nodes["node"]);
    let places: Vec<usize> = points
        .iter()
        .map(|point| {
            all.iter().position(|node| *node == f64::from(point.node)).expect("a contact node of the reference")
        })
        .collect();
    let chosen = |values: Vec<f64>| places.iter().map(|&place| values[place]).collect::<Vec<f64>>();
    let chosen3 = |values: Vec<[f64; 3]>| places.iter().flat_map(|&place| values[place]).collect::<Vec<f64>>();
    let rows = &state.rows.nodes;
    let normals: Vec<f64> = rows.iter().flat_map(|row| row.normal).collect();
    let gaps: Vec<f64> = rows.iter().map(|row| row.gap).collect();
    let mut differences = vec![
        ("normals", largest(&normals, &chosen3(vectors(&nodes["normal"])))),
        ("gaps", largest(&gaps, &chosen(numbers(&nodes["gap"])))),
        ("areas", largest(&state.rows.areas(), &chosen(numbers(&nodes["area"])))),
        ("normal forces", largest(&state.forces.normal, &chosen(numbers(&nodes["lambda_n"])))),
    ];
    if number(&published["friction"]) > 0.0 {
        let found: Vec<f64> = state.forces.tangential.iter().flatten().copied().collect();
        differences.push(("friction forces", largest(&found, &chosen3(vectors(&nodes["lambda_t_global"])))));
    }
    for (what, difference) in differences {
        assert!(difference < OF_ENTRIES, "{name}: {what} {difference:.1e}");
    }
    let counts = state.forces.counts();
    let status = &published["status"];
    assert_eq!(Some(counts.open as u64), status["open"].as_u64(), "{name}");
}

#[test]
fn total_feti_finds_the_published_states_and_gradients() {
    published().iter().for_each(|case| check(case, SolverKind::Newton));
}

#[test]
fn direct_condensation_finds_the_published_states_and_gradients() {
    published().iter().for_each(|case| check(case, SolverKind::Direct));
}
