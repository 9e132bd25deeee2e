//! Surfaces of faces with known forms.

use super::face::spline_face;
use super::part::{Part, Source};
use super::{SplineFace, SurfaceError};
use crate::body::mesh::{CellFace, CellKind, Mesh};
use crate::mortar::vector::{dot, length};
use crate::shape::{Coordinates, LatticeShape};

const RADIUS: f64 = 60.0;
const LENGTH: f64 = 35.0;

/// A layer of hexahedra, n₁ × n₂ of them, and its lower face; `closed`: it ends where it begins along the first axis.
fn layer([n1, n2]: [usize; 2], closed: bool, place: impl Fn([f64; 3]) -> [f64; 3]) -> (Mesh, Vec<CellFace>) {
    let rows = if closed { n1 } else { n1 + 1 };
    let node = |i: usize, j: usize, k: usize| (i % rows * (n2 + 1) + j) * 2 + k;
    let places = (0..rows * (n2 + 1) * 2).map(|index| {
        let column = index / 2;
        place([(column / (n2 + 1)) as f64 / n1 as f64, (column % (n2 + 1)) as f64 / n2 as f64, (index % 2) as f64])
    });
    let cells = (0..n1 * n2).map(|cell| -> (CellKind, Vec<usize>) {
        let (i, j) = (cell / n2, cell % n2);
        let square = |k| [node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k)];
        (CellKind::Hex8, [square(0), square(1)].concat())
    });
    let mesh = Mesh::new(places.collect(), cells.collect::<Vec<_>>()).expect("a mesh");
    let is_lower = |face: &CellFace| mesh.face_nodes(*face).all(|node| node % 2 == 0);
    let lower = mesh.skin().into_iter().filter(is_lower).collect();
    (mesh, lower)
}

/// A bore: the lower face is a sector of a cylinder about the second axis.
fn bore(angle: f64) -> impl Fn([f64; 3]) -> [f64; 3] {
    move |[s, t, r]| {
        let angle = angle * (s - 0.5);
        let radius = RADIUS + 10.0 * r;
        [radius * angle.sin(), LENGTH * t, radius * angle.cos()]
    }
}

fn parts(mesh: &Mesh, faces: &[CellFace]) -> Vec<Part> {
    Source { mesh, start: mesh.nodes() }.parts(faces)
}

/// Where a lattice moves the nodes of a mesh: up to 2.5 mm, along all axes.
fn moved(mesh: &Mesh) -> Vec<[f64; 3]> {
    let edges = [[100.0, 0.0, 0.0], [0.0, 45.0, 0.0], [0.0, 0.0, 40.0]];
    let coordinates = Coordinates::Cartesian { corner: [-50.0, -5.0, 35.0], edges };
    let lattice = LatticeShape::new(coordinates, [6, 4, 3], [-3.0, 3.0]);
    let map = lattice.map((mesh, None), &[], |_| &[]).expect("a map");
    let controls: Vec<f64> = (0..map.controls).map(|index| 2.5 * (1.7 * index as f64).sin()).collect();
    let at = |node: usize, axis: usize| -> f64 {
        map.base[node][axis]
            + map.row(node as u32, axis).iter().map(|(control, value)| value * controls[*control]).sum::<f64>()
    };
    (0..mesh.node_count()).map(|node| std::array::from_fn(|axis| at(node, axis))).collect()
}

/// The surface of a sector of n₁ × n₂ facets in the shape of the lattice.
fn sector(counts: [usize; 2]) -> SplineFace {
    let (mesh, face) = layer(counts, false, bore(1.3));
    let parts = parts(&mesh, &face);
    assert_eq!(parts.len(), 1);
    spline_face("bore".into(), &parts[0], [mesh.nodes(), &moved(&mesh)], 1e-3).expect("a surface")
}

#[test]
fn between_the_nodes_the_surface_is_that_of_the_shape() {
    let (mesh, _) = layer([97, 61], false, bore(1.3));
    let exact = moved(&mesh);
    let worst = |face: &SplineFace| {
        let lower = exact.iter().step_by(2).enumerate().map(|(column, x)| {
            // Angle and length of the face lie 5 % inside the parameters.
            let place = [(column / 62) as f64 / 97.0, (column % 62) as f64 / 61.0].map(|t| (t + 0.05) / 1.1);
            face.net.distance(*x, place)
        });
        lower.fold(0.0, f64::max)
    };
    let faces = [[12, 8], [24, 16], [48, 32]].map(sector);
    let distances = faces.each_ref().map(|face| face.distance);
    // A hundredth of what is allowed is the goal, which nets without waves may miss a little.
    assert!(distances.iter().all(|distance| *distance <= 2e-5), "{distances:?}");
    let found = faces.each_ref().map(worst);
    // The interpolation error of cubic splines falls with the fourth power of the spacing, a little slower next to the
    // edges of the face, until the distance is reached that ends the refinement.
    assert!(found[1] < found[0] / 8.0 && found[2] < found[1] / 3.0, "{found:?}");
    assert!(found[1] < 1e-3 && found[2] < 1e-4, "{found:?}");
}

#[test]
fn the_normal_points_out_of_the_body() {
    let face = sector([12, 8]);
    for index in 0..50 {
        let place = [0.618_034, 0.754_878].map(|step| 0.05 + 0.9 * (f64::from(index) * step).fract());
        let [x, _, z] = face.net.at(place);
        let normal = face.net.normal(place);
        assert!(dot(normal, [x, 0.0, z]) < -0.9 * length(normal) * x.hypot(z), "{normal:?} at {place:?}");
    }
}

#[test]
fn surfaces_do_not_depend_on_units() {
    let (mesh, face) = layer([9, 5], false, bore(1.3));
    let part = &parts(&mesh, &face)[0];
    let scale = |points: &[[f64; 3]]| points.iter().map(|x| x.map(|x| 25.4 * x)).collect::<Vec<_>>();
    let end = moved(&mesh);
    let one = spline_face("a".into(), part, [mesh.nodes(), &end], 1e-3).expect("a surface");
    let start = scale(mesh.nodes());
    let source = Source { mesh: &mesh, start: &start };
    let other = spline_face("a".into(), &source.parts(&face)[0], [&start, &scale(&end)], 25.4e-3).expect("a surface");
    assert_eq!(one.net.surface().counts(), other.net.surface().counts());
    for (a, b) in one.net.points().iter().zip(other.net.points()) {
        // Rounding, times the condition of the normal equations.
        assert!((0..3).all(|axis| (25.4 * a[axis] - b[axis]).abs() < 1e-6), "{a:?} {b:?}");
    }
}

#[test]
fn faces_that_close_are_divided_and_caps_are_not() {
    let (mesh, face) = layer([48, 5], true, bore(std::f64::consts::TAU));
    let found = parts(&mesh, &face);
    assert!(found.len() == 2 && found.iter().all(|part| part.chart.is_some()), "{found:?}");
    // The rows of nodes between the halves belong to both.
    assert_eq!(found.iter().map(|part| part.points.len()).sum::<usize>(), (48 + 2) * 6);
    for part in &found {
        let face = spline_face("half".into(), part, [mesh.nodes(), mesh.nodes()], 1e-3).expect("a surface");
        assert!(face.distance < 1e-5, "{face:?}");
    }
    let cap = |[s, t, r]: [f64; 3]| {
        let [a, b] = [s, t].map(|s| 1.4 * (s - 0.5));
        let size = (1.0 + a * a + b * b).sqrt();
        [a, b, 1.0].map(|x| (30.0 + 5.0 * r) * x / size)
    };
    let (mesh, face) = layer([12, 12], false, cap);
    let found = parts(&mesh, &face);
    assert_eq!(found.len(), 1);
    let face = spline_face("cap".into(), &found[0], [mesh.nodes(), mesh.nodes()], 1e-3).expect("a surface");
    let off = (0..200).map(|index| {
        // Inside the circle around the middle that the face contains.
        let (angle, radius) = (f64::from(index), 0.37 * (f64::from(index) / 200.0).sqrt());
        let place = [angle.cos(), angle.sin()].map(|part| 0.5 + radius * part);
        (length(face.net.at(place)) - 30.0).abs()
    });
    let worst = off.fold(0.0, f64::max);
    // Half of what nodes are allowed, between nodes that are 3.5 mm apart on a radius of 30 mm.
    assert!(worst < 5e-4, "{worst}");
}

#[test]
fn what_no_surface_reaches_is_an_error_with_the_distance() {
    let (mesh, face) = layer([9, 5], false, bore(1.3));
    let part = &parts(&mesh, &face)[0];
    // Two nodes at one place of the start that part in the shape.
    let (mut start, mut end) = (mesh.nodes().to_vec(), mesh.nodes().to_vec());
    let [a, b] = [part.points[0], part.points[1]].map(|node| node as usize);
    start[b] = start[a];
    end[b] = [1.01 * end[a][0], end[a][1], 1.01 * end[a][2]];
    let error = spline_face("torn".into(), part, [&start, &end], 1e-3).expect_err("no surface");
    let SurfaceError::Distance { face, distance, allowed } = &error else { panic!("{error}") };
    assert!(face == "torn" && *distance > 0.1 && *allowed == 1e-3, "{error}");
    let words = error.to_string();
    assert!(words.contains("face torn") && words.contains("allowed: 1.0e-3 mm"), "{words}");
    let folded = Part { chart: None, ..part.clone() };
    let error = spline_face("folded".into(), &folded, [&start, &end], 1e-3).expect_err("no surface");
    assert!(matches!(error, SurfaceError::Folds { .. }), "{error}");
}
