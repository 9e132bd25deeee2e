//! A curved interface that both grids interpolate, glued: the errors of the displacements in a uniform stress fall with
//! the square of the width of the facets.

use crate::grid::{Point, mesh};
use crate::setting::{body, lattice, pair, stacked};
use contact::body::mesh::CellKind;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::scene::{ContactKind, Geometry};
use nonsmooth::{Accuracy, StateSolver, Vector};

const MATERIAL: [f64; 2] = [1000.0, 0.3];
const PRESSURE: f64 = 10.0;

fn interface([x1, x2]: [f64; 2]) -> f64 {
    10.0 + 1.5 * (0.25 * x1).cos() * (0.2 * x2 + 0.3).sin()
}

/// Root mean square of the errors of all displacements over the largest displacement.
fn error(counts: [usize; 2]) -> f64 {
    let below = |[s, t, r]: Point| [10.0 * s, 10.0 * t, r * interface([10.0 * s, 10.0 * t])];
    let above = |[s, t, r]: Point| {
        let height = interface([10.0 * s, 10.0 * t]);
        [10.0 * s, 10.0 * t, height + r * (20.0 - height)]
    };
    let boxes = |count: usize| [count, count, (count / 2).max(2)];
    let mut lower = body("lower", mesh(CellKind::Hex8, boxes(counts[0]), 0.0, below), MATERIAL);
    lower.shape = lattice([0.0; 3], [10.0, 10.0, 12.0], [true; 3]);
    let upper = body("upper", mesh(CellKind::Hex8, boxes(counts[1]), 0.0, above), MATERIAL);
    let mut bodies = stacked(lower, upper, PRESSURE);
    for body in &mut bodies {
        if let Geometry::Mesh(geometry) = &mut body.geometry {
            geometry.pieces = None;
        }
    }
    let mut scene = pair(bodies, 1, 0.0);
    scene.contacts[0].kind = ContactKind::Tied;
    let shape = ContactShape::new(scene.clone(), SolverKind::Newton).unwrap();
    let state = shape.solve(&Vector::zeros(scene.control_count()), None, Accuracy::TIGHTEST).unwrap();
    let strain = PRESSURE / MATERIAL[0];
    let (mut sum, mut count) = (0.0, 0);
    for body in shape.bodies(&state).unwrap() {
        for (x, u) in body.positions.iter().zip(&body.displacement) {
            let exact = [MATERIAL[1] * strain * x[0], MATERIAL[1] * strain * x[1], -strain * x[2]];
            sum += (0..3).map(|axis| (u[axis] - exact[axis]).powi(2)).sum::<f64>();
            count += 1;
        }
    }
    (sum / f64::from(count)).sqrt() / (strain * 20.0)
}

#[test]
fn errors_on_a_curved_interface_fall_with_the_square_of_the_width() {
    let grids = [[3, 4], [6, 8], [12, 16], [24, 32]];
    let errors = grids.map(error);
    // The slope of the logarithms by least squares; every grid halves the width of the last one.
    let logs = errors.map(|error| -error.log2());
    let mean = logs.iter().sum::<f64>() / 4.0;
    let rate = logs.iter().enumerate().map(|(k, log)| (k as f64 - 1.5) * (log - mean)).sum::<f64>() / 5.0;
    println!("errors {errors:?}, rate {rate:.3}");
    assert!(rate >= 1.8, "{errors:?}: {rate}");
}
