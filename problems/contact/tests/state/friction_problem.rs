//! The matrices of the friction problem: what they say of a solved state.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::friction_problem::{FrictionProblem, ROWS};
use contact::scene::{hertz, signorini};
use nonsmooth::{Accuracy, StateSolver};

/// A sum of entries times a vector, by rows or, with `transposed`, by columns; a lower triangle counts twice.
fn product(entries: &[(usize, usize, f64)], x: &[f64], rows: usize, transposed: bool, symmetric: bool) -> Vec<f64> {
    let mut y = vec![0.0; rows];
    for &(row, column, value) in entries {
        let (row, column) = if transposed { (column, row) } else { (row, column) };
        y[row] += value * x[column];
        if symmetric && row != column {
            y[column] += value * x[row];
        }
    }
    y
}

#[test]
fn a_solved_state_satisfies_the_equations_and_the_law() {
    for scene in [signorini().unwrap(), hertz().unwrap(), hertz().unwrap().with_friction(0.0)] {
        let shape = ContactShape::new(scene.with_bricks([4, 6, 4], [2; 3]), SolverKind::Direct).unwrap();
        let mut control = shape.start();
        control.iter_mut().enumerate().for_each(|(i, height)| *height *= 1.0 - 0.002 * (i as f64).sin().abs());
        let state = shape.solve(&control, None, Accuracy::TIGHTEST).unwrap();
        let bodies = shape.fields(&state).unwrap().bodies;
        let problem = FrictionProblem::new(shape.problem(), control.as_slice()).unwrap();
        let FrictionProblem { unknowns, stiffness, load, contact, gaps, friction, .. } = &problem;
        let u: Vec<f64> = unknowns.iter().map(|&[body, node, axis]| bodies[body].displacement[node][axis]).collect();
        let forces = &state.forces;
        // Along the tangential directions that are free; frictionless states have no rows for them.
        let tangential = |node: usize, vectors: &[[f64; 3]]| -> [f64; 2] {
            let along = |direction: &[f64; 3]| (0..3).map(|axis| direction[axis] * vectors[node][axis]).sum();
            let directions = &state.rows.nodes[node].directions;
            std::array::from_fn(|row| directions.get(1 + row).map_or(0.0, along))
        };
        let row = |node: usize| {
            let [first, second] = tangential(node, &forces.tangential);
            [forces.normal[node], first, second]
        };
        let r: Vec<f64> = (0..gaps.len()).flat_map(row).collect();
        let (inner, outer) = (product(stiffness, &u, u.len(), false, true), product(contact, &r, u.len(), true, false));
        let total = forces.total_normal_force();
        let residual = (0..u.len()).map(|i| (inner[i] - load[i] - outer[i]).abs()).fold(0.0, f64::max);
        assert!(residual < 1e-10 * total, "{residual} N of {total} N");
        let jumps = product(contact, &u, r.len(), false, false);
        for node in 0..gaps.len() {
            let (w, r) = (&jumps[ROWS * node..ROWS * node + 3], &r[ROWS * node..ROWS * node + 3]);
            assert!((w[0] + gaps[node] + forces.opening[node]).abs() < 1e-12, "the gap of node {node}");
            let (bound, force) = (friction[node] * r[0], r[1].hypot(r[2]));
            assert!(force <= bound + 1e-9 * total, "{force} N of {bound} N");
            // The slip of the state is minus w_T, along the force.
            if !forces.slip.is_empty() {
                let slip = tangential(node, &forces.slip);
                assert!((w[1] + slip[0]).abs() < 1e-12 && (w[2] + slip[1]).abs() < 1e-12, "{w:?} {slip:?}");
                let (length, power) = (w[1].hypot(w[2]), -(w[1] * r[1] + w[2] * r[2]));
                assert!((power - bound * length).abs() <= 1e-9 * total * (length + 1e-6), "{power} {bound} {length}");
            }
        }
        assert!(friction.iter().all(|value| *value == shape.problem().scene.friction()));
    }
}
