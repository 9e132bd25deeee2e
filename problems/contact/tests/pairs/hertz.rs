//! Hertz between two elastic bodies along true normals, grids 2 : 3, against the closed form without friction and
//! against a fine grid that matches with friction.
//!
//! ```text
//! a³ = 3PR/(4E*),   p₀ = 3P/(2πa²),   ∫p r²/∫p = 2a²/5,   1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂
//! ```

use crate::grid::{Point, mesh};
use crate::setting::{body, lattice, pair, symmetric};
use contact::body::mesh::CellKind;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::scene::{Geometry, Held, Scene, Support};
use nonsmooth::{Accuracy, StateSolver};
use std::f64::consts::PI;

const SIDE: f64 = 10.0;
const RADIUS: f64 = 60.0;
/// Approach of the far ends of the bodies, mm: a is a quarter of their width.
const APPROACH: f64 = 0.09;
const LOWER: [f64; 2] = [1000.0, 0.3];
const UPPER: [f64; 2] = [2000.0, 0.25];
/// Cells become smaller towards the contact.
const GRADING: f64 = 1.5;

fn graded(place: f64) -> f64 {
    place.powf(GRADING)
}

/// A quarter of a block below a quarter of one with a spherical bottom.
fn scene(cells: [usize; 2], slave: usize, friction: f64) -> Scene {
    let below = |[s, t, r]: Point| [SIDE * graded(s), SIDE * graded(t), -SIDE * graded(1.0 - r)];
    let above = |[s, t, r]: Point| {
        let [x1, x2] = [SIDE * graded(s), SIDE * graded(t)];
        let square = x1 * x1 + x2 * x2;
        let height = square / (RADIUS + (RADIUS * RADIUS - square).sqrt());
        [x1, x2, height + graded(r) * (SIDE - height)]
    };
    let own = |count: usize| [count; 3];
    let mut lower = body("lower", mesh(CellKind::Hex8, own(cells[0]), 0.0, below), LOWER);
    let mut upper = body("upper", mesh(CellKind::Hex8, own(cells[1]), 0.0, above), UPPER);
    lower.shape = lattice([0.0, 0.0, -SIDE], [SIDE; 3], [false, false, true]);
    (lower.supports, upper.supports) = (symmetric(), symmetric());
    lower.supports.push(Support::new("bottom", [false, false, true]));
    let down = Held::Components([None, None, Some(-APPROACH)]);
    upper.supports.push(Support { face: "top".into(), held: down });
    let mut bodies = vec![lower, upper];
    for body in &mut bodies {
        if let Geometry::Mesh(geometry) = &mut body.geometry {
            geometry.pieces = None;
        }
    }
    pair(bodies, slave, friction)
}

/// Force on the quarter, pressure in the centre, and contact radius by the second moment of the pressures.
fn measured(scene: &Scene) -> [f64; 3] {
    let shape = ContactShape::new(scene.clone(), SolverKind::Auto).unwrap();
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    let (mut force, mut moment, mut centre) = (0.0, 0.0, 0.0);
    for (index, point) in shape.problem().boundary.points.iter().enumerate() {
        let x = shape.problem().bodies[point.body].mesh.nodes()[point.node as usize];
        let (own, square) = (state.forces.normal[index], x[0] * x[0] + x[1] * x[1]);
        force += own;
        moment += own * square;
        if square < 1e-12 {
            centre = own / state.rows.nodes[index].area;
        }
    }
    [force, centre, (2.5 * moment / force).sqrt()]
}

fn closed_form(force: f64) -> [f64; 2] {
    let compliance = |[modulus, ratio]: [f64; 2]| (1.0 - ratio * ratio) / modulus;
    let modulus = 1.0 / (compliance(LOWER) + compliance(UPPER));
    let whole = 4.0 * force;
    let a = (3.0 * whole * RADIUS / (4.0 * modulus)).cbrt();
    [3.0 * whole / (2.0 * PI * a * a), a]
}

/// Errors of peak and radius on grids of 12 : 18, 16 : 24 and 24 : 36 cells, with the softer and coarser body as slave:
/// −2.7 and −0.5 %, −2.2 and 0.7 %, −1.2 and 0.3 %; with the other slave 0.7 and −0.5 %, 0.2 and −0.1 %. A gap is a
/// mean over the facets about its node, which are smaller in the centre than beside it.
#[test]
fn two_elastic_bodies_have_the_pressure_and_the_radius_of_hertz() {
    for (slave, allowed) in [(0, [0.03, 0.01]), (1, [0.01, 0.01])] {
        let [force, peak, radius] = measured(&scene([12, 18], slave, 0.0));
        let [p0, a] = closed_form(force);
        let errors = [peak / p0 - 1.0, radius / a - 1.0];
        println!("p₀ off by {:.2} %, a by {:.2} % ({a:.2} mm)", 100.0 * errors[0], 100.0 * errors[1]);
        assert!(errors.iter().zip(allowed).all(|(error, allowed)| error.abs() < allowed), "{slave}: {errors:?}");
    }
}

/// On grids of 16 : 24 cells against 32 : 32: peak 0.56 %, radius 0.84 %, force 0.45 %.
#[test]
fn with_friction_they_have_those_of_a_fine_grid_that_matches() {
    let fine = measured(&scene([24, 24], 0, 0.3));
    let found = measured(&scene([12, 18], 0, 0.3));
    let errors: [f64; 3] = std::array::from_fn(|k| found[k] / fine[k] - 1.0);
    println!("force, peak, radius off by {errors:?}");
    assert!(errors.iter().all(|error| error.abs() < 0.02), "{errors:?}");
}
