//! Heights of faces of blocks as lattices, and rows of U of any lattice, beside closed forms.

use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use contact::scene::{Block, CounterSurface, Geometry, Scene, hertz, signorini};
use contact::shape::{Coordinates, Directions, LatticeShape, ShapedFace};

/// Bernstein polynomial i of a degree.
fn bernstein(degree: usize, i: usize, t: f64) -> f64 {
    let binomial = (0..i).fold(1.0, |product, k| product * (degree - k) as f64 / (k + 1) as f64);
    binomial * t.powi(i as i32) * (1.0 - t).powi((degree - i) as i32)
}

/// Controls that are not flat.
fn uneven(scene: &Scene, by: f64) -> Vec<f64> {
    let start = scene.start().into_iter().enumerate();
    start.map(|(index, value)| value + by * (1.7 * index as f64).sin()).collect()
}

/// The volume of the shaped body of a problem.
fn volume(problem: &ContactProblem, controls: &[f64]) -> f64 {
    problem.bodies[0].mesh.volume(&problem.map.positions(controls)[0])
}

/// The rows of U times some controls, with their sides.
fn rows(problem: &ContactProblem, controls: &[f64]) -> Vec<[f64; 3]> {
    let set = problem.admissible.polyhedron();
    let products = set.rows() * nonsmooth::Vector::from_column_slice(controls);
    (0..products.len()).map(|row| [set.row_lower()[row], products[row], set.row_upper()[row]]).collect()
}

/// A block below the obstacle of Example 5.1, with a Bézier surface as its top; its bottom is no plane.
fn carved() -> Scene {
    let mut scene = signorini().unwrap().with_bricks([5, 4, 3], [1; 3]);
    let bottom = CounterSurface::Waves { base: 3.0, first: 1.0, second: 2.0, period: 70.0, origin: [3.0, 1.0] };
    let own = Block { corner: [-20.0, 7.0], bottom, ..scene.bodies[0].block().unwrap().clone() };
    scene.bodies[0].geometry = Geometry::Block(own);
    scene.with_shapes(|heights| {
        (heights.control_points, heights.degrees) = ([4, 5, 2], [3, 4, 1]);
    })
}

#[test]
fn heights_of_a_top_have_their_closed_form() {
    let scene = carved();
    let (block, obstacle) = (scene.bodies[0].block().unwrap().clone(), scene.contacts[0].obstacle().unwrap().clone());
    let (problem, controls) = (ContactProblem::new(scene.clone()).unwrap(), uneven(&scene, 1.5));
    let places = block.grid().places().collect::<Vec<_>>();
    for (controls, positions) in [scene.start(), controls.clone()].map(|at| (at.clone(), problem.map.positions(&at))) {
        for (node, x) in positions[0].iter().enumerate() {
            let ([x1, x2], layer) = (places[node / 4], (node % 4) as f64 / 3.0);
            let [s, t] = [(x1 + 20.0) / 100.0, (x2 - 7.0) / 100.0];
            let value = |index: usize| bernstein(3, index / 5, s) * bernstein(4, index % 5, t) * controls[index];
            let (top, bottom) = ((0..20).map(value).sum::<f64>(), block.bottom.height(x1, x2));
            let expected = [x1, x2, bottom + (top - bottom) * layer];
            assert!((0..3).all(|axis| (x[axis] - expected[axis]).abs() < 1e-13 * 100.0), "{x:?} {expected:?}");
        }
    }
    let set = problem.admissible.polyhedron();
    for control in 0..20 {
        let [x1, x2] = [-20.0 + 100.0 * (control / 5) as f64 / 3.0, 7.0 + 100.0 * (control % 5) as f64 / 4.0];
        let expected = [block.bottom.height(x1, x2) + 50.0, obstacle.height(x1, x2)];
        let found = [set.lower()[control], set.upper()[control]];
        assert!((0..2).all(|side| (found[side] - expected[side]).abs() < 1e-12), "{found:?} {expected:?}");
    }
    // 3 × 5 slopes along x₁, 4 × 4 along x₂, then both volumes.
    let rows = rows(&problem, &controls);
    assert_eq!(rows.len(), 15 + 16 + 2);
    assert_eq!(rows[1], [-125.0, controls[1] - controls[0], 125.0]);
    let [under, cells] = [rows[31], rows[32]].map(|[lower, row, upper]| {
        assert!((upper - lower - 0.4e6).abs() < 1e-6);
        row - lower + 0.8e6
    });
    assert!((cells / volume(&problem, &controls) - 1.0).abs() < 1e-13);
    // All Bernstein polynomials have the same integral; what lies below the bottom is that of the bricks.
    let below = 1e6 - volume(&problem, &scene.start());
    let spline = 1e4 * controls.iter().sum::<f64>() / 20.0 - below;
    assert!((under / spline - 1.0).abs() < 1e-13, "{under} {spline}");
}

#[test]
fn heights_of_a_bottom_hang_from_the_top() {
    let mut scene = hertz().unwrap().with_bricks([3, 4, 2], [1; 3]);
    let heights = LatticeShape::heights(ShapedFace::Bottom, [3, 3], [2, 2], 10.2);
    scene.bodies[1].shape = Some(LatticeShape { thickness: Some(4.0), volume: Some([800.0, 1200.0]), ..heights });
    let (problem, controls) = (ContactProblem::new(scene.clone()).unwrap(), uneven(&scene, 0.1));
    let positions = &problem.map.positions(&controls)[1];
    let own = &controls[36..];
    for (node, x) in positions.iter().enumerate() {
        let [s, t] = [x[0] / 10.0, x[1] / 10.0];
        let value = |index: usize| bernstein(2, index / 3, s) * bernstein(2, index % 3, t) * own[index];
        let bottom = (0..9).map(value).sum::<f64>();
        let expected = bottom + (20.0 - bottom) * (node % 3) as f64 / 2.0;
        assert!((x[2] - expected).abs() < 1e-13 * 20.0, "{x:?} {expected}");
    }
    let set = problem.admissible.polyhedron();
    assert!((36..45).all(|control| (set.lower()[control], set.upper()[control]) == (f64::NEG_INFINITY, 16.0)));
    // Volumes of both bodies follow the slopes of the lower one, then the controls below the other surface.
    let all = rows(&problem, &controls);
    assert_eq!(all.len(), 60 + 36 + 2 + 2);
    let upper = problem.bodies[1].mesh.volume(positions);
    let [lower, row, _] = all[99];
    assert!(((row - lower + 800.0) / upper - 1.0).abs() < 1e-13, "{upper}");
}

#[test]
fn rows_of_a_lattice_are_its_slopes_and_its_volume() {
    let edges = [[100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0]];
    let coordinates = Coordinates::Cartesian { corner: [0.0; 3], edges };
    let lattice = LatticeShape {
        directions: Directions::Axes([false, true, false]),
        symmetric: [true, false, false],
        slope: Some(0.5),
        volume: Some([0.9e6, 1.1e6]),
        ..LatticeShape::new(coordinates, [3, 3, 2], [-10.0, 10.0])
    };
    let mut scene = signorini().unwrap().with_bricks([4; 3], [2; 3]);
    scene.bodies[0].shape = Some(lattice.clone());
    let (problem, controls) = (ContactProblem::new(scene.clone()).unwrap(), uneven(&scene, 5.0));
    assert_eq!(controls.len(), 2 * 3 * 2);
    let all = rows(&problem, &controls);
    // Slopes without mirror images: 3 · 2 along x₁, 2 · 2 · 2 along x₂, 2 · 3 along x₃.
    assert_eq!(all.len(), 6 + 8 + 6 + 1);
    let [lower, row, upper] = all[all.len() - 1];
    assert!(((row - lower + 0.9e6) / volume(&problem, &controls) - 1.0).abs() < 1e-12);
    assert!((upper - lower - 0.2e6).abs() < 1e-6);
    assert!(all[..all.len() - 1].iter().all(|[lower, _, upper]| [25.0, 50.0].contains(upper) && lower == &-upper));
    // Volumes of nodes that move along several axes are no rows.
    for change in [
        LatticeShape { directions: Directions::Axes([true; 3]), ..lattice.clone() },
        LatticeShape { start: 1.0, ..lattice.clone() },
        LatticeShape { thickness: Some(1.0), ..lattice },
    ] {
        scene.bodies[0].shape = Some(change);
        assert!(matches!(ContactProblem::new(scene.clone()), Err(SceneError::OutOfRange { .. })));
    }
}
